"""Roots of point instancers' prototypes: their own visibility counts, that of their ancestors does not; one that is
inactive or not loaded is a missing one; and their own transform moves by their own motion:blurScale.

The truth is stage_truth.py, which asks usd-core at the very time and knows no tracks.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pytest
from drawn import assert_as_the_stage, drawn_at, in_order
from msbvh.base.errors import Diagnostics
from msbvh.motion.samples import SampleLog
from msbvh.scene.reader import ReadSettings, read_frame
from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux
from recording import DENSE_TIMES01, Recording, Shot, messages
from stage_truth import StageTruth

INVISIBLE, INHERITED = UsdGeom.Tokens.invisible, UsdGeom.Tokens.inherited


def instancer_of(
    shot: Shot, prototypes: Sequence[str], path: str = "/Instancer", y: float = 0.0
) -> UsdGeom.PointInstancer:
    """Two instances of each prototype in a row at that height; they move a little."""
    instancer = UsdGeom.PointInstancer.Define(shot.stage, path)
    instancer.GetPrototypesRel().SetTargets(list(prototypes))
    count = 2 * len(prototypes)
    instancer.CreateProtoIndicesAttr([i % len(prototypes) for i in range(count)])
    for time, x in ((9.0, -6.0), (11.0, -4.0)):
        instancer.CreatePositionsAttr().Set([(x + 3 * i, y, 0) for i in range(count)], time)
    return instancer


def blink(prim: Usd.Prim | UsdGeom.Imageable, hidden: tuple[float, float] = (9.9, 10.2)) -> None:
    """Invisible between the two times."""
    visibility = UsdGeom.Imageable(prim).CreateVisibilityAttr()
    for time, token in ((9.0, INHERITED), (hidden[0], INVISIBLE), (hidden[1], INHERITED)):
        visibility.Set(token, time)


def a_mesh(shot: Shot) -> str:
    shot.mesh("/Prototypes/Root")
    return "/Prototypes/Root"


def a_group(shot: Shot) -> str:
    UsdGeom.Xform.Define(shot.stage, "/Prototypes/Root").AddTranslateOp().Set(Gf.Vec3d(0, 1, 0))
    shot.mesh("/Prototypes/Root/Square")
    return "/Prototypes/Root"


def a_native_instance(shot: Shot) -> str:
    shot.stage.CreateClassPrim("/Asset")
    shot.mesh("/Asset/Square")
    root = UsdGeom.Xform.Define(shot.stage, "/Prototypes/Root")
    root.GetPrim().GetReferences().AddInternalReference("/Asset")
    root.GetPrim().SetInstanceable(True)
    return "/Prototypes/Root"


def a_nested_instancer(shot: Shot) -> str:
    shot.mesh("/Prototypes/Inner")
    instancer_of(shot, ["/Prototypes/Inner"], "/Prototypes/Root")
    UsdGeom.Imageable(shot.stage.GetPrimAtPath("/Prototypes")).CreateVisibilityAttr("invisible")
    return "/Prototypes/Root"


def an_over(shot: Shot) -> str:
    UsdGeom.Xform.Define(shot.stage, "/Prototypes/Root")
    shot.mesh("/Prototypes/Root/Square")
    for path in ("/Prototypes/Root", "/Prototypes"):
        shot.stage.GetPrimAtPath(path).SetSpecifier(Sdf.SpecifierOver)
    return "/Prototypes/Root"


ROOTS = [a_mesh, a_group, a_native_instance, a_nested_instancer, an_over]
each_root = pytest.mark.parametrize("root", ROOTS, ids=lambda root: root.__name__)


def with_root(root: Callable[[Shot], str], shutter: tuple[float, float] = (-0.25, 0.5)) -> tuple[Shot, Usd.Prim]:
    """Two prototypes, of which the second is always drawn."""
    shot = Shot(shutter)
    path = root(shot)
    shot.mesh("/Instancer/Other", [(0, 3, 0), (1, 3, 0), (1, 4, 0)])
    instancer_of(shot, [path, "/Instancer/Other"])
    hidden = UsdGeom.Scope.Define(shot.stage, "/Prototypes")
    if not hidden.GetVisibilityAttr().HasAuthoredValue():
        hidden.MakeInvisible()
    return shot, shot.stage.GetPrimAtPath(path)


@each_root
def test_what_hides_ancestors_of_a_prototype_does_not_count(root):
    shot, _ = with_root(root)
    assert len(drawn_at(shot.read(), 0.3)) > 6
    assert_as_the_stage(shot)


@each_root
def test_an_invisible_prototype_is_not_drawn(root):
    shot, prim = with_root(root)
    UsdGeom.Imageable(prim).CreateVisibilityAttr(INVISIBLE)
    assert len(drawn_at(shot.read(), 0.3)) == 6
    assert_as_the_stage(shot)


@each_root
def test_a_prototype_that_blinks_within_the_shutter(root):
    shot, prim = with_root(root)
    blink(prim)
    assert_as_the_stage(shot)


def test_a_prototype_that_two_instancers_share_blinks_in_both():
    shot = Shot((-0.25, 0.5))
    shot.mesh("/Prototypes/Root")
    blink(shot.stage.GetPrimAtPath("/Prototypes/Root"))
    shot.stage.GetPrimAtPath("/Prototypes").SetSpecifier(Sdf.SpecifierOver)
    instancer_of(shot, ["/Prototypes/Root"])
    second = instancer_of(shot, ["/Prototypes/Root"], "/Second", 3.0)
    blink(second, (10.1, 10.3))
    assert_as_the_stage(shot)


def test_a_light_below_a_root_that_blinks_is_off_meanwhile():
    shot = Shot((-0.25, 0.5))
    UsdGeom.Xform.Define(shot.stage, "/Prototypes/Root")
    UsdLux.SphereLight.Define(shot.stage, "/Prototypes/Root/Light")
    shot.stage.GetPrimAtPath("/Prototypes").SetSpecifier(Sdf.SpecifierOver)
    blink(shot.stage.GetPrimAtPath("/Prototypes/Root"))
    blink(instancer_of(shot, ["/Prototypes/Root"]), (10.3, 10.4))
    lights = shot.read().scene.lights
    assert len(lights) == 2
    for light in lights:
        times = 9.75 + 0.75 * np.asarray(light["values_times01"])
        on = np.asarray(light["radiances"])[:, 0] > 0
        off = ((times >= 9.9) & (times < 10.2)) | ((times >= 10.3) & (times < 10.4))
        clear = np.abs(times[:, None] - [9.9, 10.2, 10.3, 10.4]).min(axis=1) > 1e-5
        assert (on[clear] == ~off[clear]).all()


def test_the_purpose_of_a_prototype_root_decides_as_anywhere():
    for purpose, points in (("render", 6), ("proxy", 14), ("default", 14)):
        shot, prim = with_root(a_mesh)
        UsdGeom.Imageable(prim).CreatePurposeAttr(purpose)
        assert len(drawn_at(shot.read(), 0.3)) == points
        assert_as_the_stage(shot)


@pytest.mark.parametrize("hide", ["the root", "its parent"])
def test_an_inactive_prototype_is_a_missing_one(hide):
    shot, prim = with_root(a_group)
    (prim if hide == "the root" else prim.GetParent()).SetActive(False)
    result = shot.read()
    assert len(drawn_at(result, 0.3)) == 6
    (error,) = messages(result, "error")
    assert error.startswith("/Instancer.prototypes: found /Prototypes/Root")
    assert ("inactive" in error) == (hide == "the root")
    assert "their instances are not drawn" in error


def test_a_prototype_whose_payload_is_not_loaded_is_a_missing_one():
    shot, prim = with_root(a_group)
    payload = Usd.Stage.CreateInMemory()
    UsdGeom.Xform.Define(payload, "/Asset")
    payload.SetDefaultPrim(payload.GetPrimAtPath("/Asset"))
    prim.GetPayloads().AddPayload(payload.GetRootLayer().identifier, "/Asset")
    prim.Unload()
    result = shot.read()
    (error,) = messages(result, "error")
    assert error.startswith("/Instancer.prototypes: found /Prototypes/Root") and "not loaded" in error


def test_an_inactive_prototype_that_no_instance_uses_is_no_fault():
    shot, prim = with_root(a_group)
    prim.SetActive(False)
    UsdGeom.PointInstancer.Get(shot.stage, "/Instancer").GetProtoIndicesAttr().Set([1, 1, 1, 1])
    assert not messages(shot.read(), "error")


def scaled(prim: Usd.Prim | UsdGeom.Imageable, blur: float) -> None:
    prim = prim if isinstance(prim, Usd.Prim) else prim.GetPrim()
    UsdGeom.MotionAPI.Apply(prim).CreateMotionBlurScaleAttr(blur)


def moving_root(shot: Shot, path: str = "/Prototypes/Root") -> UsdGeom.Xform:
    """A group that goes up and turns on the spot while its instancer goes to the right."""
    root = UsdGeom.Xform.Define(shot.stage, path)
    rise, turn = root.AddTranslateOp(), root.AddRotateZOp()
    for time, height, angle in ((8.0, -4.0, 0.0), (10.1, 0.5, 20.0), (12.0, 4.0, 90.0)):
        rise.Set(Gf.Vec3d(0, height, 0), time)
        turn.Set(angle, time)
    shot.mesh(f"{path}/Square")
    return root


SCALES = [(0.0, 2.0), (2.0, 0.0), (0.5, 1.0), (1.0, 3.0)]
"""motion:blurScale of a prototype's root, and of its instancer."""


