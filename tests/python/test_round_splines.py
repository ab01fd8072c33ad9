"""HermiteCurves and NurbsCurves become Bezier spans: against their definitions."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from pxr import Gf
from recording import Shot, messages
from round_stages import ZIGZAG, bezier_points, hermite, nurbs


def test_hermite_curves_meet_points_and_tangents() -> None:
    shot = Shot()
    points, tangents = (
        np.array(ZIGZAG),
        np.array([(3, 0, 3), (0, 3, 0), (-3, 0, 0), (0, 0, 6), (3, 3, 0), (0, 0, 0), (9, 0, 0)], float),
    )
    hermite(shot, points, tangents, [4, 3])
    result = shot.read()
    assert messages(result) == []
    expected = []
    for first, count in ((0, 4), (4, 3)):
        expected.append(points[first])
        for i in range(first, first + count - 1):
            expected += [points[i] + tangents[i] / 3, points[i + 1] - tangents[i + 1] / 3, points[i + 1]]
    assert np.abs(bezier_points(result) - np.array(expected)).max() < 1e-6


def test_hermite_curves_move_by_points_tangents_velocities_and_transforms() -> None:
    shot = Shot()
    prim = hermite(shot, [(0, 0, 0), (1, 0, 0)], [(0, 3, 0), (0, -3, 0)], [2])
    prim.GetTangentsAttr().Set([Gf.Vec3f(0, 0, 0), Gf.Vec3f(0, 0, 0)], 9.5)
    prim.GetTangentsAttr().Set([Gf.Vec3f(0, 6, 0), Gf.Vec3f(0, -6, 0)], 10.5)
    prim.AddTranslateOp().Set(Gf.Vec3d(5, 0, 0))
    result = shot.read()
    for time01 in (0.0, 0.25, 1.0):
        expected = [(5, 0, 0), (5, 2 * time01, 0), (6, 2 * time01, 0), (6, 0, 0)]
        assert np.abs(bezier_points(result, time01=time01) - expected).max() < 1e-3

    shot = Shot()
    prim = hermite(shot, [(0, 0, 0), (1, 0, 0)], [(0, 3, 0), (0, -3, 0)], [2])
    prim.GetPointsAttr().Set(prim.GetPointsAttr().Get(), 10.0)
    prim.CreateVelocitiesAttr().Set([Gf.Vec3f(24, 0, 0)] * 2, 10.0)
    result = shot.read()
    expected = np.array([(0, 0, 0), (0, 1, 0), (1, 1, 0), (1, 0, 0)]) + (0.5, 0, 0)
    assert np.abs(bezier_points(result, time01=1.0) - expected).max() < 1e-3


def de_boor(points: np.ndarray, degree: int, knots: Any, u: float) -> np.ndarray:
    """The definition (C. de Boor, 1972)."""
    k = max(i for i in range(degree, len(points)) if knots[i] <= u and knots[i] < knots[i + 1])
    d = [np.array(points[j + k - degree], float) for j in range(degree + 1)]
    for r in range(1, degree + 1):
        for j in range(degree, r - 1, -1):
            a, b = knots[j + k - degree], knots[j + 1 + k - r]
            w = (u - a) / (b - a)
            d[j] = (1 - w) * d[j - 1] + w * d[j]
    return d[degree]


def evaluated(vertices: np.ndarray, span: int, u: float) -> np.ndarray:
    p, v = vertices[3 * span : 3 * span + 4], 1 - u
    return p[0] * v**3 + 3 * p[1] * v * v * u + 3 * p[2] * v * u * u + p[3] * u**3


@pytest.mark.parametrize(("order", "pieces"), [(2, 1), (3, 1), (4, 1), (6, 8)])
def test_nurbs_curves_are_their_own_definition(order: int, pieces: int) -> None:
    shot, degree = Shot(), order - 1
    inner = [0.3, 0.5, 1.5] if order == 4 else [float(i + 1) for i in range(len(ZIGZAG) - order)]
    last = 2.0 if order == 4 else float(len(ZIGZAG) - degree)
    knots = [0.0] * order + inner + [last] * order
    nurbs(shot, ZIGZAG, order, knots)
    result = shot.read()
    assert messages(result) == []
    vertices = bezier_points(result)
    edges = [0.0, *inner, last]
    assert len(vertices) == 3 * pieces * (len(edges) - 1) + 1
    for span in range(len(edges) - 1):
        for piece in range(pieces):
            for u in (0.0, 0.2, 0.5, 0.9):
                at = edges[span] + (edges[span + 1] - edges[span]) * (piece + u) / pieces
                expected = de_boor(np.array(ZIGZAG), degree, knots, at)
                found = evaluated(vertices, span * pieces + piece, u)
                assert np.abs(found - expected).max() < (1e-5 if pieces == 1 else 5e-4)


def test_a_circle_by_weights_and_a_range() -> None:
    shot, w = Shot(), np.sqrt(0.5)
    prim = nurbs(shot, [(1, 0, 0), (1, 1, 0), (0, 1, 0), (-1, 1, 0), (-1, 0, 0)], 3, [0, 0, 0, 1, 1, 2, 2, 2])
    prim.CreatePointWeightsAttr([1, w, 1, w, 1])
    prim.CreateRangesAttr([Gf.Vec2d(0, 1)])
    result = shot.read()
    assert messages(result) == []
    vertices = bezier_points(result)
    places = np.array([evaluated(vertices, span, u) for span in range(8) for u in (0.0, 0.3, 0.7, 1.0)])
    assert np.abs(np.linalg.norm(places, axis=1) - 1).max() < 1e-5
    assert places[0] == pytest.approx([1, 0, 0], abs=1e-6)
    assert places[-1] == pytest.approx([0, 1, 0], abs=1e-6)
