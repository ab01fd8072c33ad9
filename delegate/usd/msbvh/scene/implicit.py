"""Implicit shapes as polygon meshes: Sphere, Cube, Cone, Cylinder, Capsule, Plane.

Values are looked up here; what they mean is the translator's (delegate/translate/shape).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from pxr import Usd, UsdGeom

from .. import _core
from .._core import SIDE_COUNTS, SIDES, MeshInput, Surface
from ..motion.boxes import Box
from ..motion.context import FrameContext
from ..motion.points import Samples, still
from ..motion.times import sample_times
from ..stage.value_types import FLOAT, TOKEN
from ..stage.values import Unreadable, required, value


@dataclass(frozen=True)
class ImplicitType:
    """How a prim type becomes a surface."""

    parameters: tuple[str, ...]
    """Attributes, in the order of the translator's values."""
    smooth: bool

    @property
    def computed_normals(self) -> Literal["faceted", "smooth"]:
        """As MeshInput names them."""
        return "smooth" if self.smooth else "faceted"


IMPLICIT_TYPES = {name: ImplicitType(parameters, smooth) for name, parameters, smooth in _core.implicit_types()}


def sides_for(radius_pixels: np.ndarray, silhouette_pixels: float) -> np.ndarray:
    """int[N]: the fewest sides for which shapes of float64[N] radii stray by `silhouette_pixels` at most."""
    return _core.sides_for(radius_pixels, silhouette_pixels, SIDE_COUNTS)


def sphere(radius: float, sides: int = SIDES) -> Surface:
    """Around the origin."""
    return _core.implicit_surface("Sphere", [radius], sides)


def stray(kind: str, radius: float, sides: int) -> float | None:
    """How far the faces of a shape lie off the true one, at most; None: they are it."""
    return radius * _core.stray_of(kind, sides) if IMPLICIT_TYPES[kind].smooth else None


class ImplicitShape:
    """An implicit prim over the shutter, read once; a mesh at as many sides as its size calls for."""

    def __init__(
        self, prim: Usd.Prim, form: _core.ImplicitShape, codes: list[Usd.TimeCode], context: FrameContext
    ) -> None:
        """`form` is known at the frame and at `codes`, the samples' times."""
        self.kind = str(prim.GetTypeName())
        self._form = form
        self._codes = codes
        self._context = context
        orientation = value(UsdGeom.Gprim(prim).GetOrientationAttr(), context.code, TOKEN)
        self._left_handed = orientation == UsdGeom.Tokens.leftHanded

    @property
    def radius(self) -> float:
        """The largest around the axis; 0 where there is none."""
        return self._form.radius

    @cached_property
    def box(self) -> Box:
        """Over the shutter: the fewest sides reach as far along every axis as the true shape does."""
        return Box(*self._form.box(SIDE_COUNTS[0]))

    def fill(self, mesh: MeshInput, sides: int) -> Samples:
        """Sets the topology. Returns the points."""
        surface = self._form.surface(0, sides)
        poses = [
            (self._context.shutter.time01(code.GetValue()), _points(self._form.surface(number, sides)))
            for number, code in enumerate(self._codes, start=1)
        ] or [(0.0, _points(surface))]
        mesh.face_vertex_counts, mesh.face_vertex_indices = surface.counts, surface.indices
        mesh.stray = stray(self.kind, self.radius, sides)
        mesh.left_handed = self._left_handed
        mesh.computed_normals = IMPLICIT_TYPES[self.kind].computed_normals
        return Samples(poses[:1] if still(poses) else poses, self._context.held)


def _points(surface: Surface) -> np.ndarray:
    return surface.points.astype(np.float32)


def _parameter(attribute: Usd.Attribute, code: Usd.TimeCode) -> float:
    """Raises Unreadable where a sample is blocked: USD has no value then, not even the schema's."""
    found = required(attribute, code, FLOAT)
    if found is None:
        path, name = attribute.GetPrim().GetPath().pathString, attribute.GetName()
        raise Unreadable(path, name, f"found a blocked value at time {code}, expected a number")
    return found


def read_implicit(prim: Usd.Prim, context: FrameContext) -> ImplicitShape | None:
    """None, with an error, for a parameter that is no number."""
    kind = prim.GetTypeName()
    attributes = [prim.GetAttribute(name) for name in IMPLICIT_TYPES[kind].parameters]
    codes = [Usd.TimeCode(time) for time in sample_times(attributes, context.shutter)]
    values = [[_parameter(each, code) for each in attributes] for code in (context.code, *codes)]
    turn = prim.GetAttribute("axis")
    axis = (value(turn, context.code, TOKEN) if turn else None) or "Z"
    form, said = _core.ImplicitShape.make(prim.GetPath().pathString, kind, axis, values)
    context.diagnostics.take(said)
    return None if form is None else ImplicitShape(prim, form, codes, context)
