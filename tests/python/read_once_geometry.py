"""Cases of docs/design/read-once.md: visibility, faces, subsets, instances and primvars of meshes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from drawn import assert_as_the_stage
from pxr import Gf, Sdf, Usd, UsdGeom
from read_once import (
    BLUE,
    COLOURS,
    GREEN,
    RED,
    SHUTTER,
    assert_covers_as_the_stage,
    bind,
    case,
    glowing,
    mean_of_halves,
    named,
    picture,
    row_of_squares,
    set_in_turn,
    shares,
    wide_squares,
)
from recording import DENSE_TIMES01, Shot, interpolated, messages


@case("visibility")
def _visibility() -> None:
    shot = Shot(SHUTTER)
    visibility = UsdGeom.Imageable(row_of_squares(shot)).CreateVisibilityAttr()
    set_in_turn(visibility, ("inherited", "invisible", "inherited"))
    assert_covers_as_the_stage(shot)


@case("holeIndices")
def _holes() -> None:
    shot = Shot(SHUTTER)
    set_in_turn(row_of_squares(shot).CreateHoleIndicesAttr(), ([0], [1, 2], []))
    assert_covers_as_the_stage(shot)


@case("holeIndices")
def _holes_and_a_blinking_parent_of_instances() -> None:
    shot = Shot(SHUTTER)
    shot.stage.CreateClassPrim("/Asset")
    set_in_turn(row_of_squares(shot, "/Asset/Mesh").CreateHoleIndicesAttr(), ([0], [], [0, 1]))
    for name, y in (("One", 2.0), ("Two", -2.0)):
        prim = UsdGeom.Xform.Define(shot.stage, f"/{name}")
        prim.GetPrim().GetReferences().AddInternalReference("/Asset")
        prim.GetPrim().SetInstanceable(True)
        prim.AddTranslateOp().Set(Gf.Vec3d(0, y, 0))
    visibility = UsdGeom.Imageable.Get(shot.stage, "/Two").CreateVisibilityAttr()
    set_in_turn(visibility, ("inherited", "invisible"), (9.0, 10.1))
    assert_covers_as_the_stage(shot)


@case("holeIndices")
def _holes_under_a_blur_scale() -> None:
    for blur in (0.0, 0.5, 2.0):
        shot = Shot(SHUTTER)
        mesh = row_of_squares(shot)
        set_in_turn(mesh.CreateHoleIndicesAttr(), ([0], [1, 2], []), (9.0, 10.1, 10.6))
        UsdGeom.MotionAPI.Apply(mesh.GetPrim()).CreateMotionBlurScaleAttr(blur)
        assert_covers_as_the_stage(shot)


@case("holeIndices")
def _holes_of_a_topology_that_changes_are_the_frames() -> None:
    shot = Shot(SHUTTER)
    mesh = row_of_squares(shot)
    mesh.GetFaceVertexCountsAttr().Set([4, 4, 4], 9.0)
    mesh.GetFaceVertexCountsAttr().Set([6, 6], 10.1)
    set_in_turn(mesh.CreateHoleIndicesAttr(), ([0], [2], [0]))
    assert_covers_as_the_stage(shot)


@case("holeIndices")
def _more_changes_than_meshes_are_worth_are_named() -> None:
    shot = Shot(SHUTTER)
    mesh = row_of_squares(shot)
    mesh.GetFaceVertexCountsAttr().Set([3, 3, 3, 3])
    subset = UsdGeom.Subset.CreateGeomSubset(mesh, "A", "face", [], "materialBind")
    for step in range(100):
        mesh.CreateHoleIndicesAttr().Set([i for i in range(4) if step >> i & 1], 9.75 + 0.0075 * step)
        subset.GetIndicesAttr().Set([i for i in range(4) if step >> (i + 4) & 1], 9.75 + 0.0075 * step)
    for name in ("/Mesh.holeIndices", "/Mesh/A.indices"):
        named(shot, name, "expected at most 32", "held")


@case("GeomSubset.indices")
def _subsets() -> None:
    shot = Shot(SHUTTER)
    mesh = wide_squares(shot)
    for name, colour, faces in (("A", RED, ([0], [0, 1], [1])), ("B", BLUE, ([1], [], [0]))):
        subset = UsdGeom.Subset.CreateGeomSubset(mesh, name, "face", [], "materialBind")
        set_in_turn(subset.GetIndicesAttr(), faces)
        bind(subset, glowing(shot, f"/Looks/{name}", colour))
    left, right = mean_of_halves(picture(shot))
    before, between, after = shares()
    assert left == pytest.approx([before + between, 0, after], abs=0.02)
    assert right == pytest.approx([between + after, 0, before], abs=0.02)


@case("primvars:normals:indices")
def _indices_of_normals() -> None:
    shot = Shot(SHUTTER)
    api = UsdGeom.PrimvarsAPI(shot.mesh("/Mesh"))
    primvar = api.CreatePrimvar("normals", Sdf.ValueTypeNames.Normal3fArray, "vertex")
    primvar.Set([(0, 0, 1), (0, 1, 0)])
    primvar.CreateIndicesAttr()
    set_in_turn(primvar.GetIndicesAttr(), ([0, 0, 0, 0], [0, 1, 0, 1], [1, 1, 1, 1]))
    meshes = list(shot.read().scene.meshes.values())
    seen = sorted((float(np.ravel(m["visible"])[0]), m["normals_indices"].tolist()) for m in meshes)
    assert [indices for _, indices in seen] == [[0, 0, 0, 0], [0, 1, 0, 1], [1, 1, 1, 1]]
    assert [begin for begin, _ in seen] == pytest.approx([0.0, 0.4, 0.6])


def points(shot: Shot, count: int = 4) -> UsdGeom.PointInstancer:
    """Instances in a row that move upwards: a square and a triangle."""
    instancer = UsdGeom.PointInstancer.Define(shot.stage, "/Points")
    shot.mesh("/Points/Square")
    shot.mesh("/Points/Triangle", [(0, 0, 0), (1.5, 0, 0), (0, 1.5, 0)])
    instancer.CreatePrototypesRel().SetTargets(["/Points/Square", "/Points/Triangle"])
    instancer.CreateProtoIndicesAttr([i % 2 for i in range(count)])
    for time, y in ((9.0, -1.0), (11.0, 1.0)):
        instancer.CreatePositionsAttr().Set([(2 * i - count, y, 0) for i in range(count)], time)
    return instancer


@case("PointInstancer.protoIndices")
def _prototype_indices() -> None:
    shot = Shot(SHUTTER)
    instancer = points(shot)
    set_in_turn(instancer.GetProtoIndicesAttr(), ([0, 1, 0, 1], [1, 1, 0, 0], [0, 1, 1, 0]))
    assert_as_the_stage(shot)
    assert_covers_as_the_stage(shot)
    assert not messages(shot.read(), "warning")


@case("PointInstancer.protoIndices")
def _prototype_indices_under_a_blur_scale() -> None:
    shot = Shot(SHUTTER)
    instancer = points(shot)
    set_in_turn(instancer.GetProtoIndicesAttr(), ([0, 1, 0, 1], [1, 1, 0, 0], [0, 1, 1, 0]), (9.0, 10.1, 10.6))
    UsdGeom.MotionAPI.Apply(instancer.GetPrim()).CreateMotionBlurScaleAttr(2.0)
    assert_as_the_stage(shot)


@case("PointInstancer.protoIndices")
def _prototype_indices_of_another_number_are_the_frames() -> None:
    shot = Shot(SHUTTER)
    set_in_turn(points(shot).GetProtoIndicesAttr(), ([0, 1, 0, 1], [1, 1, 0], [0, 1, 1, 0]))
    assert_as_the_stage(shot)
    (warning,) = messages(shot.read(), "warning")
    assert warning.startswith("/Points.protoIndices: ") and "the frame's" in warning


@case("PointInstancer.protoIndices")
def _prototype_indices_that_velocities_carry_are_the_frames() -> None:
    shot = Shot(SHUTTER)
    instancer = points(shot)
    set_in_turn(instancer.GetProtoIndicesAttr(), ([0, 1, 0, 1], [1, 1, 0, 0], [0, 1, 1, 0]))
    for time in (9.0, 11.0):
        instancer.CreateVelocitiesAttr().Set([(24, 0, 0)] * 4, time)
    assert_as_the_stage(shot)


@case("PointInstancer.invisibleIds")
@case("PointInstancer.ids")
def _invisible_ids() -> None:
    for blur in (1.0, 0.0, 2.0):
        shot = Shot(SHUTTER)
        instancer = points(shot)
        instancer.CreateIdsAttr([7, 5, 3, 1])
        set_in_turn(instancer.CreateInvisibleIdsAttr(), ([5], [7, 3], []))
        UsdGeom.MotionAPI.Apply(instancer.GetPrim()).CreateMotionBlurScaleAttr(blur)
        assert_as_the_stage(shot)


@case("PointInstancer.ids")
def _ids() -> None:
    shot = Shot(SHUTTER)
    instancer = points(shot)
    instancer.CreateInvisibleIdsAttr([5, 1])
    set_in_turn(instancer.CreateIdsAttr(), ([7, 5, 3, 1], [5, 1, 3, 7], [1, 2, 3, 4]))
    set_in_turn(instancer.GetProtoIndicesAttr(), ([0, 1, 0, 1], [1, 1, 0, 0]), (9.0, 10.1))
    assert_as_the_stage(shot)


def primvar_at(primvar: UsdGeom.Primvar, code: Usd.TimeCode) -> np.ndarray:
    """By USD's own flattening."""
    return np.array(primvar.ComputeFlattened(code), float)


