"""Implicit shapes as polygon meshes: Sphere, Cube, Cone, Cylinder, Capsule, Plane.

Shapes are built along z around the origin, then turned so that z becomes the authored axis. Vertices lie on
the shape. Edges that are to stay sharp have two sets of vertices, so that smooth normals do not run across
them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np
from pxr import Usd, UsdGeom

from .._core import LARGEST_ELEMENT, MeshInput
from ..motion.boxes import Box
from ..motion.context import FrameContext
from ..motion.points import Samples, still
from ..motion.times import sample_times
from ..stage.value_types import FLOAT, TOKEN
from ..stage.values import required, value

SIDE_COUNTS = (8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256, 384)
"""How many sides a shape may have around its axis; half as many from pole to pole. The last takes 147,456
triangles a sphere and strays by a tenth of a pixel at a radius of 1,500 pixels."""
SIDES = 48
"""Where nobody knows how large a shape is seen."""
SILHOUETTES = {"low": 0.1, "medium": 0.05, "high": 0.025, "veryhigh": 0.0125}
"""Pixels by which a shape may lie inside of the true one, by usdrecord's --complexity."""


def sides_for(radius_pixels: np.ndarray, silhouette_pixels: float) -> np.ndarray:
    """int[N]: the fewest sides for which shapes of float64[N] radii stray by `silhouette_pixels` at most.

    A chord of a circle of radius r with n sides lies r (1 - cos(pi / n)) inside; the middle of a sphere's
    face twice as far, since it is curved both ways.
    """
    strays = 2.0 * (1.0 - np.cos(np.pi / np.array(SIDE_COUNTS)))
    largest = silhouette_pixels / strays
    known = np.nan_to_num(radius_pixels, nan=0.0)
    return np.array(SIDE_COUNTS)[np.minimum(np.searchsorted(largest, known), len(SIDE_COUNTS) - 1)]


@dataclass
class Surface:
    """A polygon mesh."""

    counts: np.ndarray
    """int32[F] vertices a face."""
    indices: np.ndarray
    """int32[I], counter-clockwise seen from outside."""
    points: np.ndarray
    """float64[N, 3]."""


def _revolved(profile: np.ndarray, sides: int) -> Surface:
    """Turns float64[R, 2] (radius, z), from the lower to the upper end, around z; quads between its rows."""
    angle = np.arange(sides) * (2 * np.pi / sides)
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    points = np.concatenate([np.concatenate([ring * radius, np.full((sides, 1), z)], axis=1) for radius, z in profile])
    low = np.arange(len(profile) - 1)[:, None] * sides
    here, there = np.arange(sides)[None], (np.arange(sides)[None] + 1) % sides
    quads = np.stack([low + here, low + there, low + sides + there, low + sides + here], axis=-1).reshape(-1, 4)
    return Surface(np.full(len(quads), 4, np.int32), quads.astype(np.int32).ravel(), points)


def _joined(*parts: Surface) -> Surface:
    offsets = np.cumsum([0, *(len(part.points) for part in parts[:-1])])
    indices = [part.indices + offset for part, offset in zip(parts, offsets, strict=True)]
    return Surface(
        np.concatenate([part.counts for part in parts]),
        np.concatenate(indices).astype(np.int32),
        np.concatenate([part.points for part in parts]),
    )


def sphere(radius: float, sides: int = SIDES) -> Surface:
    """Around the origin."""
    latitude = np.linspace(-np.pi / 2, np.pi / 2, sides // 2 + 1)
    return _revolved(np.stack([radius * np.cos(latitude), radius * np.sin(latitude)], axis=1), sides)


def cylinder(bottom: float, top: float, height: float, sides: int = SIDES) -> Surface:
    """With both caps; a cone where a radius is 0."""
    half = height / 2
    lower, upper = (bottom, -half), (top, half)
    return _joined(
        _revolved(np.array([(0.0, -half), lower]), sides),
        _revolved(np.array([lower, upper]), sides),
        _revolved(np.array([upper, (0.0, half)]), sides),
    )


def capsule(bottom: float, top: float, height: float, sides: int = SIDES) -> Surface:
    """A cylinder of `height` between two half spheres."""
    angle = np.linspace(0.0, np.pi / 2, sides // 4 + 1)
    lower = np.stack([bottom * np.sin(angle), -height / 2 - bottom * np.cos(angle)], axis=1)
    upper = np.stack([top * np.cos(angle), height / 2 + top * np.sin(angle)], axis=1)
    return _revolved(np.concatenate([lower, upper]), sides)


def cube(size: float, sides: int = 0) -> Surface:
    """Around the origin; every face has vertices of its own."""
    corners = np.array(list(product((-0.5, 0.5), repeat=3)))
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return Surface(np.full(6, 4, np.int32), np.arange(24, dtype=np.int32), corners[np.ravel(faces)] * size)


def plane(width: float, length: float, sides: int = 0) -> Surface:
    """In xy, facing +z."""
    corners = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], float)
    return Surface(np.array([4], np.int32), np.arange(4, dtype=np.int32), corners * (width / 2, length / 2, 0.0))


@dataclass(frozen=True)
class ImplicitType:
    """How a prim type becomes a surface."""

    parameters: tuple[str, ...]
    """Attributes, in the order of the function's arguments."""
    surface: Callable[..., Surface]
    """Of the parameters and the number of sides."""
    smooth: bool


