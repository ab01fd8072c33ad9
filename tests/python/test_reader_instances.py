"""Instances that the reader hands down against usd-core's own evaluation at 33 times of the shutter."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from pxr import Gf, Sdf, Usd, UsdGeom
from recording import DENSE_TIMES01, Shot, messages, transformed

TENTH_PIXEL = 0.1 * 20 * (20.955 / 50) / 960
SQUARE = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], float)

World = Callable[[Usd.TimeCode], np.ndarray]


def in_order(points: np.ndarray) -> np.ndarray:
    """Points sorted, so that two sets can be compared."""
    rounded = np.round(points, 3)
    return points[np.lexsort(rounded.T)]


def deviation(result, expected: World) -> float:
    """How far the instances' points stray from the expected ones, float64[N, 3] at a time code, at their
    worst."""
    worst = 0.0
    for time01 in DENSE_TIMES01:
        found = result.scene.instance_points(time01)
        wanted = expected(result.camera.shutter.time_code(time01))
        assert found.shape == wanted.shape
        distances = np.linalg.norm(found[:, None] - wanted[None], axis=-1)
        worst = max(worst, distances.min(axis=0).max(), distances.min(axis=1).max())
    return worst


def instancer_points(instancer: UsdGeom.PointInstancer, base: float, points: np.ndarray = SQUARE) -> World:
    """USD's own positions of every instance of a point instancer of a single square."""

    def at(code: Usd.TimeCode) -> np.ndarray:
        local = instancer.ComputeInstanceTransformsAtTime(code, base)
        world = np.array(UsdGeom.XformCache(code).GetLocalToWorldTransform(instancer.GetPrim()))
        return np.concatenate([transformed(points, np.array(matrix) @ world) for matrix in local])

    return at


def make_instancer(shot: Shot, path: str = "/Instancer", count: int = 5) -> UsdGeom.PointInstancer:
    instancer = UsdGeom.PointInstancer.Define(shot.stage, path)
    shot.mesh(f"{path}/Prototypes/Square")
    instancer.GetPrototypesRel().AddTarget(f"{path}/Prototypes/Square")
    instancer.CreateProtoIndicesAttr([0] * count)
    instancer.CreatePositionsAttr([(3 * index, 0, 0) for index in range(count)])
    return instancer


def test_positions_orientations_and_scales_that_are_sampled():
    # Single-precision orientations: half ones jitter by more than a tenth of a pixel.
    shot = Shot((-0.25, 0.5))
    instancer = make_instancer(shot)
    for time in (9.0, 9.9, 10.2, 11.0):
        turn = Gf.Quatf(Gf.Rotation(Gf.Vec3d(1, 1, 0), 40 * (time - 9)).GetQuat())
        instancer.GetPositionsAttr().Set([(3 * i, (time - 9) ** 2, i) for i in range(5)], time)
        instancer.CreateOrientationsfAttr().Set([turn] * 5, time)
        instancer.CreateScalesAttr().Set([(time - 8, 1, 1)] * 5, time)
    result = shot.read()
    assert deviation(result, instancer_points(instancer, 10.0)) < TENTH_PIXEL
    assert not messages(result, "warning")


@pytest.mark.parametrize("rate", [24.0, 30.0])
def test_velocities_accelerations_and_angular_velocities(rate):
    shot = Shot((-0.5, 0.25), rate)
    instancer = make_instancer(shot)
    UsdGeom.Xformable(instancer).AddRotateZOp().Set(30.0)
    for time in (9.0, 9.8, 11.0):
        instancer.GetPositionsAttr().Set([(3 * i, time, 0) for i in range(5)], time)
        instancer.CreateVelocitiesAttr().Set([(10, 20 * i, 0) for i in range(5)], time)
        instancer.CreateAccelerationsAttr().Set([(300, 0, -200 * i) for i in range(5)], time)
        instancer.CreateOrientationsAttr().Set([Gf.Quath(1)] * 5, time)
        instancer.CreateAngularVelocitiesAttr().Set([(0, 0, 900 * i) for i in range(5)], time)
    assert deviation(shot.read(), instancer_points(instancer, 10.0)) < TENTH_PIXEL


