"""NURBS patches that are wrong: one message, and the rest of the picture."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from nurbs_truth import bumpy, vectors
from pxr import Gf, UsdGeom
from recording import Shot, messages
from sound_neighbour import render, shows_good

NAN, INF = float("nan"), float("inf")


def knots(*changes: tuple[int, float]) -> list[float]:
    values = bumpy().u_knots.copy()
    for place, value in changes:
        values[place] = value
    return values


BAD: list[tuple[Callable[[UsdGeom.NurbsPatch], object], str]] = [
    (lambda p: p.GetUOrderAttr().Set(1), "uOrder: found 1; expected 2 to 64"),
    (lambda p: p.GetVOrderAttr().Clear(), "vOrder: found 0; expected 2 to 64"),
    (lambda p: p.GetVOrderAttr().Set(2**31 - 1), "vOrder: found 2147483647; expected 2 to 64"),
    (lambda p: p.GetUVertexCountAttr().Set(3), "uVertexCount: found 3; expected 4, the order, or more"),
    (lambda p: p.GetUVertexCountAttr().Set(-7), "uVertexCount: found -7; expected 4, the order, or more"),
    (
        lambda p: p.GetUVertexCountAttr().Set(2**31 - 1),
        "uKnots: found 10 knots; expected 2147483651, the vertex count and the order",
    ),
    (lambda p: p.GetUKnotsAttr().Set([]), "uKnots: found 0 knots; expected 10, the vertex count and the order"),
    (
        lambda p: p.GetUKnotsAttr().Set(knots((5, 0.5))),
        "uKnots: knot 5 is 0.5, less than 1 before it; expected knots that do not decrease",
    ),
    (lambda p: p.GetUKnotsAttr().Set(knots((5, NAN))), "uKnots: knot 5 is nan; expected a finite number"),
    (lambda p: p.GetUKnotsAttr().Set(knots((9, INF))), "uKnots: knot 9 is inf; expected a finite number"),
    (
        lambda p: p.GetUKnotsAttr().Set([1.0] * 10),
        "uKnots: knots 3 and 6 are both 1; expected different ones: what is drawn lies between them",
    ),
    (
        lambda p: p.CreateURangeAttr(Gf.Vec2d(2, 1)),
        "uRange: found (2, 1); expected a part of (0, 3), where the knots have a spline",
    ),
    (
        lambda p: p.CreateURangeAttr(Gf.Vec2d(NAN, 1)),
        "uRange: found (nan, 1); expected a part of (0, 3), where the knots have a spline",
    ),
    (
        lambda p: p.GetPointsAttr().Set(vectors(bumpy().points)[:7]),
        "points: found 7 points, expected 30, as uVertexCount and vVertexCount say",
    ),
    (lambda p: p.GetPointsAttr().Set([Gf.Vec3f(0, NAN, 0)] * 30), "points: value 0 at shutter time 0"),
]

MENDED: list[tuple[Callable[[UsdGeom.NurbsPatch], object], str]] = [
    (
        lambda p: p.CreateURangeAttr(Gf.Vec2d(-1, 2)),
        "uRange: found (-1, 2); expected a part of (0, 3), where the knots have a spline; drew that",
    ),
    (
        lambda p: p.CreatePointWeightsAttr([1.0] * 7),
        "pointWeights: found 7 weights; expected 30, one a point; it is left out",
    ),
    (
        lambda p: p.CreatePointWeightsAttr([1.0] * 29 + [NAN]),
        "pointWeights: weight 29 is nan; expected finite numbers larger than 0; it is left out",
    ),
    (
        lambda p: p.CreatePointWeightsAttr([0.0] * 30),
        "pointWeights: weight 0 is 0; expected finite numbers larger than 0; it is left out",
    ),
    (
        lambda p: p.CreateDisplayColorPrimvar("vertex").Set([Gf.Vec3f(1)] * 7),
        "primvars:displayColor: found 7 values; expected 30 for the interpolation vertex; it is left out",
    ),
    (
        lambda p: p.CreateDisplayColorPrimvar("uniform").Set([Gf.Vec3f(1)] * 7),
        "primvars:displayColor: found 7 values; expected 9 for the interpolation uniform; it is left out",
    ),
    (
        lambda p: p.CreateDisplayColorPrimvar("faceVarying").Set([Gf.Vec3f(1)] * 7),
        'primvars:displayColor: found the interpolation "faceVarying" on a patch; expected constant, uniform, varying',
    ),
    (
        lambda p: indexed(p, [3] * 30),
        "primvars:displayColor: index 0 is 3; expected less than 2, the number of values; it is left out",
    ),
    (
        lambda p: (
            p.GetPointsAttr().Set(p.GetPointsAttr().Get(), 1.0),
            p.CreateVelocitiesAttr().Set([Gf.Vec3f(1)] * 7, 1.0),
        ),
        "velocities: not used: found 7 values, expected 30, as many as points",
    ),
]


def indexed(patch: UsdGeom.NurbsPatch, indices: list[int]) -> None:
    primvar = patch.CreateDisplayColorPrimvar("vertex")
    primvar.Set([Gf.Vec3f(1)] * 2)
    primvar.SetIndices(indices)


def scene() -> tuple[Shot, UsdGeom.NurbsPatch]:
    shot = Shot()
    good = shot.mesh("/Good", [(1, -3, 0), (7, -3, 0), (7, 3, 0), (1, 3, 0)])
    assert good
    patch = bumpy().define(shot, "/Bad")
    patch.AddTranslateOp().Set(Gf.Vec3d(-4, 0, 0))
    return shot, patch


def said(result: object) -> list[str]:
    return messages(result, "warning") + messages(result, "error")


@pytest.mark.parametrize(("spoil", "message"), BAD, ids=range(len(BAD)))
def test_what_makes_no_surface_is_one_message(spoil: Callable[[UsdGeom.NurbsPatch], object], message: str) -> None:
    shot, patch = scene()
    spoil(patch)
    result, pixels = render(shot.stage)
    (found,) = said(result)
    assert found.startswith(f"/Bad.{message}") and found.endswith("; the prim is not drawn")
    assert shows_good(pixels)
    assert not pixels[:, :14, 3].any()


@pytest.mark.parametrize(("spoil", "message"), MENDED, ids=range(len(MENDED)))
def test_what_can_do_without_is_drawn(spoil: Callable[[UsdGeom.NurbsPatch], object], message: str) -> None:
    shot, patch = scene()
    spoil(patch)
    result, pixels = render(shot.stage)
    (found,) = said(result)
    assert found.startswith(f"/Bad.{message}")
    assert shows_good(pixels)
    assert pixels[:, :14, 3].any()


def test_a_number_of_points_that_changes_holds_those_of_the_frame() -> None:
    shot, patch = scene()
    points = patch.GetPointsAttr().Get()
    patch.GetPointsAttr().Clear()
    for time, each in ((0.0, points[:7]), (1.0, points), (2.0, points)):
        patch.GetPointsAttr().Set(each, time)
    result, pixels = render(shot.stage)
    assert said(result) == [
        "/Bad.points: their number changes within the shutter; took the samples of 30, as at the frame"
    ]
    assert shows_good(pixels) and pixels[:, :14, 3].any()


def test_a_patch_drawn_together_to_a_point_is_no_picture() -> None:
    shot, _ = scene()
    bumpy(columns=4, rows=4, orders=(4, 4)).define(shot, "/Bad").GetPointsAttr().Set([Gf.Vec3f(0, 0, 0)] * 16)
    result, pixels = render(shot.stage)
    assert said(result) == []
    assert "/Bad: empty: its surface is a point" in messages(result, "note")
    assert shows_good(pixels)


def test_an_eye_in_the_surface_is_no_trouble() -> None:
    shot, patch = scene()
    patch.GetOrderedXformOps()[0].Set(Gf.Vec3d(0, 0, 20))
    result, pixels = render(shot.stage)
    assert np.isfinite(pixels).all()
    assert len(said(result)) <= 1