def _cone(radius: float, height: float, sides: int) -> Surface:
    return cylinder(radius, 0.0, height, sides)


def _straight(radius: float, height: float, sides: int) -> Surface:
    return cylinder(radius, radius, height, sides)


def _even_capsule(radius: float, height: float, sides: int) -> Surface:
    return capsule(radius, radius, height, sides)


IMPLICIT_TYPES = {
    "Sphere": ImplicitType(("radius",), sphere, True),
    "Cube": ImplicitType(("size",), cube, False),
    "Cone": ImplicitType(("radius", "height"), _cone, True),
    "Cylinder": ImplicitType(("radius", "height"), _straight, True),
    "Cylinder_1": ImplicitType(("radiusBottom", "radiusTop", "height"), cylinder, True),
    "Capsule": ImplicitType(("radius", "height"), _even_capsule, True),
    "Capsule_1": ImplicitType(("radiusBottom", "radiusTop", "height"), capsule, True),
    "Plane": ImplicitType(("width", "length"), plane, False),
}


class ImplicitShape:
    """An implicit prim over the shutter, read once; a mesh at as many sides as its size calls for.

    Points are linear in every parameter, so the parameters' samples are the points'.
    """

    def __init__(
        self,
        prim: Usd.Prim,
        values: dict[Usd.TimeCode, list[float]],
        codes: list[Usd.TimeCode],
        context: FrameContext,
    ) -> None:
        """`values` are the parameters at the frame and at `codes`, the samples' times."""
        self._kind = IMPLICIT_TYPES[prim.GetTypeName()]
        self._values = values
        self._codes = codes
        self._context = context
        self._axis = _axis(prim, context)
        orientation = value(UsdGeom.Gprim(prim).GetOrientationAttr(), context.code, TOKEN)
        self._left_handed = orientation == UsdGeom.Tokens.leftHanded
        if self._kind.surface is plane and self._axis != "Z":
            # The width lies along x, or along z where x is the axis: second in the cycle.
            self._values = {code: found[::-1] for code, found in values.items()}

    @property
    def radius(self) -> float:
        """The largest around the axis; 0 where there is none."""
        return max(_radius(self._kind, found) for found in self._values.values())

    @cached_property
    def box(self) -> Box:
        """Over the shutter: the fewest sides reach as far along every axis as the true shape does."""
        return Box.around(np.concatenate([self._surface(code, SIDE_COUNTS[0]).points for code in self._values]))

    def fill(self, mesh: MeshInput, sides: int) -> Samples:
        """Sets the topology. Returns the points."""
        surface = self._surface(self._context.code, sides)
        poses = [
            (self._context.shutter.time01(code.GetValue()), self._surface(code, sides).points.astype(np.float32))
            for code in self._codes
        ] or [(0.0, surface.points.astype(np.float32))]
        mesh.face_vertex_counts, mesh.face_vertex_indices = surface.counts, surface.indices
        mesh.left_handed = self._left_handed
        mesh.computed_normals = "smooth" if self._kind.smooth else "faceted"
        return Samples(poses[:1] if still(poses) else poses, self._context.held)

    def _surface(self, code: Usd.TimeCode, sides: int) -> Surface:
        surface = self._kind.surface(*self._values[code], sides=sides)
        surface.points = turned(surface.points, self._axis)
        return surface


def read_implicit(prim: Usd.Prim, context: FrameContext) -> ImplicitShape | None:
    """None, with an error, for a parameter that is no number."""
    kind = IMPLICIT_TYPES[prim.GetTypeName()]
    attributes = [prim.GetAttribute(name) for name in kind.parameters]
    codes = [Usd.TimeCode(time) for time in sample_times(attributes, context.shutter)]
    values = {code: [required(each, code, FLOAT) for each in attributes] for code in (context.code, *codes)}
    if not all(_are_sound(prim, kind, found, context) for found in values.values()):
        return None
    return ImplicitShape(prim, values, codes, context)


def _axis(prim: Usd.Prim, context: FrameContext) -> str:
    attribute = prim.GetAttribute("axis")
    found = (value(attribute, context.code, TOKEN) if attribute else None) or "Z"
    if found in ("X", "Y", "Z"):
        return found
    context.diagnostics.warning(str(prim.GetPath()), "axis", f"found '{found}', expected X, Y or Z; took Z")
    return "Z"


def _radius(kind: ImplicitType, values: Sequence[float]) -> float:
    """The largest around the axis; 0 where there is none."""
    named = zip(kind.parameters, values, strict=True)
    return max((abs(value) for name, value in named if name.startswith("radius")), default=0.0)


def _are_sound(prim: Usd.Prim, kind: ImplicitType, values: Sequence[float], context: FrameContext) -> bool:
    for name, value in zip(kind.parameters, values, strict=True):
        if not abs(value) <= LARGEST_ELEMENT:
            message = f"found {value:g}, expected a finite number of at most 2^60 in size; the prim is not drawn"
            context.diagnostics.error(str(prim.GetPath()), name, message)
            return False
    return True


def turned(points: np.ndarray, axis: str) -> np.ndarray:
    """float64[N, 3] from along z to along `axis`, by a cyclic exchange of the axes, which keeps the
    orientation."""
    return np.roll(points, TURNS[str(axis)], axis=1)


TURNS = {"X": 1, "Y": 2, "Z": 0}
"""By how many places coordinates move."""