def test_a_prototype_that_moves_itself_and_an_instancer_that_moves():
    shot = Shot()
    instancer = make_instancer(shot)
    move = UsdGeom.Xformable(instancer).AddRotateYOp()
    own = UsdGeom.Mesh(shot.stage.GetPrimAtPath("/Instancer/Prototypes/Square")).AddRotateZOp()
    for op, speed in ((move, 50.0), (own, 80.0)):
        op.Set(0.0, 9.0)
        op.Set(speed, 11.0)
    assert deviation(shot.read(), instancer_points(instancer, 10.0)) < TENTH_PIXEL


def test_counts_that_change_with_velocities_keep_the_base_sample():
    shot = Shot()
    instancer = make_instancer(shot)
    for time, count in [(9.0, 3), (9.9, 7), (10.2, 2)]:
        instancer.GetProtoIndicesAttr().Set([0] * count, time)
        instancer.GetPositionsAttr().Set([(3 * i, 0, 0) for i in range(count)], time)
        instancer.CreateVelocitiesAttr().Set([(0, 24 * i, 0) for i in range(count)], time)
    result = shot.read()
    assert deviation(result, instancer_points(instancer, 10.0)) < 2e-5
    assert not messages(result, "warning")


def test_masked_instances_are_not_drawn():
    shot = Shot()
    instancer = make_instancer(shot)
    instancer.CreateIdsAttr([10, 11, 12, 13, 14])
    instancer.CreateInvisibleIdsAttr([11])
    instancer.GetPrim().SetMetadata("inactiveIds", Sdf.Int64ListOp.CreateExplicit([13]))
    result = shot.read()
    assert len(result.scene.maps(0.5)) == 3
    assert deviation(result, instancer_points(instancer, 10.0)) < 1e-6


def test_prototypes_are_not_drawn_by_themselves_and_draw_below_what_is_invisible():
    shot = Shot()
    instancer = make_instancer(shot)
    UsdGeom.Scope.Define(shot.stage, "/Instancer/Prototypes").MakeInvisible()
    result = shot.read()
    assert not result.scene.meshes
    assert deviation(result, instancer_points(instancer, 10.0)) < 1e-6


def test_prototypes_that_are_mere_overs():
    shot = Shot()
    instancer = make_instancer(shot)
    shot.stage.GetPrimAtPath("/Instancer/Prototypes").SetSpecifier(Sdf.SpecifierOver)
    assert deviation(shot.read(), instancer_points(instancer, 10.0)) < 1e-6


def test_colours_of_a_point_instancer_go_with_their_instances():
    shot = Shot()
    instancer = make_instancer(shot, count=4)
    shot.mesh("/Instancer/Prototypes/Other")
    instancer.GetPrototypesRel().AddTarget("/Instancer/Prototypes/Other")
    instancer.GetProtoIndicesAttr().Set([0, 1, 0, 1])
    primvar = UsdGeom.PrimvarsAPI(instancer).CreatePrimvar("displayColor", Sdf.ValueTypeNames.Color3fArray, "vertex")
    primvar.Set([(1, 0, 0), (0, 1, 0)])
    primvar.SetIndices([0, 1, 1, 0])
    found = {
        float(x): tuple(colour)
        for i in shot.read().scene.instances
        for x, colour in zip(3.0 * i["levels"][1].selected, i["display_color"].tolist(), strict=True)
    }
    assert found == {0.0: (1, 0, 0), 3.0: (0, 1, 0), 6.0: (0, 1, 0), 9.0: (1, 0, 0)}


