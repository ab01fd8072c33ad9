"""Curves and points that are wrong leave one message, and the rest is drawn."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pxr import Gf, Sdf, UsdGeom, Vt
from recording import Shot, messages
from round_stages import ZIGZAG, area, cloud, curves, hermite, nurbs, oriented
from sound_neighbour import render, retype

KNOTS = [0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 4.0, 4.0, 4.0]


def spline(shot: Shot) -> UsdGeom.NurbsCurves:
    return nurbs(shot, ZIGZAG, 4, KNOTS)


def test_without_widths_they_are_one_wide_and_that_is_said_once() -> None:
    shot = Shot()
    for i in range(3):
        curves(shot, f"/Curves_{i}").GetPrim().RemoveProperty("widths")
    cloud(shot).GetPrim().RemoveProperty("widths")
    said = messages(shot.read(), "warning")
    assert said == ["/Curves_0.widths: not authored; drawn 1 wide (and 3 more prims)"]


@pytest.mark.parametrize(
    ("normals", "interpolation", "message"),
    [
        (
            [(0, 0, 1)] * 2,
            "vertex",
            "found 2 values; expected 3 for the interpolation vertex; drawn turned to each ray",
        ),
        ([(0, 0, 1), (0, np.nan, 1), (0, 0, 1)], "vertex", "nan"),
    ],
)
def test_normals_that_do_not_fit_leave_one_warning(
    normals: Any, interpolation: str, message: str, tmp_path: Path
) -> None:
    shot = Shot()
    oriented(shot, normals, interpolation)
    (said,) = messages(shot.read(), "warning")
    assert said.startswith("/Curves.normals: ") and message in said
    assert area(shot, tmp_path) == pytest.approx(6.0, rel=0.015)


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("order", [4, 4], "order: found 2 values; expected 1, one a curve"),
        ("order", [1], "order: 1 of 1 curves are not drawn: curve 0 cannot be read: found 1; expected 2 to"),
        ("knots", [0.0] * 3, "knots: found 3 values; expected 11, vertices and order of each curve"),
        ("knots", [0.0] * 11, "knots: 1 of 1 curves are not drawn: curve 0 cannot be read: knots 3 and 7 are both 0"),
        ("pointWeights", [1.0] * 6, "pointWeights: found 6 values; expected 7, one a point"),
        ("pointWeights", [0.0] * 7, "pointWeights: weight 0 is 0; expected finite ones above 0"),
        ("ranges", [Gf.Vec2d(3, 2)], "ranges: 1 of 1 curves are not drawn: curve 0 cannot be read: found (3, 2)"),
    ],
)
def test_bad_splines_leave_one_message_and_the_rest_is_drawn(name: str, value: Any, message: str) -> None:
    shot = Shot()
    shot.mesh("/Mesh")
    prim = nurbs(shot, ZIGZAG, 4, [0, 0, 0, 0, 1, 2, 3, 4, 4, 4, 4])
    prim.CreatePointWeightsAttr([1.0] * 7)
    prim.CreateRangesAttr([Gf.Vec2d(0, 4)])
    if name == "order" and value == [1]:
        prim.GetKnotsAttr().Set([0.0] * 8)
    if name == "order" and len(value) == 2:
        prim.GetKnotsAttr().Set([0.0] * 11)
    prim.GetPrim().GetAttribute(name).Set(value)
    result = shot.read()
    (said,) = messages(result)
    assert said.startswith(f"/Curves.{message}")
    assert list(result.scene.meshes) == ["/Mesh"] or "/Mesh" in result.scene.meshes


def test_tangents_that_are_not_as_many_are_named() -> None:
    shot = Shot()
    shot.mesh("/Mesh")
    hermite(shot, [(0, 0, 0), (1, 0, 0)], [(0, 3, 0)], [2])
    (said,) = messages(shot.read())
    assert said == "/Curves.tangents: found 1 values, expected 2, as many as points; the prim is not drawn"


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        (
            "widths",
            [-1.0],
            "widths: 1 of 1 curves are not drawn: curve 0 has the width -1; expected ones of at most 2^60",
        ),
        (
            "widths",
            [np.nan],
            "widths: 1 of 1 curves are not drawn: curve 0 has the width nan; expected ones of at most 2^60",
        ),
        ("widths", [1.0, 2.0], "widths: found 2 values; expected 1 for the interpolation constant"),
        ("curveVertexCounts", [4, 4], "curveVertexCounts: they add up to 8; expected 7, the number of points"),
        ("curveVertexCounts", [-7], "curveVertexCounts: found -7; expected none below 0"),
        ("curveVertexCounts", [5, 2], "curveVertexCounts: 2 of 2 curves are not drawn: curve 0 has 5 vertices"),
        ("basis", "power", 'basis: found type "cubic", basis "power"'),
        ("wrap", "closed", 'wrap: found type "cubic"'),
    ],
)
def test_bad_curves_leave_one_message_and_the_rest_is_drawn(name: str, value: Any, message: str) -> None:
    shot = Shot()
    shot.mesh("/Mesh")
    bad = curves(shot, "/Bad")
    bad.GetPrim().GetAttribute(name).Set(value)
    result = shot.read()
    (said,) = messages(result)
    assert said.startswith(f"/Bad.{message}")
    assert len(result.scene.points("/Mesh", 0.5)) == 4


@pytest.mark.parametrize("width", [-0.5, np.nan, np.inf])
def test_a_bad_width_of_a_point_leaves_out_that_point(width: float, tmp_path: Path) -> None:
    shot = Shot()
    prim = cloud(shot, points=[(-1, 0, 0), (1, 0, 0)])
    prim.GetWidthsAttr().Set([1.0, width])
    (said,) = messages(shot.read())
    assert said.startswith("/Points.widths: 1 of 2 points are not drawn: point 1 has the width ")
    assert area(shot, tmp_path) == pytest.approx(np.pi * 0.25, rel=0.02)


def test_nothing_there_is_a_note() -> None:
    shot = Shot()
    shot.mesh("/Mesh")
    UsdGeom.BasisCurves.Define(shot.stage, "/Curves")
    UsdGeom.Points.Define(shot.stage, "/Points")
    assert messages(shot.read(), "warning") == []
    assert messages(shot.read(), "error") == []
    assert len(messages(shot.read(), "note")) == 1


@pytest.mark.parametrize("make", [curves, cloud, spline])
def test_widths_of_another_type_are_one_message(make: Any) -> None:
    shot = Shot()
    prim = make(shot).GetPrim()
    retype(prim, "widths", Sdf.ValueTypeNames.String, "thin")
    result = shot.read()
    assert messages(result, "warning") == [f"{prim.GetPath()}.widths: found string, expected float[]; ignored"]
    assert len(result.scene.points(str(prim.GetPath()), 0.5)) >= len(ZIGZAG)


@pytest.mark.parametrize("make", [curves, cloud])
def test_an_interpolation_that_is_none(make: Any) -> None:
    shot = Shot()
    shot.mesh("/Mesh")
    prim = make(shot).GetPrim()
    prim.GetAttribute("widths").SetMetadata("interpolation", "edge")
    (said,) = messages(shot.read())
    assert said == (
        f'{prim.GetPath()}.widths: found the interpolation "edge"; expected constant, uniform, varying, vertex or'
        " faceVarying; the prim is not drawn"
    )


@pytest.mark.parametrize(
    ("normals", "said"),
    [
        ([(0, 0, 0)] * 3, "found 0 in all values; expected directions"),
        ([(0, 0, 1), (0, 3e38, 0), (0, 0, 1)], "value 1 is (0, 3e+38, 0); expected numbers of at most 2^60 in size"),
    ],
)
def test_normals_that_are_no_directions(normals: Any, said: str, tmp_path: Path) -> None:
    shot = Shot()
    oriented(shot, normals)
    (found,) = messages(shot.read(), "warning")
    assert found.replace("3.00000001e+38", "3e+38") == f"/Curves.normals: {said}; drawn turned to each ray"
    assert area(shot, tmp_path) == pytest.approx(6.0, rel=0.015)


@pytest.mark.parametrize("order", [0, 65, 2**31 - 1])
def test_an_order_that_is_none_is_named_rather_than_the_knots(order: int) -> None:
    shot = Shot()
    shot.mesh("/Mesh")
    spline(shot).GetOrderAttr().Set([order])
    (said,) = messages(shot.read())
    assert said == f"/Curves.order: found {order}; expected 2 to 64; the prim is not drawn"


def test_ranges_of_many_curves_are_one_message() -> None:
    shot, count = Shot(), 50
    prim = nurbs(shot, ZIGZAG * count, 4, KNOTS * count)
    prim.GetCurveVertexCountsAttr().Set([len(ZIGZAG)] * count)
    prim.GetOrderAttr().Set([4] * count)
    prim.CreateRangesAttr([Gf.Vec2d(-1, 9)] * count)
    (said,) = messages(shot.read())
    assert said == (
        "/Curves.ranges: found (-1, 9); expected a part of (0, 4), where the knots have a spline; drew that (and 49 more"
        " curves)"
    )


@pytest.mark.parametrize("make", [curves, spline, "hermite"])
@pytest.mark.parametrize("counts", [[2**31 - 1], [2**31 - 1, 2**31 - 1, 9], [-1, 8], [], [3], [2**31 - 1, -(2**31)]])
def test_counts_that_do_not_add_up(make: Any, counts: list[int]) -> None:
    shot = Shot()
    shot.mesh("/Mesh")
    prim = hermite(shot, ZIGZAG, ZIGZAG, [7]) if make == "hermite" else make(shot)
    prim.GetCurveVertexCountsAttr().Set(counts)
    (said,) = messages(shot.read())
    assert said.startswith("/Curves.") and said.endswith("; the prim is not drawn")


@pytest.mark.parametrize("wrap", ["nonperiodic", "periodic", "pinned"])
@pytest.mark.parametrize("basis", ["bezier", "bspline", "catmullRom"])
@pytest.mark.parametrize("kind", ["cubic", "linear"])
def test_curves_with_too_few_points_are_left_out(kind: str, basis: str, wrap: str) -> None:
    shot = Shot()
    prim = curves(shot, points=[(x, x % 2, 0) for x in range(14)], type=kind, basis=basis, wrap=wrap)
    prim.GetCurveVertexCountsAttr().Set([0, 1, 6, 0, 7])
    (said,) = messages(shot.read())
    assert " of 5 curves are not drawn: curve 0 has 0 vertices, which no " in said


@pytest.mark.parametrize("style", ["ribbon", "tube"])
@pytest.mark.parametrize("width", [1e-45, 1e-30, 1e10, 1e18])
@pytest.mark.parametrize("make", [curves, cloud])
def test_widths_of_any_size_are_drawn(make: Any, width: float, style: str) -> None:
    shot = Shot()
    prim = make(shot)
    prim.GetWidthsAttr().Set([width] * len(prim.GetWidthsAttr().Get()))
    result, pixels = render(shot.stage, 10.0, curves=style)
    assert messages(result, "warning") == []
    assert np.isfinite(pixels).all()


@pytest.mark.parametrize("make", [curves, cloud])
def test_very_many_at_one_place_are_no_trouble(make: Any) -> None:
    shot, count = Shot(), 50_000
    prim = make(shot)
    prim.GetPointsAttr().Set(Vt.Vec3fArray.FromNumpy(np.zeros((2 * count, 3), np.float32)))
    prim.GetWidthsAttr().Set([2.0])
    prim.GetWidthsAttr().SetMetadata("interpolation", "constant")
    if make is curves:
        prim.GetTypeAttr().Set("linear")
        points = np.tile(np.array([[0, 0, 0], [1, 1, 0]], np.float32), (count, 1))
        prim.GetPointsAttr().Set(Vt.Vec3fArray.FromNumpy(points))
        prim.GetCurveVertexCountsAttr().Set(Vt.IntArray([2] * count))
    result, pixels = render(shot.stage, 10.0)
    assert messages(result, "warning") == []
    assert pixels[:, :, 3].any()
