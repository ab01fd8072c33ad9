"""Blend shapes and their in-betweens as the core's sub-shapes, and their weights over time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from pxr import Usd, UsdSkel, Vt

from ..motion.context import FrameContext, array
from ..stage.value_types import FLOAT3S
from ..stage.values import targets, value

SubShape = tuple[str, np.ndarray | None, np.ndarray | None, np.ndarray | None]
"""Path, offsets, normal offsets and point indices, as skin_points() takes them."""

_TARGETS = "skel:blendShapeTargets"


@dataclass(frozen=True)
class BlendShapes:
    """The blend shapes of a mesh with the animation that drives them."""

    shapes: list[SubShape]
    _query: UsdSkel.BlendShapeQuery
    _names: list[str]
    """The name of each blend shape of the mesh."""
    _animation: UsdSkel.AnimQuery

    def weights(self, code: Usd.TimeCode, context: FrameContext) -> np.ndarray:
        """float32[len(shapes)] at a time; zero for shapes that the animation does not name."""
        names = [str(name) for name in self._animation.GetBlendShapeOrder() or ()]
        values = list(self._animation.ComputeBlendShapeWeights(code) or ())
        if len(values) != len(names):
            message = f"found {len(values)} weights, expected {len(names)}, as many as blendShapes"
            path = str(self._animation.GetPrim().GetPath())
            context.diagnostics.warning(path, "blendShapeWeights", f"{message}; left out")
            values = [0.0] * len(names)
        by_name = dict(zip(names, values, strict=True))
        ordered = Vt.FloatArray([by_name.get(name, 0.0) for name in self._names])
        result = np.zeros(len(self.shapes), np.float32)
        weights, _, sub_shapes = self._query.ComputeSubShapeWeights(ordered)
        result[np.array(sub_shapes, int)] = np.array(weights, np.float32)
        return result


def read_blend_shapes(
    query: UsdSkel.SkinningQuery, animation: UsdSkel.AnimQuery, context: FrameContext
) -> BlendShapes | None:
    """The blend shapes of a mesh; None where it has none, nothing drives them or, with a warning, they are
    wrong."""
    if not query.HasBlendShapes() or not animation:
        return None
    prim = query.GetPrim()
    shapes = UsdSkel.BlendShapeQuery(UsdSkel.BindingAPI(prim))
    names = [str(name) for name in query.GetBlendShapeOrder() or ()]
    shape_paths = targets(prim, "skel:blendShapeTargets")
    if len(names) != len(shape_paths) or shapes.GetNumBlendShapes() != len(shape_paths):
        message = f"found {len(shape_paths)} targets, expected {len(names)}, as many as skel:blendShapes; left out"
        context.diagnostics.warning(str(prim.GetPath()), _TARGETS, message)
        return None
    for index, target in enumerate(shape_paths):
        if not shapes.GetBlendShape(index):
            found = f"target {target} is no BlendShape; '{names[index]}' is left out"
            context.diagnostics.warning(str(prim.GetPath()), _TARGETS, found)
    points = [array(indices, np.int32) for indices in shapes.ComputeBlendShapePointIndices()]
    sub_shapes = [_sub_shape(shapes, index, points) for index in range(shapes.GetNumSubShapes())]
    return BlendShapes(sub_shapes, shapes, names, animation)


def _sub_shape(query: UsdSkel.BlendShapeQuery, index: int, points: list[np.ndarray]) -> SubShape:
    """An in-between or a primary shape. UsdSkel's third kind, the shape of weight zero, is given its
    primary's offsets, but never a weight."""
    owner = query.GetBlendShapeIndex(index)
    shape, between = query.GetBlendShape(owner), query.GetInbetween(index)
    if between:
        offsets, normals = between.GetOffsets(), between.GetNormalOffsets()
    elif shape:
        offsets, normals = _at_default(shape.GetOffsetsAttr()), _at_default(shape.GetNormalOffsetsAttr())
    else:
        return "", None, None, None
    indices = points[owner] if len(points[owner]) else None
    return str(shape.GetPath()), _offsets(offsets), _offsets(normals), indices


def _at_default(attribute: Usd.Attribute) -> object:
    return value(attribute, Usd.TimeCode.Default(), FLOAT3S)


def _offsets(found: object) -> np.ndarray | None:
    return array(found, np.float32, 3) if isinstance(found, Vt.Vec3fArray) and len(found) else None
