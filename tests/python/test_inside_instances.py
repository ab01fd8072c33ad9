"""What leaves the motion of its instance, in part or altogether: !resetXformStack! and a motion:blurScale of its own.

Native instances are a way to share, not a way to move: what stands inside them moves as usd-core's XformCache has it
of the instance proxies. Prototypes of point instancers have a space of their own, where a reset leads back to the
instance's place (UsdImaging's resetXformStack on the root, of which the root's own transform is a part).
"""

from __future__ import annotations

import numpy as np
import pytest
from drawn import assert_as_the_stage, drawn_at
from pxr import Gf, Usd, UsdGeom, UsdLux, UsdSkel, Vt
from recording import DENSE_TIMES01, Shot, messages

SHUTTER = (-0.25, 0.5)


def slide(prim: Usd.Prim | UsdGeom.Xformable, *places: tuple[float, float]) -> UsdGeom.XformOp:
    """Two places or more at uneven times around the frame, or one for all times."""
    op = UsdGeom.Xformable(prim).AddTranslateOp()
    for time, place in zip((8.7, 10.1, 11.3), places, strict=False):
        op.Set(Gf.Vec3d(*place, 0), *((time,) if len(places) > 1 else ()))
    return op


def turn(prim: Usd.Prim | UsdGeom.Xformable, degrees: float = 90.0) -> None:
    op = UsdGeom.Xformable(prim).AddRotateZOp()
    op.Set(0.0, 9.0)
    op.Set(degrees, 11.0)


def reset(prim: Usd.Prim | UsdGeom.Xformable) -> None:
    UsdGeom.Xformable(prim).SetResetXformStack(True)


def scaled(prim: Usd.Prim | UsdGeom.Xformable, blur: float) -> None:
    prim = prim if isinstance(prim, Usd.Prim) else prim.GetPrim()
    UsdGeom.MotionAPI.Apply(prim).CreateMotionBlurScaleAttr(blur)


def asset(shot: Shot, path: str = "/Asset") -> UsdGeom.Xform:
    """A class with a turning part, `Apart`, around a square, and a square beside it."""
    shot.stage.CreateClassPrim(path)
    apart = UsdGeom.Xform.Define(shot.stage, f"{path}/Apart")
    slide(apart, (0, 2), (1, 3), (0, 2.5))
    turn(apart)
    shot.mesh(f"{path}/Apart/Square")
    shot.mesh(f"{path}/Plain", [(0, 0, 0), (1, 0, 0), (0, 1, 0)])
    return apart


def instance(shot: Shot, path: str, of: str = "/Asset", *places: tuple[float, float]) -> UsdGeom.Xform:
    prim = UsdGeom.Xform.Define(shot.stage, path)
    prim.GetPrim().GetReferences().AddInternalReference(of)
    prim.GetPrim().SetInstanceable(True)
    slide(prim, *places)
    return prim


def two_instances(shot: Shot, of: str = "/Asset") -> None:
    """Below something that moves, one of them still in it."""
    slide(UsdGeom.Xform.Define(shot.stage, "/World"), (-3, -3), (0, -3), (3, -2))
    instance(shot, "/World/One", of, (-4, 0))
    turn(instance(shot, "/World/Two", of, (0, 0), (2, 1), (2, 2)))


def test_a_reset_inside_an_instance_leads_to_the_stages_root():
    shot = Shot(SHUTTER)
    reset(asset(shot))
    two_instances(shot)
    result = assert_as_the_stage(shot, 0.01)
    assert not messages(result, "warning")


def test_the_parts_under_a_reset_are_those_of_the_plain_stage():
    pictures = []
    for instanceable in (True, False):
        shot = Shot(SHUTTER)
        reset(asset(shot))
        two_instances(shot)
        for name in ("One", "Two"):
            shot.stage.GetPrimAtPath(f"/World/{name}").SetInstanceable(instanceable)
        pictures.append([drawn_at(shot.read(), time01) for time01 in DENSE_TIMES01])
    assert max(np.abs(a - b).max() for a, b in zip(*pictures, strict=True)) < 0.01


def test_what_moves_below_a_reset_moves():
    shot = Shot(SHUTTER)
    reset(asset(shot))
    for name, angle in (("Inner", 70.0), ("Inner/Innermost", -150.0)):
        turn(UsdGeom.Xform.Define(shot.stage, f"/Asset/Apart/{name}"), angle)
    shot.mesh("/Asset/Apart/Inner/Innermost/Square", [(1, 1, 0), (2, 1, 0), (2, 3, 0)])
    two_instances(shot)
    assert_as_the_stage(shot, 0.01)