def native_scene(instanceable: bool) -> Shot:
    """A referenced asset with a moving part in it, thrice: moving, still, and nested in another instance."""
    shot = Shot()
    for path, turn in (("/Asset", 70.0), ("/Pair", None)):
        shot.stage.CreateClassPrim(path)
        if turn:
            inner = UsdGeom.Xform.Define(shot.stage, f"{path}/Inner").AddRotateZOp()
            inner.Set(0.0, 9.0)
            inner.Set(turn, 11.0)
            shot.mesh(f"{path}/Inner/Square")
    for path in ("/Pair/A", "/Pair/B", "/World/One", "/World/Two", "/World/PairOne"):
        prim = UsdGeom.Xform.Define(shot.stage, path).GetPrim()
        prim.GetReferences().AddInternalReference("/Pair" if "PairOne" in path else "/Asset")
        prim.SetInstanceable(instanceable)
    UsdGeom.Xform.Get(shot.stage, "/Pair/B").AddTranslateOp().Set(Gf.Vec3d(0, -4, 0))
    move = UsdGeom.Xform.Get(shot.stage, "/World/One").AddRotateXOp()
    move.Set(0.0, 9.0)
    move.Set(-60.0, 11.0)
    UsdGeom.Xform.Get(shot.stage, "/World/Two").AddTranslateOp().Set(Gf.Vec3d(3, 0, 0))
    pair = UsdGeom.Xform.Get(shot.stage, "/World/PairOne").AddTranslateOp()
    pair.Set(Gf.Vec3d(-5, 0, 0), 9.0)
    pair.Set(Gf.Vec3d(-5, 3, 0), 11.0)
    return shot


def test_instanceable_on_and_off_are_the_same_picture():
    instanced, plain = native_scene(True).read(), native_scene(False)

    def expected(code: Usd.TimeCode) -> np.ndarray:
        cache = UsdGeom.XformCache(code)
        prims = [prim for prim in plain.stage.Traverse() if prim.IsA(UsdGeom.Mesh)]
        return np.concatenate([transformed(SQUARE, np.array(cache.GetLocalToWorldTransform(p))) for p in prims])

    assert not instanced.scene.meshes
    assert len(instanced.scene.prototypes) == 1
    # Both a part inside the prototype and its instance turn: the product of two tracks strays by the sum of
    # their errors.
    assert deviation(instanced, expected) < 2 * TENTH_PIXEL
    separate = plain.read()
    assert len(separate.scene.meshes) == 4
    for time01 in DENSE_TIMES01:
        code = separate.camera.shutter.time_code(time01)
        found = np.concatenate([separate.scene.points(path, time01) for path in separate.scene.meshes])
        assert np.abs(found - expected(code)).max() < TENTH_PIXEL


def test_point_instancers_in_point_instancers_with_native_instances_inside():
    shot = Shot()
    shot.stage.CreateClassPrim("/Asset")
    shot.mesh("/Asset/Square").AddTranslateOp().Set(Gf.Vec3d(0, 0, 0.5))
    outer = UsdGeom.PointInstancer.Define(shot.stage, "/Outer")
    inner = UsdGeom.PointInstancer.Define(shot.stage, "/Outer/Prototypes/Group/Inner")
    native = UsdGeom.Xform.Define(shot.stage, "/Outer/Prototypes/Group/Inner/Prototypes/Native")
    native.GetPrim().GetReferences().AddInternalReference("/Asset")
    native.GetPrim().SetInstanceable(True)
    native.AddTranslateOp().Set(Gf.Vec3d(0.1, 0, 0))
    UsdGeom.Xformable(inner).AddTranslateOp().Set(Gf.Vec3d(0, 0.3, 0))
    for instancer, target in ((outer, "/Outer/Prototypes/Group"), (inner, native.GetPath())):
        instancer.GetPrototypesRel().AddTarget(target)
        instancer.CreateProtoIndicesAttr([0, 0, 0])
        for time in (9.0, 11.0):
            turn = Gf.Quatf(Gf.Rotation(Gf.Vec3d(0, 0, 1), 30 * (time - 9)).GetQuat())
            instancer.CreatePositionsAttr().Set([(i, 2 * i, time - 9) for i in range(3)], time)
            instancer.CreateOrientationsfAttr().Set([turn] * 3, time)

    def expected(code: Usd.TimeCode) -> np.ndarray:
        asset = np.array(Gf.Matrix4d().SetTranslate(Gf.Vec3d(0, 0, 0.5)))
        own = np.array(Gf.Matrix4d().SetTranslate(Gf.Vec3d(0, 0.3, 0)))
        inside = [asset @ np.array(m) @ own for m in inner.ComputeInstanceTransformsAtTime(code, 10.0)]
        outside = [np.array(m) for m in outer.ComputeInstanceTransformsAtTime(code, 10.0)]
        return np.concatenate([transformed(SQUARE, a @ b) for a in inside for b in outside])

    result = shot.read()
    assert len(result.scene.maps(0.5)) == 9
    assert deviation(result, expected) < TENTH_PIXEL


