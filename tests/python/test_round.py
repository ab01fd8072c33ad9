"""Curves and points from a stage to the scene: motion by USD's own evaluation, widths, messages.

How each basis becomes Bezier spans is held against its definition in C++ (tests/unit/test_curve_basis.cpp), pictures
against closed forms (tests/render/test_round_coverage.cpp).
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio
import pytest
from msbvh.cli.main import main
from pxr import Gf, Sdf, UsdGeom, Vt
from recording import Shot, messages, worst_deviation

PIXEL = 20 * 20.955 / 50 / 960
"""Of the default camera at the origin, in stage units."""
ZIGZAG = [(0, 0, 0), (1, 1, 0), (2, -1, 0.5), (3, 0, 0), (3.5, 1, 0), (3.5, 2, 0), (3, 3, 0)]


def curves(shot: Shot, path: str = "/Curves", points: Any = ZIGZAG, **tokens: str) -> UsdGeom.BasisCurves:
    prim = UsdGeom.BasisCurves.Define(shot.stage, path)
    prim.CreatePointsAttr([Gf.Vec3f(*p) for p in points])
    prim.CreateCurveVertexCountsAttr([len(points)])
    prim.CreateTypeAttr(tokens.get("type", "cubic"))
    prim.CreateBasisAttr(tokens.get("basis", "bezier"))
    prim.CreateWrapAttr(tokens.get("wrap", "nonperiodic"))
    prim.CreateWidthsAttr([0.25])
    prim.SetWidthsInterpolation("constant")
    return prim


def cloud(shot: Shot, path: str = "/Points", points: Any = ZIGZAG) -> UsdGeom.Points:
    prim = UsdGeom.Points.Define(shot.stage, path)
    prim.CreatePointsAttr([Gf.Vec3f(*p) for p in points])
    prim.CreateWidthsAttr([0.25] * len(points))
    return prim


def moved(points: Any, by: tuple[float, float, float]) -> Vt.Vec3fArray:
    return Vt.Vec3fArray([Gf.Vec3f(*p) + Gf.Vec3f(*by) for p in points])


@pytest.mark.parametrize("make", [curves, cloud])
def test_points_follow_their_samples(make: Any) -> None:
    shot = Shot()
    prim = make(shot)
    for time, by in ((8.0, (0, 0, 0)), (9.8, (1, 2, 0)), (10.1, (-1, 0, 0)), (12.0, (4, 4, 1))):
        prim.GetPointsAttr().Set(moved(ZIGZAG, by), time)
    result = shot.read()
    assert messages(result) == []
    assert worst_deviation(result, prim.GetPrim()) < 0.11 * PIXEL


@pytest.mark.parametrize("make", [curves, cloud])
@pytest.mark.parametrize("accelerate", [False, True])
def test_velocities_and_accelerations_carry_the_sample_at_the_frame(make: Any, accelerate: bool) -> None:
    shot = Shot()
    prim = make(shot)
    prim.GetPointsAttr().Set(moved(ZIGZAG, (0, 0, 0)), 10.0)
    prim.GetPointsAttr().Set(moved(ZIGZAG[:4], (0, 0, 0)), 11.0)  # born and died: rates say how to go on
    prim.CreateVelocitiesAttr().Set([Gf.Vec3f(30, 20 + i, 0) for i in range(len(ZIGZAG))], 10.0)
    prim.GetVelocitiesAttr().Set([Gf.Vec3f(1, 0, 0)] * 4, 11.0)
    if accelerate:
        prim.CreateAccelerationsAttr().Set([Gf.Vec3f(0, -900, 0)] * len(ZIGZAG), 10.0)
        prim.GetAccelerationsAttr().Set([Gf.Vec3f(0, 0, 0)] * 4, 11.0)
    result = shot.read()
    assert messages(result, "warning") == []
    assert worst_deviation(result, prim.GetPrim()) < 0.11 * PIXEL
    track = next(t for t in result.tracks if t.path == prim.GetPath())
    assert track.source == ("accelerations" if accelerate else "velocities")


@pytest.mark.parametrize("make", [curves, cloud])
def test_a_moving_transform_places_them(make: Any) -> None:
    shot = Shot()
    prim = make(shot)
    turn = prim.AddRotateZOp()
    turn.Set(0.0, 9.0)
    turn.Set(60.0, 11.0)
    result = shot.read()
    assert messages(result) == []
    assert worst_deviation(result, prim.GetPrim()) < 0.11 * PIXEL
    assert next(t for t in result.tracks if t.path == prim.GetPath()).moving_transform


@pytest.mark.parametrize("make", [curves, cloud])
def test_in_prototypes_of_point_instancers(make: Any) -> None:
    shot = Shot()
    instancer = UsdGeom.PointInstancer.Define(shot.stage, "/Instancer")
    prim = make(shot, "/Instancer/Thing")
    instancer.CreatePrototypesRel().AddTarget(prim.GetPath())
    instancer.CreateProtoIndicesAttr([0, 0, 0])
    instancer.CreatePositionsAttr([Gf.Vec3f(-3, 0, 0), Gf.Vec3f(0, 1, 0), Gf.Vec3f(3, 2, 0)])
    result = shot.read()
    assert messages(result) == []
    expected = np.array([np.add(p, at) for at in ((-3, 0, 0), (0, 1, 0), (3, 2, 0)) for p in ZIGZAG])
    found = result.scene.instance_points(0.5)
    assert found.shape == expected.shape
    assert np.abs(found - expected).max() < 1e-5


def alpha(shot: Shot, folder: Path, *options: str) -> np.ndarray:
    scene, image = folder / "scene.usda", folder / "out.exr"
    shot.stage.Export(str(scene))
    arguments = ["record", str(scene), str(image), "--imageWidth", "96", "--spp", "64", "--frames", "10", *options]
    assert main(arguments) == 0
    pixels = oiio.ImageBuf(str(image)).get_pixels(oiio.FLOAT)
    return pixels[:, :, 3]


def square_camera(shot: Shot, size: float) -> None:
    """Orthographic, `size` units wide and high."""
    shot.camera.CreateProjectionAttr("orthographic")
    shot.camera.CreateHorizontalApertureAttr(size * 10)
    shot.camera.CreateVerticalApertureAttr(size * 10)
    shot.camera.CreateClippingRangeAttr(Gf.Vec2f(1, 100))


def area(shot: Shot, folder: Path, size: float = 8.0) -> float:
    """What is covered on the average over the shutter, in square units."""
    square_camera(shot, size)
    return float(alpha(shot, folder).mean()) * size * size


def test_a_ribbon_covers_its_length_times_its_width(tmp_path: Path) -> None:
    shot = Shot()
    prim = curves(shot, points=[(-3, 0, 0), (0, 0, 0), (3, 0, 0)], type="linear")
    prim.GetWidthsAttr().Set([0.5])
    assert area(shot, tmp_path) == pytest.approx(3.0, rel=0.01)


@pytest.mark.parametrize(
    ("interpolation", "widths", "expected"),
    [
        ("constant", [0.5], 6.0),
        ("uniform", [0.5, 1.0], 3.0 + 6.0),
        ("varying", [0.5, 1.0, 0.5, 1.0, 0.5, 1.0], 4.5 + 4.5),
        ("vertex", [0.5, 1.0, 0.5, 0.0, 0.0, 0.0], 4.5),
    ],
)
def test_widths_of_every_interpolation(
    interpolation: str, widths: list[float], expected: float, tmp_path: Path
) -> None:
    shot = Shot()
    rows = [(x, y, 0) for y in (-2, 2) for x in (-3, 0, 3)]
    prim = curves(shot, points=rows, type="linear")
    prim.GetCurveVertexCountsAttr().Set([3, 3])
    prim.GetWidthsAttr().Set(widths)
    prim.SetWidthsInterpolation(interpolation)
    assert area(shot, tmp_path) == pytest.approx(expected, rel=0.015)


def test_widths_change_within_the_shutter(tmp_path: Path) -> None:
    shot = Shot()
    prim = curves(shot, points=[(-3, 0, 0), (3, 0, 0)], type="linear")
    for time, width in ((9.5, 0.0), (10.0, 1.0), (10.5, 0.0)):
        prim.GetWidthsAttr().Set([width], time)
    assert area(shot, tmp_path) == pytest.approx(3.0, rel=0.02)


def test_points_are_discs_and_scale_with_their_transform(tmp_path: Path) -> None:
    shot = Shot()
    prim = cloud(shot, points=[(-1, 0, 0), (1, 0, 0)])
    prim.GetWidthsAttr().Set([0.5, 1.0])
    prim.AddScaleOp().Set(Gf.Vec3f(2, 2, 2))
    assert area(shot, tmp_path) == pytest.approx(np.pi * (0.25 + 1.0), rel=0.02)


def test_points_that_come_and_go_are_those_of_the_frame(tmp_path: Path) -> None:
    shot = Shot()
    prim = cloud(shot, points=[(-1, 0, 0), (1, 0, 0)])
    prim.GetPointsAttr().Set([Gf.Vec3f(-1, 0, 0), Gf.Vec3f(1, 0, 0)], 10.0)
    prim.GetPointsAttr().Set([Gf.Vec3f(0, 0, 0)], 10.25)
    prim.CreateIdsAttr().Set([7, 8], 10.0)
    prim.GetIdsAttr().Set([9], 10.25)
    prim.GetWidthsAttr().Set([1.0, 1.0])
    assert area(shot, tmp_path) == pytest.approx(2 * np.pi * 0.25, rel=0.02)


def test_without_widths_they_are_one_wide_and_that_is_said_once() -> None:
    shot = Shot()
    for i in range(3):
        curves(shot, f"/Curves_{i}").GetPrim().RemoveProperty("widths")
    cloud(shot).GetPrim().RemoveProperty("widths")
    said = messages(shot.read(), "warning")
    assert said == ["/Curves_0.widths: not authored; drawn 1 wide (and 3 more prims)"]


def test_normals_of_curves_are_named() -> None:
    shot = Shot()
    curves(shot).CreateNormalsAttr([Gf.Vec3f(0, 0, 1)] * len(ZIGZAG))
    said = messages(shot.read(), "warning")
    assert said == ["/Curves.normals: curves are drawn turned to each ray, whatever their normals say"]


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


def test_colours_and_materials_of_curves(tmp_path: Path) -> None:
    shot = Shot()
    rows = [(x, y, 0) for y in (-2, 2) for x in (-3, 0, 3)]
    prim = curves(shot, points=rows, type="linear")
    prim.GetCurveVertexCountsAttr().Set([3, 3])
    primvar = UsdGeom.PrimvarsAPI(prim).CreatePrimvar("displayColor", Sdf.ValueTypeNames.Color3fArray, "uniform")
    primvar.Set([Gf.Vec3f(1, 0, 0), Gf.Vec3f(0, 1, 0)])
    prim.GetWidthsAttr().Set([2.0])
    square_camera(shot, 8.0)
    alpha(shot, tmp_path)
    pixels = oiio.ImageBuf(str(tmp_path / "out.exr")).get_pixels(oiio.FLOAT)
    upper, lower = pixels[24, 48], pixels[72, 48]
    assert upper[1] > 0.1
    assert upper[0] == 0.0
    assert lower[0] > 0.1
    assert lower[1] == 0.0