def test_a_reset_that_stands_still_and_one_on_the_shape_itself():
    shot = Shot(SHUTTER)
    asset(shot)
    mesh = shot.mesh("/Asset/Still")
    slide(mesh, (1, -2))
    reset(mesh)
    two_instances(shot)
    result = assert_as_the_stage(shot, 0.01)
    assert set(result.scene.meshes) == {"/World/One/Still", "/World/Two/Still"}


def test_a_reset_on_a_nested_instance_and_inside_one():
    shot = Shot(SHUTTER)
    reset(asset(shot))
    shot.stage.CreateClassPrim("/Pair")
    instance(shot, "/Pair/A", "/Asset", (0, 0), (1, 1))
    reset(instance(shot, "/Pair/B", "/Asset", (0, 1), (2, 1)))
    two_instances(shot, "/Pair")
    assert_as_the_stage(shot, 0.01)


def test_an_instancer_and_an_instance_under_a_reset():
    shot = Shot(SHUTTER)
    asset(shot)
    shot.stage.CreateClassPrim("/Set")
    top = UsdGeom.Xform.Define(shot.stage, "/Set/Top")
    slide(top, (0, -1), (1, 1))
    reset(top)
    instance(shot, "/Set/Top/Instance", "/Asset", (0, 0), (2, 0))
    instancer = UsdGeom.PointInstancer.Define(shot.stage, "/Set/Top/Instancer")
    shot.mesh("/Set/Top/Instancer/Square")
    instancer.CreatePrototypesRel().SetTargets(["/Set/Top/Instancer/Square"])
    instancer.CreateProtoIndicesAttr([0, 0])
    instancer.CreatePositionsAttr([(0, -4, 0), (4, -4, 0)])
    two_instances(shot, "/Set")
    assert_as_the_stage(shot, 0.01)


def test_what_hides_an_instance_hides_what_resets_inside():
    shot = Shot(SHUTTER)
    reset(asset(shot))
    two_instances(shot)
    visibility = UsdGeom.Imageable.Get(shot.stage, "/World/Two").CreateVisibilityAttr()
    for time, token in ((9.0, "inherited"), (9.9, "invisible"), (10.2, "inherited")):
        visibility.Set(token, time)
    assert_as_the_stage(shot, 0.01)
    visibility.Clear()
    visibility.Set("invisible")
    assert_as_the_stage(shot, 0.01)


def test_a_light_under_a_reset_shines_from_its_place():
    shot = Shot(SHUTTER)
    reset(asset(shot))
    UsdLux.SphereLight.Define(shot.stage, "/Asset/Apart/Light")
    two_instances(shot)
    result = shot.read()
    assert len(result.scene.lights) == 2
    proxy = shot.stage.GetPrimAtPath("/World/One/Apart/Light")
    for light in result.scene.lights:
        for time01, matrix in zip(light["times01"], light["world_from_light"], strict=True):
            code = result.camera.shutter.time_code(time01)
            expected = np.array(UsdGeom.XformCache(code).GetLocalToWorldTransform(proxy))
            assert np.abs(matrix - expected).max() < 1e-9


def test_a_skeleton_under_a_reset_places_its_mesh():
    shot = Shot(SHUTTER)
    shot.stage.CreateClassPrim("/Asset")
    root = UsdSkel.Root.Define(shot.stage, "/Asset/Root")
    skeleton = UsdSkel.Skeleton.Define(shot.stage, "/Asset/Root/Rig/Skeleton")
    rig = UsdGeom.Xform.Define(shot.stage, "/Asset/Root/Rig")
    slide(rig, (0, 1), (2, 2))
    reset(rig)
    identity = Vt.Matrix4dArray([Gf.Matrix4d(1)])
    skeleton.CreateJointsAttr(["a"])
    skeleton.CreateBindTransformsAttr(identity)
    skeleton.CreateRestTransformsAttr(identity)
    mesh = shot.mesh("/Asset/Root/Square")
    binding = UsdSkel.BindingAPI.Apply(mesh.GetPrim())
    UsdSkel.BindingAPI.Apply(root.GetPrim()).CreateSkeletonRel().SetTargets([skeleton.GetPath()])
    binding.CreateJointIndicesPrimvar(True, 1).Set([0])
    binding.CreateJointWeightsPrimvar(True, 1).Set([1.0])
    two_instances(shot)
    assert_as_the_stage(shot, 0.01)