def test_instances_that_inherit_different_colours_do_not_share_them():
    shot = Shot()
    shot.stage.CreateClassPrim("/Asset")
    shot.mesh("/Asset/Square")
    for name, colour in (("Red", (1, 0, 0)), ("Blue", (0, 0, 1)), ("AlsoRed", None)):
        prim = UsdGeom.Xform.Define(shot.stage, f"/World/{name}/Instance").GetPrim()
        prim.GetReferences().AddInternalReference("/Asset")
        prim.SetInstanceable(True)
        if colour:
            api = UsdGeom.PrimvarsAPI(shot.stage.GetPrimAtPath(f"/World/{name}"))
            api.CreatePrimvar("displayColor", Sdf.ValueTypeNames.Color3fArray, "constant").Set([colour])
    meshes = [mesh for _, meshes in shot.read().scene.prototypes for mesh in meshes.values()]
    found = [mesh["display_color"] and mesh["display_color"][1].tolist() for mesh in meshes]
    assert found == [[[1, 0, 0]], [[0, 0, 1]], None]


def test_invisible_instances_and_instancers_are_not_drawn():
    shot = native_scene(True)
    instancer = make_instancer(shot)
    UsdGeom.Xform.Define(shot.stage, "/World")
    UsdGeom.Imageable(instancer).MakeInvisible()
    UsdGeom.Imageable(shot.stage.GetPrimAtPath("/World")).MakeInvisible()
    assert shot.read().scene.instances == []


@pytest.mark.parametrize("attribute", ["positions", "scales", "orientations"])
def test_arrays_that_do_not_fit_leave_an_error_and_the_rest(attribute):
    shot = Shot()
    shot.mesh("/Mesh")
    instancer = make_instancer(shot)
    values = {"positions": [(0, 0, 0)], "scales": [(1, 1, 1)] * 2, "orientations": [Gf.Quath(1)] * 3}[attribute]
    instancer.GetPrim().GetAttribute(attribute).Set(values)
    result = shot.read()
    expected = f"/Instancer.{attribute}: found {len(values)} values, expected 5, one an instance; not drawn"
    assert messages(result, "error") == [expected]
    assert not result.scene.instances and result.scene.meshes


def test_indices_of_no_prototype_leave_an_error_and_the_others():
    shot = Shot()
    instancer = make_instancer(shot)
    instancer.GetProtoIndicesAttr().Set([0, 7, 0, -1, 0])
    result = shot.read()
    (error,) = messages(result, "error")
    assert error.startswith("/Instancer.protoIndices: found -1, 7, expected the index of one of 1 prototypes")
    assert len(result.scene.maps(0.5)) == 3


def test_a_prototype_that_instances_itself_is_an_error():
    shot = Shot()
    instancer = make_instancer(shot)
    instancer.GetPrototypesRel().SetTargets(["/Instancer"])
    result = shot.read()
    assert any("a prototype that instances itself" in message for message in messages(result, "error"))


def test_each_instance_has_its_own_opacity():
    shot = Shot()
    opacity = UsdGeom.PrimvarsAPI(make_instancer(shot)).CreatePrimvar(
        "displayOpacity", Sdf.ValueTypeNames.FloatArray, "vertex"
    )
    opacity.Set([0.125, 0.25, 0.5, 0.75, 1.0])
    result = shot.read()
    given = [values["displayOpacity"] for values in map(result.scene.instance_primvars, {"/Instancer"})]
    assert sorted(value for values in given for value in values) == [0.125, 0.25, 0.5, 0.75, 1.0]
    assert not messages(result, "warning")


def test_velocities_that_do_not_fit_the_positions_are_named():
    shot = Shot()
    instancer = make_instancer(shot)
    instancer.GetPositionsAttr().Set(instancer.GetPositionsAttr().Get(), 10.0)
    instancer.CreateVelocitiesAttr().Set([(24, 0, 0)], 10.0)
    warning = "/Instancer.velocities: not used: found 1 values, expected 5, as many as positions"
    assert warning in messages(shot.read(), "warning")