def assert_primvar_follows(shot: Shot, primvar: UsdGeom.Primvar, name: str) -> None:
    """What the visible mesh is handed down with is what USD computes at any time."""
    result = shot.read()
    for time01 in DENSE_TIMES01[:-1]:
        (mesh,) = [mesh for mesh in result.scene.meshes.values() if shows(mesh, time01)]
        interpolation, values, indices = mesh[name]
        assert interpolation == str(primvar.GetInterpolation())
        times01, samples = zip(*values, strict=True) if isinstance(values, list) else ((0.0,), (values,))
        assert (np.diff(times01) > 0).all()
        found = interpolated(times01, samples, time01)
        expected = primvar_at(primvar, result.camera.shutter.time_code(time01))
        assert np.abs((found if indices is None else found[indices]) - expected).max() < 1e-5, f"at {time01}"
    assert not messages(result, "warning")


def shows(mesh: dict, time01: float) -> bool:
    visible = mesh["visible"]
    return visible is None or bool(((visible[:, 0] <= time01) & (time01 < visible[:, 1])).any())


@case("primvars:displayColor")
def _colours() -> None:
    shot = Shot(SHUTTER)
    primvar = shot.mesh("/Mesh").CreateDisplayColorPrimvar("vertex")
    set_in_turn(primvar, ([RED, RED, GREEN, BLUE], [GREEN, BLUE, RED, RED], [RED] * 4), (9.0, 10.1, 11.0))
    assert_primvar_follows(shot, primvar, "display_color")