def prototype(shot: Shot) -> UsdGeom.Xform:
    """Of a point instancer whose instances move: a turning root with an `Apart` and a square of its own."""
    instancer = UsdGeom.PointInstancer.Define(shot.stage, "/Instancer")
    root = UsdGeom.Xform.Define(shot.stage, "/Instancer/Root")
    slide(root, (0, 1), (1, 1), (1, 2))
    turn(root)
    apart = UsdGeom.Xform.Define(shot.stage, "/Instancer/Root/Apart")
    slide(apart, (0, 2), (0, 3))
    shot.mesh("/Instancer/Root/Apart/Square")
    shot.mesh("/Instancer/Root/Plain", [(0, 0, 0), (1, 0, 0), (0, 1, 0)])
    instancer.CreatePrototypesRel().SetTargets(["/Instancer/Root"])
    instancer.CreateProtoIndicesAttr([0, 0, 0])
    for time, x in ((9.0, -6.0), (11.0, -3.0)):
        instancer.CreatePositionsAttr().Set([(x, 0, 0), (x + 4, 1, 0), (x + 8, 0, 0)], time)
    return apart


def test_a_reset_inside_a_prototype_leads_to_the_instances_place():
    shot = Shot(SHUTTER)
    reset(prototype(shot))
    result = assert_as_the_stage(shot, 0.01)
    assert not messages(result, "warning")


def test_a_reset_in_a_native_instance_in_a_prototype():
    shot = Shot(SHUTTER)
    prototype(shot)
    reset(asset(shot))
    instance(shot, "/Instancer/Root/Native", "/Asset", (0, -2), (1, -2))
    assert_as_the_stage(shot, 0.01)


def test_a_reset_on_a_nested_instancer():
    shot = Shot(SHUTTER)
    prototype(shot)
    inner = UsdGeom.PointInstancer.Define(shot.stage, "/Instancer/Root/Inner")
    slide(inner, (0, -3), (1, -3))
    reset(inner)
    shot.mesh("/Instancer/Root/Inner/Square")
    inner.CreatePrototypesRel().SetTargets(["/Instancer/Root/Inner/Square"])
    inner.CreateProtoIndicesAttr([0, 0])
    inner.CreatePositionsAttr([(0, 0, 0), (0, -2, 0)])
    assert_as_the_stage(shot, 0.01)


BLURS = [0.0, 0.5, 3.0]


@pytest.mark.parametrize("blur", BLURS)
def test_a_blur_scale_inside_an_instance_scales_the_instances_motion_there(blur):
    shot = Shot(SHUTTER)
    scaled(asset(shot), blur)
    two_instances(shot)
    result = assert_as_the_stage(shot, 0.01)
    assert not messages(result, "warning")
    assert not result.scene.meshes, "what is shared stays shared"


def test_blur_scales_inside_instances_inside_instances():
    shot = Shot(SHUTTER)
    scaled(asset(shot), 2.0)
    shot.mesh("/Asset/Apart/Inner", [(2, 2, 0), (3, 2, 0), (3, 3, 0)])
    scaled(shot.stage.GetPrimAtPath("/Asset/Apart/Inner"), 0.5)
    shot.stage.CreateClassPrim("/Pair")
    instance(shot, "/Pair/A", "/Asset", (0, 0), (1, 1))
    scaled(instance(shot, "/Pair/B", "/Asset", (0, 1), (2, 1)), 0.5)
    two_instances(shot, "/Pair")
    scaled(shot.stage.GetPrimAtPath("/World/Two"), 3.0)
    assert_as_the_stage(shot, 0.01)


def test_a_blur_scale_in_a_native_instance_in_a_prototype():
    shot = Shot(SHUTTER)
    prototype(shot)
    scaled(asset(shot), 0.0)
    instance(shot, "/Instancer/Root/Native", "/Asset", (0, -2), (1, -2))
    assert_as_the_stage(shot, 0.01)


def test_a_blur_scale_inside_a_prototype_moves_there_by_itself():
    shot = Shot(SHUTTER)
    scaled(prototype(shot), 3.0)
    assert_as_the_stage(shot, 0.01)


def test_both_at_once():
    shot = Shot(SHUTTER)
    apart = asset(shot)
    reset(apart)
    scaled(apart, 2.0)
    scaled(shot.mesh("/Asset/Apart/Inner", [(2, 2, 0), (3, 2, 0), (3, 3, 0)]), 0.0)
    scaled(shot.mesh("/Asset/Other", [(2, -2, 0), (3, -2, 0), (3, -3, 0)]), 0.5)
    two_instances(shot)
    assert_as_the_stage(shot, 0.01)


@pytest.mark.parametrize("blurs", [(0.0, 0.5), (0.0, 2.0), (2.0, 0.0), (0.5, 3.0)])
def test_a_blur_scale_below_another_one_has_its_own_view_of_what_is_above(blurs):
    shot = Shot(SHUTTER)
    parent = UsdGeom.Xform.Define(shot.stage, "/Parent")
    slide(parent, (-3, 0), (1, 1), (3, 0))
    turn(parent)
    scaled(parent, blurs[0])
    scaled(shot.mesh("/Parent/Square"), blurs[1])
    assert_as_the_stage(shot, 0.01)
