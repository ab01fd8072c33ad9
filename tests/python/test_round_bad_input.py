"""Curves and points that are wrong leave one message, and the rest is drawn."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pxr import Gf, UsdGeom
from recording import Shot, messages
from round_stages import ZIGZAG, area, cloud, curves, hermite, nurbs, oriented


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
        ("widths", [-1.0], "widths: 1 of 1 curves are not drawn: curve 0 has the width -1; expected finite ones"),
        ("widths", [np.nan], "widths: 1 of 1 curves are not drawn: curve 0 has the width nan; expected finite ones"),
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