@case("primvars:displayColor:indices")
def _indices_of_colours() -> None:
    shot = Shot(SHUTTER)
    primvar = shot.mesh("/Mesh").CreateDisplayColorPrimvar("vertex")
    set_in_turn(primvar, ([RED, GREEN], [BLUE, GREEN], [RED, RED]), (9.0, 10.1, 11.0))
    primvar.CreateIndicesAttr()
    set_in_turn(primvar.GetIndicesAttr(), ([0, 0, 1, 1], [1, 0, 1, 0], [0, 0, 0, 0]))
    assert_primvar_follows(shot, primvar, "display_color")


@case("primvars:displayColor:indices")
def _values_and_indices_of_another_number_at_each_sample() -> None:
    shot = Shot(SHUTTER)
    primvar = shot.mesh("/Mesh").CreateDisplayColorPrimvar("faceVarying")
    set_in_turn(primvar, ([RED, GREEN], [BLUE, GREEN, RED], [GREEN]))
    primvar.CreateIndicesAttr()
    set_in_turn(primvar.GetIndicesAttr(), ([0, 0, 1, 1], [2, 0, 1, 0], [0, 0, 0, 0]))
    assert_primvar_follows(shot, primvar, "display_color")


@case("primvars:displayColor:indices")
def _indices_on_an_implicit_shape() -> None:
    shot = Shot(SHUTTER)
    shape = UsdGeom.Cube.Define(shot.stage, "/Mesh")
    shape.CreateSizeAttr(200.0)
    shot.camera.GetOrderedXformOps()[0].Set(Gf.Vec3d(0, 0, 120))
    bind(shape, glowing(shot, "/Look", None))
    primvar = shape.CreateDisplayColorPrimvar("constant")
    primvar.Set([RED, GREEN, BLUE])
    primvar.CreateIndicesAttr()
    set_in_turn(primvar.GetIndicesAttr(), ([0], [2], [1]))
    assert picture(shot)[..., :3].mean(axis=(0, 1)) == pytest.approx(shares() @ COLOURS[[0, 2, 1]], abs=0.02)


