"""How meshes are subdivided: UsdGeomMesh's rules, creases and corners."""

from __future__ import annotations

import numpy as np
from pxr import Usd, UsdGeom

from .._core import MeshInput
from ..motion.context import FrameContext, array
from ..motion.held_values import warn_of_change
from ..stage.value_types import FLOATS, INTS, TOKEN, Kind
from ..stage.values import value

_RULES = (
    ("interpolate_boundary", "interpolateBoundary"),
    ("face_varying_linear", "faceVaryingLinearInterpolation"),
    ("triangle_rule", "triangleSubdivisionRule"),
)
"""The translator's names and USD's."""
_FEATURES: tuple[tuple[tuple[str, str, Kind, type], ...], ...] = (
    (
        ("crease_lengths", "creaseLengths", INTS, np.int32),
        ("crease_indices", "creaseIndices", INTS, np.int32),
        ("crease_sharpnesses", "creaseSharpnesses", FLOATS, np.float32),
    ),
    (
        ("corner_indices", "cornerIndices", INTS, np.int32),
        ("corner_sharpnesses", "cornerSharpnesses", FLOATS, np.float32),
    ),
)
"""What says something together: creases, corners."""


def add_subdivision(target: MeshInput, mesh: UsdGeom.Mesh, context: FrameContext, authored: frozenset[str]) -> bool:
    """Sets the scheme and, where it is one, its rules, creases and corners, as they are at the frame. Returns whether the
    mesh is subdivided."""
    prim, scheme = mesh.GetPrim(), None
    if "subdivisionScheme" in authored:
        scheme = value(_at_frame(prim, "subdivisionScheme", context), context.code, TOKEN)
    target.subdivision_scheme = str(UsdGeom.Tokens.catmullClark if scheme is None else scheme)
    if scheme == UsdGeom.Tokens.none:
        return False
    for keyword, name in _RULES:
        if name in authored:
            rule = value(_at_frame(prim, name, context), context.code, TOKEN)
            if rule:
                setattr(target, keyword, str(rule))
    for features in _FEATURES:
        _add_features(target, prim, [feature for feature in features if feature[1] in authored], context)
    return True


def _add_features(
    target: MeshInput, prim: Usd.Prim, features: list[tuple[str, str, Kind, type]], context: FrameContext
) -> None:
    """None where one has a value of another type, which has been said: the others say nothing without it."""
    read = []
    for keyword, name, kind, dtype in features:
        attribute = _at_frame(prim, name, context)
        found = value(attribute, context.code, kind)
        if found is None and attribute.HasAuthoredValue():
            return
        read.append((keyword, array(found, dtype)))
    for keyword, values in read:
        setattr(target, keyword, values)


def _at_frame(prim: Usd.Prim, name: str, context: FrameContext) -> Usd.Attribute:
    """An attribute that counts as it is at the frame."""
    attribute = prim.GetAttribute(name)
    warn_of_change(attribute, ", as the topology", context.shutter, context.diagnostics)
    return attribute