@pytest.mark.parametrize(("own", "instancers"), SCALES)
@pytest.mark.parametrize("rates", [False, True], ids=["positions", "velocities"])
def test_a_root_moves_by_its_own_blur_scale(own, instancers, rates):
    shot = Shot((-0.25, 0.5))
    scaled(moving_root(shot), own)
    instancer = instancer_of(shot, ["/Prototypes/Root"])
    scaled(instancer, instancers)
    if rates:
        instancer.CreateVelocitiesAttr().Set([(48.0, 24.0, 0.0)] * 2, 9.0)
        instancer.GetVelocitiesAttr().Set([(48.0, 24.0, 0.0)] * 2, 11.0)
    UsdGeom.Scope.Define(shot.stage, "/Prototypes").GetPrim().SetSpecifier(Sdf.SpecifierOver)
    assert_as_the_stage(shot, 0.01)


@pytest.mark.parametrize("scales", [(0.0, 2.0, 1.0), (3.0, 0.5, 1.0), (1.0, 2.0, 0.0)])
def test_nested_instancers_and_their_roots_each_move_by_their_own_scale(scales):
    inner, middle, outer = scales
    shot = Shot((-0.25, 0.5))
    scaled(moving_root(shot, "/Prototypes/Inner"), inner)
    nested = instancer_of(shot, ["/Prototypes/Inner"], "/Prototypes/Root", 1.0)
    move = nested.AddTranslateOp()
    for time in (9.0, 9.9, 11.0):
        move.Set(Gf.Vec3d(0, (time - 10) ** 2, time - 9), time)
    scaled(nested, middle)
    scaled(instancer_of(shot, ["/Prototypes/Root"]), outer)
    shot.stage.GetPrimAtPath("/Prototypes").SetSpecifier(Sdf.SpecifierOver)
    assert_as_the_stage(shot, 0.01)