@case("primvars:displayColor:indices")
def _indices_on_a_held_stage() -> None:
    shot = Shot(SHUTTER)
    shot.stage.SetInterpolationType(Usd.InterpolationTypeHeld)
    primvar = shot.mesh("/Mesh").CreateDisplayColorPrimvar("vertex")
    set_in_turn(primvar, ([RED, GREEN], [BLUE, GREEN]), (9.0, 10.1))
    primvar.CreateIndicesAttr()
    set_in_turn(primvar.GetIndicesAttr(), ([0, 0, 1, 1], [1, 0, 1, 0], [0, 0, 0, 0]))
    assert_primvar_follows(shot, primvar, "display_color")


@case("primvars:displayColor:indices")
def _indices_of_colours_in_the_picture() -> None:
    shot = Shot(SHUTTER)
    mesh = wide_squares(shot)
    bind(mesh, glowing(shot, "/Look", None))
    primvar = mesh.CreateDisplayColorPrimvar("uniform")
    primvar.Set([RED, GREEN, BLUE])
    primvar.CreateIndicesAttr()
    set_in_turn(primvar.GetIndicesAttr(), ([0, 1], [2, 2], [1, 0]))
    left, right = mean_of_halves(picture(shot))
    assert left == pytest.approx(shares() @ COLOURS[[0, 2, 1]], abs=0.02)
    assert right == pytest.approx(shares() @ COLOURS[[1, 2, 0]], abs=0.02)


@case("primvars:displayColor:indices")
def _indices_that_point_nowhere_for_a_while_are_named() -> None:
    shot = Shot(SHUTTER)
    primvar = shot.mesh("/Mesh").CreateDisplayColorPrimvar("vertex")
    primvar.Set([RED, GREEN])
    primvar.CreateIndicesAttr()
    set_in_turn(primvar.GetIndicesAttr(), ([0, 0, 1, 1], [1, 7, 1, 0], [0, 0, 0, 0]))
    (warning,) = messages(shot.read(), "warning")
    assert warning.startswith("/Mesh.primvars:displayColor: index 1 is 7; expected less than 2")


@case("primvars:displayOpacity")
def _opacity() -> None:
    shot = Shot(SHUTTER)
    primvar = shot.mesh("/Mesh").CreateDisplayOpacityPrimvar("vertex")
    set_in_turn(primvar, ([0.5, 1, 1, 1], [1, 0, 1, 0], [1, 1, 0, 0]), (9.0, 10.1, 11.0))
    assert_primvar_follows(shot, primvar, "display_opacity")


@case("primvars:displayOpacity:indices")
def _indices_of_opacity() -> None:
    shot = Shot(SHUTTER)
    primvar = shot.mesh("/Mesh").CreateDisplayOpacityPrimvar("vertex")
    primvar.Set([0.5, 1.0])
    primvar.CreateIndicesAttr()
    set_in_turn(primvar.GetIndicesAttr(), ([0, 0, 1, 1], [1, 0, 1, 0], [0, 0, 0, 0]))
    assert_primvar_follows(shot, primvar, "display_opacity")


