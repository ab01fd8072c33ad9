"""What curves and points cover: widths, normals, scales, in closed form.

How each basis becomes Bezier spans is held against its definition in C++ (tests/translate/test_curve_basis.cpp), pictures
against closed forms in C++ too (tests/render/test_round_coverage.cpp).
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio
import pytest
from pxr import Gf, Sdf, UsdGeom, Vt
from recording import Shot
from round_stages import TILT, alpha, area, cloud, curves, oriented, square_camera


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


@pytest.mark.parametrize("instanced", [False, True])
@pytest.mark.parametrize("make", [curves, cloud])
def test_what_has_width_scales_where_its_points_stay(make: Any, instanced: bool, tmp_path: Path) -> None:
    """All of its points lie in the origin, or the scale leaves them where they are."""
    shot = Shot()
    if make is curves:
        prim = curves(shot, points=[(-3, 0, 0), (3, 0, 0)], type="linear")
        prim.GetWidthsAttr().Set([0.5])
    else:
        prim = cloud(shot, points=[(0, 0, 0)])
        prim.GetWidthsAttr().Set([1.0])
    scaled = UsdGeom.Xformable(prim)
    if instanced:
        prototype = UsdGeom.Xform.Define(shot.stage, "/Class")
        Sdf.CopySpec(shot.stage.GetRootLayer(), prim.GetPath(), shot.stage.GetRootLayer(), "/Class/Shape")
        shot.stage.RemovePrim(prim.GetPath())
        prototype.GetPrim().SetSpecifier(Sdf.SpecifierClass)
        instance = UsdGeom.Xform.Define(shot.stage, "/Instance")
        instance.GetPrim().GetInherits().AddInherit("/Class")
        instance.GetPrim().SetInstanceable(True)
        scaled = UsdGeom.Xformable(instance)
    scale = scaled.AddScaleOp()
    along = 1.0 if make is curves else 0.0
    for time, size in ((9.5, 1.0), (10.5, 3.0)):
        scale.Set(Gf.Vec3f(1.0 if along else size, size, size), time)
    sizes = np.linspace(1.0, 3.0, 1001)
    expected = 6.0 * 0.5 * sizes.mean() if along else np.pi * ((0.5 * sizes) ** 2).mean()
    assert area(shot, tmp_path) == pytest.approx(expected, rel=0.02)


def test_points_that_come_and_go_are_those_of_the_frame(tmp_path: Path) -> None:
    shot = Shot()
    prim = cloud(shot, points=[(-1, 0, 0), (1, 0, 0)])
    prim.GetPointsAttr().Set([Gf.Vec3f(-1, 0, 0), Gf.Vec3f(1, 0, 0)], 10.0)
    prim.GetPointsAttr().Set([Gf.Vec3f(0, 0, 0)], 10.25)
    prim.CreateIdsAttr().Set([7, 8], 10.0)
    prim.GetIdsAttr().Set([9], 10.25)
    prim.GetWidthsAttr().Set([1.0, 1.0])
    assert area(shot, tmp_path) == pytest.approx(2 * np.pi * 0.25, rel=0.02)


@pytest.mark.parametrize(
    ("normals", "interpolation"),
    [([TILT] * 3, "vertex"), ([TILT] * 3, "varying"), ([TILT], "uniform"), ([TILT], "constant")],
)
def test_ribbons_lie_across_their_normals(normals: Any, interpolation: str, tmp_path: Path) -> None:
    shot = Shot()
    oriented(shot, normals, interpolation)
    assert area(shot, tmp_path) == pytest.approx(0.6 * 6.0, rel=0.015)


def test_normals_as_a_primvar_with_indices(tmp_path: Path) -> None:
    shot = Shot()
    prim = oriented(shot, [(0, 0, 1)] * 3)
    primvar = UsdGeom.PrimvarsAPI(prim).CreatePrimvar("normals", Sdf.ValueTypeNames.Normal3fArray, "vertex")
    primvar.Set([Gf.Vec3f(0, 1, 0), Gf.Vec3f(*TILT)])
    primvar.SetIndices(Vt.IntArray([1, 1, 1]))
    assert area(shot, tmp_path) == pytest.approx(0.6 * 6.0, rel=0.015)


def test_normals_turn_with_the_transform_and_within_the_shutter(tmp_path: Path) -> None:
    shot = Shot()
    oriented(shot, [(0, 0, 1)] * 3).AddRotateXOp().Set(np.degrees(np.arccos(0.6)))
    assert area(shot, tmp_path) == pytest.approx(0.6 * 6.0, rel=0.015)

    shot = Shot()
    prim = oriented(shot, [(0, 0, 1)] * 3)
    edges = np.linspace(0.0, np.pi / 2, 33)  # by many samples: each chord is as good as the arc
    for time, angle in zip(np.linspace(9.5, 10.5, 33), edges, strict=True):
        prim.GetNormalsAttr().Set([Gf.Vec3f(0, np.sin(angle), np.cos(angle))] * 3, float(time))
    assert area(shot, tmp_path) == pytest.approx(6.0 * 2.0 / np.pi, rel=0.02)


def test_tubes_are_round_whatever_the_normals_say(tmp_path: Path) -> None:
    shot = Shot()
    oriented(shot, [TILT] * 3)
    square_camera(shot, 8.0)
    covered = {}
    for style in ("ribbon", "tube"):
        covered[style] = float(alpha(shot, tmp_path, "--curves", style).mean()) * 64.0
    assert covered["ribbon"] == pytest.approx(0.6 * 6.0, rel=0.015)
    assert covered["tube"] == pytest.approx(6.0 + np.pi / 4, rel=0.015)


def test_a_periodic_curve_has_no_seam(tmp_path: Path) -> None:
    """The corner where it closes is as round as the others."""
    shot = Shot()
    prim = curves(shot, points=[(-2, -2, 0), (2, -2, 0), (2, 2, 0), (-2, 2, 0)], type="linear", wrap="periodic")
    prim.GetWidthsAttr().Set([1.0])
    assert area(shot, tmp_path) == pytest.approx(4 * 3.0 + 4 * (0.75 + np.pi / 16), rel=0.01)


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
