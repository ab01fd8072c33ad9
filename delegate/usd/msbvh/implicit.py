"""Implicit shapes as polygon meshes: Sphere, Cube, Cone, Cylinder, Capsule, Plane.

Shapes are built along z around the origin, then turned so that z becomes the authored axis. Vertices lie on
the shape. Edges that are to stay sharp have two sets of vertices, so that smooth normals do not run across
them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product

import numpy as np
from pxr import Usd, UsdGeom

from .context import FrameContext
from .points import Samples, still
from .times import sample_times
from .value_types import FLOAT, TOKEN
from .values import required, value

SIDES = 48
"""Around the axis. The silhouette strays from the circle by 0.2 % of the radius."""
STACKS = 24
"""From pole to pole."""


@dataclass
class Surface:
    """A polygon mesh."""

    counts: np.ndarray
    """int32[F] vertices a face."""
    indices: np.ndarray
    """int32[I], counter-clockwise seen from outside."""
    points: np.ndarray
    """float64[N, 3]."""


def _revolved(profile: np.ndarray, first_row: int = 0) -> Surface:
    """Turns float64[R, 2] (radius, z), from the lower to the upper end, around z; quads between its rows."""
    angle = np.arange(SIDES) * (2 * np.pi / SIDES)
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    points = np.concatenate(
        [np.concatenate([ring * radius, np.full((SIDES, 1), z)], axis=1) for radius, z in profile]
    )
    low = (np.arange(len(profile) - 1)[:, None] + first_row) * SIDES
    here, there = np.arange(SIDES)[None], (np.arange(SIDES)[None] + 1) % SIDES
    quads = np.stack([low + here, low + there, low + SIDES + there, low + SIDES + here], axis=-1).reshape(
        -1, 4
    )
    return Surface(np.full(len(quads), 4, np.int32), quads.astype(np.int32).ravel(), points)


def _joined(*parts: Surface) -> Surface:
    offsets = np.cumsum([0, *(len(part.points) for part in parts[:-1])])
    indices = [part.indices + offset for part, offset in zip(parts, offsets, strict=True)]
    return Surface(
        np.concatenate([part.counts for part in parts]),
        np.concatenate(indices).astype(np.int32),
        np.concatenate([part.points for part in parts]),
    )


def sphere(radius: float) -> Surface:
    """Around the origin."""
    latitude = np.linspace(-np.pi / 2, np.pi / 2, STACKS + 1)
    return _revolved(np.stack([radius * np.cos(latitude), radius * np.sin(latitude)], axis=1))


def cylinder(bottom: float, top: float, height: float) -> Surface:
    """With both caps; a cone where a radius is 0."""
    half = height / 2
    lower, upper = (bottom, -half), (top, half)
    return _joined(
        _revolved(np.array([(0.0, -half), lower])),
        _revolved(np.array([lower, upper])),
        _revolved(np.array([upper, (0.0, half)])),
    )


def capsule(bottom: float, top: float, height: float) -> Surface:
    """A cylinder of `height` between two half spheres."""
    angle = np.linspace(0.0, np.pi / 2, STACKS // 2 + 1)
    lower = np.stack([bottom * np.sin(angle), -height / 2 - bottom * np.cos(angle)], axis=1)
    upper = np.stack([top * np.cos(angle), height / 2 + top * np.sin(angle)], axis=1)
    return _revolved(np.concatenate([lower, upper]))


def cube(size: float) -> Surface:
    """Around the origin; every face has vertices of its own."""
    corners = np.array(list(product((-0.5, 0.5), repeat=3)))
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return Surface(np.full(6, 4, np.int32), np.arange(24, dtype=np.int32), corners[np.ravel(faces)] * size)


def plane(width: float, length: float) -> Surface:
    """In xy, facing +z."""
    corners = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], float)
    return Surface(
        np.array([4], np.int32), np.arange(4, dtype=np.int32), corners * (width / 2, length / 2, 0.0)
    )


@dataclass(frozen=True)
class ImplicitType:
    """How a prim type becomes a surface."""

    parameters: tuple[str, ...]
    """Attributes, in the order of the function's arguments."""
    surface: Callable[..., Surface]
    smooth: bool


IMPLICIT_TYPES = {
    "Sphere": ImplicitType(("radius",), sphere, True),
    "Cube": ImplicitType(("size",), cube, False),
    "Cone": ImplicitType(("radius", "height"), lambda radius, height: cylinder(radius, 0.0, height), True),
    "Cylinder": ImplicitType(("radius", "height"), lambda r, height: cylinder(r, r, height), True),
    "Cylinder_1": ImplicitType(("radiusBottom", "radiusTop", "height"), cylinder, True),
    "Capsule": ImplicitType(("radius", "height"), lambda r, height: capsule(r, r, height), True),
    "Capsule_1": ImplicitType(("radiusBottom", "radiusTop", "height"), capsule, True),
    "Plane": ImplicitType(("width", "length"), plane, False),
}


def read_implicit(prim: Usd.Prim, context: FrameContext) -> dict:
    """The mesh keywords of an implicit prim: topology and points.

    Points are linear in every parameter, so the parameters' samples are the points'.
    """
    kind = IMPLICIT_TYPES[prim.GetTypeName()]
    attributes = [prim.GetAttribute(name) for name in kind.parameters]
    axis = _axis(prim, context)
    if kind.surface is plane and axis != "Z":
        attributes.reverse()  # The width lies along x, or along z where x is the axis: second in the cycle.

    def surface_at(code: Usd.TimeCode) -> Surface:
        surface = kind.surface(*(required(attribute, code, FLOAT) for attribute in attributes))
        surface.points = turned(surface.points, axis)
        return surface

    surface = surface_at(context.code)
    values = [
        (context.shutter.time01(time), surface_at(Usd.TimeCode(time)).points.astype(np.float32))
        for time in sample_times(attributes, context.shutter)
    ] or [(0.0, surface.points.astype(np.float32))]
    samples = Samples(values[:1] if still(values) else values, context.held)
    return {
        "face_vertex_counts": surface.counts,
        "face_vertex_indices": surface.indices,
        "hole_indices": None,
        "left_handed": value(UsdGeom.Gprim(prim).GetOrientationAttr(), context.code, TOKEN)
        == UsdGeom.Tokens.leftHanded,
        "samples": samples,
        "computed_normals": "smooth" if kind.smooth else "faceted",
    }


def _axis(prim: Usd.Prim, context: FrameContext) -> str:
    attribute = prim.GetAttribute("axis")
    found = (value(attribute, context.code, TOKEN) if attribute else None) or "Z"
    if found in ("X", "Y", "Z"):
        return found
    context.diagnostics.warning(str(prim.GetPath()), "axis", f"found '{found}', expected X, Y or Z; took Z")
    return "Z"


def turned(points: np.ndarray, axis: str) -> np.ndarray:
    """float64[N, 3] from along z to along `axis`, by a cyclic exchange of the axes, which keeps the
    orientation."""
    return np.roll(points, {"X": 1, "Y": 2, "Z": 0}[str(axis)], axis=1)