def _zigzag(shot: Shot) -> UsdGeom.BasisCurves:
    curves = UsdGeom.BasisCurves.Define(shot.stage, "/Curves")
    curves.CreateTypeAttr("linear")
    curves.CreatePointsAttr([Gf.Vec3f(x, x % 2, 0) for x in range(6)])
    curves.CreateCurveVertexCountsAttr([6])
    curves.CreateWidthsAttr([0.1] * 6)
    return curves


@case("BasisCurves.widths")
def _widths() -> None:
    shot = Shot(SHUTTER)
    attribute = _zigzag(shot).GetWidthsAttr()
    set_in_turn(attribute, ([0.1] * 6, [0.5, 0, 1, 1, 0, 2], [0.2] * 6))
    result = shot.read()
    _, samples, _ = result.scene.meshes["/Curves"]["widths"]
    times, values = zip(*samples, strict=True)
    for time01 in DENSE_TIMES01:
        expected = np.array(attribute.Get(result.camera.shutter.time_code(time01)))
        assert interpolated(times, values, time01) == pytest.approx(expected, abs=1e-5)
    assert next(t for t in result.tracks if t.path == "/Curves").segments >= 2


@case("HermiteCurves.tangents")
def _tangents() -> None:
    shot = Shot(SHUTTER)
    curves = UsdGeom.HermiteCurves.Define(shot.stage, "/Curves")
    curves.CreatePointsAttr([Gf.Vec3f(0, 0, 0), Gf.Vec3f(1, 0, 0)])
    curves.CreateCurveVertexCountsAttr([2])
    curves.CreateWidthsAttr([0.1, 0.1])
    tangents = [[Gf.Vec3f(0, y, 0), Gf.Vec3f(x, 0, 0)] for x, y in ((3, 3), (6, -3), (3, 9))]
    set_in_turn(curves.CreateTangentsAttr(), tangents)
    result = shot.read()
    for time01 in DENSE_TIMES01:
        (a, b) = curves.GetTangentsAttr().Get(result.camera.shutter.time_code(time01))
        expected = np.array([(0, 0, 0), a / 3, Gf.Vec3f(1, 0, 0) - b / 3, (1, 0, 0)])
        assert np.abs(result.scene.points("/Curves", time01) - expected).max() < 1e-2


def _spline(name: str, values: Sequence[object]) -> None:
    shot = Shot(SHUTTER)
    curves = UsdGeom.NurbsCurves.Define(shot.stage, "/Curves")
    curves.CreatePointsAttr([Gf.Vec3f(x, x % 2, 0) for x in range(4)])
    curves.CreateCurveVertexCountsAttr([4])
    curves.CreateOrderAttr([4])
    curves.CreateKnotsAttr([0, 0, 0, 0, 1, 1, 1, 1])
    curves.CreateRangesAttr([Gf.Vec2d(0, 1)])
    curves.CreatePointWeightsAttr([1, 1, 1, 1])
    curves.CreateWidthsAttr([0.1, 0.1])
    set_in_turn(curves.GetPrim().GetAttribute(name), values)
    named(shot, f"/Curves.{name}", "changes within the shutter", "as the topology")


@case("NurbsCurves.order")
def _orders() -> None:
    _spline("order", ([4], [4, 4], [4]))


@case("NurbsCurves.knots")
def _knots_of_curves() -> None:
    _spline("knots", ([0, 0, 0, 0, 1, 1, 1, 1], [0, 0, 0, 0, 2, 2, 2, 2], [0, 0, 0, 0, 1, 1, 1, 1]))


@case("NurbsCurves.ranges")
def _ranges() -> None:
    _spline("ranges", ([Gf.Vec2d(0, 1)], [Gf.Vec2d(0, 0.5)], [Gf.Vec2d(0, 1)]))


@case("NurbsCurves.pointWeights")
def _weights_of_curves() -> None:
    _spline("pointWeights", ([1, 1, 1, 1], [1, 2, 1, 1], [1, 1, 1, 1]))


@case("BasisCurves.curveVertexCounts")
def _numbers_of_vertices() -> None:
    shot = Shot(SHUTTER)
    set_in_turn(_zigzag(shot).GetCurveVertexCountsAttr(), ([6], [3, 3], [2, 4]))
    named(shot, "/Curves.points", "the topology changes within the shutter", "held the frame's pose")
