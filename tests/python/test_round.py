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


def test_without_widths_they_are_one_wide_and_that_is_said_once() -> None:
    shot = Shot()
    for i in range(3):
        curves(shot, f"/Curves_{i}").GetPrim().RemoveProperty("widths")
    cloud(shot).GetPrim().RemoveProperty("widths")
    said = messages(shot.read(), "warning")
    assert said == ["/Curves_0.widths: not authored; drawn 1 wide (and 3 more prims)"]


def oriented(shot: Shot, normals: Any, interpolation: str = "vertex") -> UsdGeom.BasisCurves:
    """A straight ribbon of 6 x 1, of two spans, across its normals."""
    prim = curves(shot, points=[(-3, 0, 0), (0, 0, 0), (3, 0, 0)], type="linear")
    prim.GetWidthsAttr().Set([1.0])
    prim.CreateNormalsAttr([Gf.Vec3f(*n) for n in normals])
    prim.SetNormalsInterpolation(interpolation)
    return prim


TILT = (0.0, 0.8, 0.6)
"""Of a ribbon along x: seen along z it is 0.6 times as wide."""


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


def test_tubes_are_round_whatever_the_normals_say(tmp_path: Path) -> None:
    shot = Shot()
    oriented(shot, [TILT] * 3)
    square_camera(shot, 8.0)
    covered = {}
    for style in ("ribbon", "tube"):
        covered[style] = float(alpha(shot, tmp_path, "--curves", style).mean()) * 64.0
    assert covered["ribbon"] == pytest.approx(0.6 * 6.0, rel=0.015)
    assert covered["tube"] == pytest.approx(6.0 + np.pi / 4, rel=0.015)


def hermite(shot: Shot, points: Any, tangents: Any, counts: list[int]) -> UsdGeom.HermiteCurves:
    prim = UsdGeom.HermiteCurves.Define(shot.stage, "/Curves")
    prim.CreatePointsAttr([Gf.Vec3f(*p) for p in points])
    prim.CreateTangentsAttr([Gf.Vec3f(*t) for t in tangents])
    prim.CreateCurveVertexCountsAttr(counts)
    prim.CreateWidthsAttr([0.25])
    prim.SetWidthsInterpolation("constant")
    return prim


def bezier_points(result: Any, path: str = "/Curves", time01: float = 0.5) -> np.ndarray:
    return np.asarray(result.scene.points(path, time01))


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


def nurbs(shot: Shot, points: Any, order: int, knots: list[float]) -> UsdGeom.NurbsCurves:
    prim = UsdGeom.NurbsCurves.Define(shot.stage, "/Curves")
    prim.CreatePointsAttr([Gf.Vec3f(*p) for p in points])
    prim.CreateCurveVertexCountsAttr([len(points)])
    prim.CreateOrderAttr([order])
    prim.CreateKnotsAttr(knots)
    prim.CreateWidthsAttr([0.25])
    prim.SetWidthsInterpolation("constant")
    return prim


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


def test_a_periodic_curve_has_no_seam(tmp_path: Path) -> None:
    """The corner where it closes is as round as the others."""
    shot = Shot()
    prim = curves(shot, points=[(-2, -2, 0), (2, -2, 0), (2, 2, 0), (-2, 2, 0)], type="linear", wrap="periodic")
    prim.GetWidthsAttr().Set([1.0])
    assert area(shot, tmp_path) == pytest.approx(4 * 3.0 + 4 * (0.75 + np.pi / 16), rel=0.01)


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