def test_one_root_under_two_instancers_of_different_scales():
    shot = Shot((-0.25, 0.5))
    scaled(moving_root(shot), 0.5)
    shot.stage.GetPrimAtPath("/Prototypes").SetSpecifier(Sdf.SpecifierOver)
    scaled(instancer_of(shot, ["/Prototypes/Root"]), 2.0)
    scaled(instancer_of(shot, ["/Prototypes/Root"], "/Second", 3.0), 0.0)
    assert_as_the_stage(shot, 0.01)


def light_places(shot: Shot, result, time01: float) -> np.ndarray:
    """Where the recorded lights are: float64[N, 3], sorted."""
    places = []
    for light in result.scene.lights:
        at = [np.interp(time01, light["times01"], light["world_from_light"][:, 3, k]) for k in range(3)]
        places.append(at)
    return in_order(np.array(places).reshape(-1, 3))


@pytest.mark.parametrize(("own", "instancers"), SCALES)
def test_a_light_below_a_root_moves_as_its_root_and_instancer_do(own, instancers):
    """Beside it a square at the same place shows where the stage has it."""
    shot = Shot((-0.25, 0.5))
    root = moving_root(shot)
    UsdLux.SphereLight.Define(shot.stage, "/Prototypes/Root/Light")
    scaled(root, own)
    shot.stage.GetPrimAtPath("/Prototypes").SetSpecifier(Sdf.SpecifierOver)
    instancer = instancer_of(shot, ["/Prototypes/Root"])
    for time, x in ((10.04, 9.0), (10.049, -9.0)):  # Between two of the even times.
        instancer.GetPositionsAttr().Set([(x, 0, 0), (x + 3, 0, 0)], time)
    scaled(instancer, instancers)
    truth = StageTruth(shot.stage, 10.0, (-0.25, 0.5))
    result = shot.read()
    shutter = result.camera.shutter
    for time01 in DENSE_TIMES01[1:-1]:
        (drawn,) = truth.polygons(shutter.time_code(time01).GetValue())
        expected = in_order(drawn.world_points()[:, 0])  # The square's first corner is at its origin.
        assert np.abs(light_places(shot, result, time01) - expected).max() < 0.01, f"at {time01}"


def test_what_motion_says_of_a_root_is_under_its_own_scale():
    shot = Shot((-0.25, 0.5))
    scaled(moving_root(shot), 0.0)
    scaled(instancer_of(shot, ["/Prototypes/Root"]), 4.0)
    log = SampleLog()
    read_frame(shot.stage, 10.0, ReadSettings(), Diagnostics(), Recording, found=log)
    found = {samples.attribute: samples.times for samples in log.samples("/Instancer") if samples.authored}
    assert found["/Instancer.positions"] == (9.0, 11.0)
    assert found["/Prototypes/Root.xformOp:rotateZ"] == (8.0, 10.1)
