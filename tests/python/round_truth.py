"""Curves and points as the polygons that an eye sees of them: ribbons turned to it, and the discs that spheres hide.

The bases are those of UsdGeomBasisCurves' documentation. A ribbon is drawn in `CUTS` pieces a span.
"""

from __future__ import annotations

import numpy as np
from pxr import UsdGeom

CUTS = 32
SIDES = 64
"""Of a disc; its area is 0.2 % short."""

BASES = {
    "bezier": np.array([(1, 0, 0, 0), (-3, 3, 0, 0), (3, -6, 3, 0), (-1, 3, -3, 1)], float),
    "bspline": np.array([(1, 4, 1, 0), (-3, 0, 3, 0), (3, -6, 3, 0), (-1, 3, -3, 1)], float) / 6.0,
    "catmullRom": np.array([(0, 2, 0, 0), (-1, 0, 1, 0), (2, -5, 4, -1), (-1, 3, -3, 1)], float) / 2.0,
}
"""Rows: coefficients of 1, t, t^2, t^3."""

Drawn = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Points float64[N, 3], counts int[F] and indices int[sum(counts)] of polygons."""


def drawn_points(points: np.ndarray, widths: np.ndarray, eye: np.ndarray) -> Drawn:
    """`points` in the space of `eye`: the discs about them that span the cones of rays which meet their spheres."""
    radius = 0.5 * np.broadcast_to(widths, len(points))
    axis = points - eye
    distance = np.linalg.norm(axis, axis=1)
    across = radius / np.sqrt(1.0 - (radius / distance) ** 2)
    x = _unit(np.cross(axis, (0.0, 1.0, 0.0)))
    y = _unit(np.cross(axis, x))
    angles = 2.0 * np.pi * np.arange(SIDES) / SIDES
    rim = np.cos(angles)[:, None, None] * x + np.sin(angles)[:, None, None] * y
    corners = (points + across[:, None] * rim).transpose(1, 0, 2).reshape(-1, 3)
    return corners, np.full(len(points), SIDES), np.arange(len(corners))


def drawn_curves(
    prim: UsdGeom.BasisCurves,
    points: np.ndarray,
    widths: np.ndarray,
    normals: np.ndarray | None,
    eye: np.ndarray,
    time: float,
) -> Drawn:
    """At a time. `points` in the space of `eye`. `normals`, one a point: the ribbon lies across them; None: it is turned to
    the eye."""
    corners, first = [np.zeros((0, 3))], 0
    interpolation = str(prim.GetWidthsInterpolation())
    taken = 0
    for curve, count in enumerate(map(int, prim.GetCurveVertexCountsAttr().Get(time))):
        own = slice(first, first + count)
        spans = _spans(prim, count)
        n = len(spans) + (prim.GetWrapAttr().Get() != UsdGeom.Tokens.periodic)
        of_curve = _of_curve(interpolation, widths, curve, own, slice(taken, taken + n))
        taken += n
        for i, span in enumerate(spans):
            corners.append(_ribbon(prim, points[own], of_curve, normals, own, span, i, len(spans), eye))
        first += count
    every = np.concatenate(corners)
    return every, np.full(len(every) // 4, 4), np.arange(len(every))


def bezier_vertices(prim: UsdGeom.BasisCurves, points: np.ndarray, time: float) -> np.ndarray:
    """float64[N, 3]: the control points of cubic Bezier curves, those of spans that follow each other once."""
    found, first = [np.zeros((0, 3))], 0
    for count in map(int, prim.GetCurveVertexCountsAttr().Get(time)):
        for i, span in enumerate(_spans(prim, count)):
            own = span @ points[first : first + count]
            if len(own) == 2:
                own = np.linspace(own[0], own[1], 4)
            else:
                own = np.linalg.solve(BASES["bezier"], BASES[str(prim.GetBasisAttr().Get())] @ own)
            found.append(own if i == 0 else own[1:])
        first += count
    return np.concatenate(found)


def _of_curve(interpolation: str, widths: np.ndarray, curve: int, own: slice, ends: slice) -> tuple[str, np.ndarray]:
    if interpolation == "vertex":
        return "vertex", widths[own]
    if interpolation == "varying":
        return "varying", widths[ends]
    return "constant", widths[curve : curve + 1] if interpolation == "uniform" else widths[:1]


def _spans(prim: UsdGeom.BasisCurves, count: int) -> list[np.ndarray]:
    """For each span, weights float64[2 or 4, count] of its control points by the curve's own."""
    eye, wrap = np.eye(count), str(prim.GetWrapAttr().Get())
    rows, size, step = eye, 2, 1
    if str(prim.GetTypeAttr().Get()) == "cubic":
        basis = str(prim.GetBasisAttr().Get())
        size, step = 4, 3 if basis == "bezier" else 1
        if wrap == "pinned" and basis != "bezier":
            rows = np.concatenate([[2 * eye[0] - eye[1]], eye, [2 * eye[-1] - eye[-2]]])
    if wrap == "periodic":
        rows = np.concatenate([eye, eye[: size - step if size == 4 else 1]])
    return [rows[i : i + size] for i in range(0, len(rows) - size + 1, step)]


def _ribbon(
    prim: UsdGeom.BasisCurves,
    points: np.ndarray,
    widths: tuple[str, np.ndarray],
    normals: np.ndarray | None,
    own: slice,
    span: np.ndarray,
    number: int,
    count: int,
    eye: np.ndarray,
) -> np.ndarray:
    """Quads float64[CUTS * 4, 3] of one span."""
    t = np.linspace(0.0, 1.0, CUTS + 1)
    value, slope = _blends(prim, t)
    at, along = value @ span @ points, slope @ span @ points
    interpolation, given = widths
    if interpolation == "vertex":
        width = value @ span @ given
    elif interpolation == "varying":
        width = (1.0 - t) * given[number] + t * given[(number + 1) % len(given)]
    else:
        width = np.full(len(t), given[0])
    facing = eye - at if normals is None else value @ span @ normals[own]
    out = 0.5 * width[:, None] * _unit(np.cross(along, facing))
    left, right = at - out, at + out
    return np.stack([left[:-1], left[1:], right[1:], right[:-1]], axis=1).reshape(-1, 3)


def _blends(prim: UsdGeom.BasisCurves, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """float64[T, 2 or 4] of places and of slopes."""
    if str(prim.GetTypeAttr().Get()) != "cubic":
        return np.stack([1.0 - t, t], axis=1), np.broadcast_to((-1.0, 1.0), (len(t), 2))
    basis = BASES[str(prim.GetBasisAttr().Get())]
    powers = np.stack([t**0, t, t**2, t**3], axis=1)
    slopes = np.stack([0 * t, t**0, 2 * t, 3 * t**2], axis=1)
    return powers @ basis, slopes @ basis


def _unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)
