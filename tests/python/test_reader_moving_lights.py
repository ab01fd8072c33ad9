"""Lights whose values change inside the shutter, against the stage's own evaluation."""

from __future__ import annotations

import math

import numpy as np
import pytest
from msbvh import _core
from msbvh.look.light_values import NUMBERS, emission
from msbvh.scene.reader import ReadSettings, read_frame
from pxr import Gf, Usd, UsdGeom, UsdLux
from recording import DENSE_TIMES01, Shot, interpolated, messages


def only_light(shot: Shot) -> dict:
    (light,) = shot.read().scene.lights
    return light


def radiance_at(light: dict, time01: float) -> np.ndarray:
    return interpolated(light["values_times01"], light["radiances"], time01)


def ramp(attribute: Usd.Attribute, first: object, last: object) -> None:
    """From one frame before the frame to one after it: the shutter sees the middle half."""
    attribute.Set(first, 9.0)
    attribute.Set(last, 11.0)


def check_samples(light: dict) -> None:
    times01 = light["values_times01"]
    assert (np.diff(times01) > 0).all() and times01[0] == 0.0 and times01[-1] == 1.0
    assert light["radiances"].dtype == light["numbers"].dtype == np.float32
    assert light["radiances"].shape == (len(times01), 3) and light["numbers"].shape == (len(times01), len(NUMBERS))


def test_all_of_the_emission_is_sampled():
    shot = Shot()
    light = UsdLux.SphereLight.Define(shot.stage, "/Light")
    ramp(light.CreateIntensityAttr(), 0.0, 8.0)
    ramp(light.CreateExposureAttr(), -2.0, 2.0)
    ramp(light.CreateColorAttr(), Gf.Vec3f(1, 0, 0), Gf.Vec3f(0, 1, 0.5))
    ramp(light.CreateColorTemperatureAttr(), 2000.0, 9000.0)
    light.CreateEnableColorTemperatureAttr(True)
    handed = only_light(shot)
    check_samples(handed)
    shutter = shot.read().camera.shutter
    for time01 in DENSE_TIMES01:
        expected = emission(UsdLux.LightAPI(light), shutter.time_code(time01))
        assert radiance_at(handed, time01) == pytest.approx(expected, rel=2e-3, abs=2e-3)
    assert handed["radiance"] == pytest.approx(emission(UsdLux.LightAPI(light), shutter.frame_code))


@pytest.mark.parametrize(
    ("kind", "size"),
    [
        ("SphereLight", "radius"),
        ("RectLight", "width"),
        ("RectLight", "height"),
        ("DistantLight", "angle"),
        ("DiskLight", "radius"),
        ("CylinderLight", "length"),
    ],
)
@pytest.mark.parametrize("normalize", [False, True])
def test_sizes_are_sampled_and_normalised_at_every_time(kind: str, size: str, normalize: bool):
    shot = Shot()
    light = getattr(UsdLux, kind).Define(shot.stage, "/Light")
    light.CreateNormalizeAttr(normalize)
    light.CreateIntensityAttr(1.0)
    ramp(light.GetPrim().GetAttribute(f"inputs:{size}"), 1.0, 5.0)
    grow = light.AddScaleOp()
    ramp(grow, Gf.Vec3f(1), Gf.Vec3f(3))
    handed = only_light(shot)
    check_samples(handed)
    names = list(NUMBERS)
    for time01, sizes, radiance in zip(handed["values_times01"], handed["numbers"], handed["radiances"], strict=True):
        assert sizes[names.index(size)] == pytest.approx(2.0 + 2.0 * time01, rel=1e-5)
        scale = np.diag([1.5 + time01] * 3 + [1.0])
        area = _core.light_normalization(handed["kind"], tuple(sizes.tolist()), scale)
        assert radiance[0] == pytest.approx(1.0 / area if normalize else 1.0, rel=1e-5)


def test_a_moving_normalised_light_that_scales_keeps_its_power():
    shot = Shot()
    light = UsdLux.RectLight.Define(shot.stage, "/Light")
    light.CreateNormalizeAttr(True)
    ramp(light.AddScaleOp(), Gf.Vec3f(1), Gf.Vec3f(3))
    handed = only_light(shot)
    for time01 in DENSE_TIMES01:
        scale = 1.5 + time01
        assert radiance_at(handed, time01)[0] * scale**2 == pytest.approx(light.GetIntensityAttr().Get(), rel=1e-3)


def test_many_samples_of_one_value_are_still():
    shot = Shot()
    light = UsdLux.SphereLight.Define(shot.stage, "/Light")
    for time in range(5, 15):
        light.GetIntensityAttr().Set(3.0, time)
    handed = only_light(shot)
    assert handed["radiance"] == (3.0, 3.0, 3.0)
    assert "radiances" not in handed


def test_a_closed_shutter_sees_the_frame():
    shot = Shot((0.0, 0.0))
    ramp(UsdLux.SphereLight.Define(shot.stage, "/Light").CreateIntensityAttr(), 0.0, 8.0)
    handed = only_light(shot)
    assert handed["radiance"] == (4.0, 4.0, 4.0) and "radiances" not in handed


def test_splines_are_sampled():
    from pxr import Ts

    shot = Shot()
    light = UsdLux.SphereLight.Define(shot.stage, "/Light")
    intensity = light.CreateIntensityAttr()
    spline = Ts.Spline("float")
    for time, value in ((9.0, 0.0), (10.0, 4.0), (11.0, 0.0)):
        knot = Ts.Knot("float", time=time, value=value)
        knot.SetNextInterpolation(Ts.InterpCurve)
        spline.SetKnot(knot)
    intensity.SetSpline(spline)
    handed = only_light(shot)
    shutter = shot.read().camera.shutter
    for time01 in DENSE_TIMES01:
        expected = intensity.Get(shutter.time_code(time01))
        assert radiance_at(handed, time01)[0] == pytest.approx(expected, abs=2e-3)


def test_values_of_a_held_stage_jump():
    shot = Shot((0.0, 1.0))
    shot.stage.SetInterpolationType(Usd.InterpolationTypeHeld)
    intensity = UsdLux.SphereLight.Define(shot.stage, "/Light").CreateIntensityAttr()
    intensity.Set(1.0, 10.0)
    intensity.Set(5.0, 10.3123)
    handed = only_light(shot)
    assert radiance_at(handed, 0.3122)[0] == 1.0
    assert radiance_at(handed, 0.3124)[0] == 5.0
    intensity.Set(1.0, 10.3123)
    intensity.Set(5.0, 11.0)  # the shutter has closed
    assert "radiances" not in only_light(shot)


@pytest.mark.parametrize("switched", ["/Group/Light", "/Group"])
def test_a_light_that_is_switched_by_visibility_shines_while_it_is_visible(switched: str):
    shot = Shot((0.0, 1.0))
    UsdGeom.Xform.Define(shot.stage, "/Group")
    light = UsdLux.SphereLight.Define(shot.stage, "/Group/Light")
    light.CreateIntensityAttr(2.0)
    shot.mesh("/Group/Card")
    visibility = UsdGeom.Imageable(shot.stage.GetPrimAtPath(switched)).GetVisibilityAttr()
    visibility.Set("invisible", 10.0)  # at the frame, too
    visibility.Set("inherited", 10.25)
    visibility.Set("invisible", 10.75)
    result = shot.read()
    (handed,) = result.scene.lights
    assert [radiance_at(handed, time)[0] for time in (0.2, 0.3, 0.7, 0.8)] == [0.0, 2.0, 2.0, 0.0]
    shown = [any(mesh == "/Group/Card" for mesh, _, _ in result.scene.poses(t)) for t in (0.2, 0.3, 0.7, 0.8)]
    assert shown == ([False, True, True, False] if switched == "/Group" else [True] * 4)


def test_a_light_that_is_invisible_in_the_whole_shutter_is_none():
    shot = Shot((0.0, 1.0))
    light = UsdLux.SphereLight.Define(shot.stage, "/Light")
    visibility = light.GetVisibilityAttr()
    visibility.Set("inherited", 9.0)
    visibility.Set("invisible", 10.0)
    visibility.Set("inherited", 11.0)
    assert only_light(shot)["kind"] == "camera"


def test_a_size_that_passes_zero_stays_an_extent():
    shot = Shot()
    light = UsdLux.SphereLight.Define(shot.stage, "/Light")
    light.CreateIntensityAttr(4.0)
    light.GetRadiusAttr().Set(0.0, 10.0)
    light.GetRadiusAttr().Set(2.0, 11.0)
    handed = only_light(shot)
    radii = handed["numbers"][:, 1]
    assert radii.min() == pytest.approx(1e-3 * radii.max())
    assert handed.get("radiances", np.float32([[4.0]]))[:, 0] == pytest.approx(4.0)


def test_a_bad_value_within_the_shutter_is_named():
    shot = Shot()
    shot.mesh("/Card")
    light = UsdLux.SphereLight.Define(shot.stage, "/Light")
    light.GetRadiusAttr().Set(1.0, 10.0)
    light.GetRadiusAttr().Set(math.nan, 10.25)
    errors = [str(d) for d in _rendered(shot, errors_only=True)]
    assert len(errors) == 1 and errors[0].startswith("/Light.inputs:radius: found nan")


def _rendered(shot: Shot, errors_only: bool = False):
    result = read_frame(shot.stage, 10.0, ReadSettings(width=64, height=64))
    if errors_only:
        return [d for d in result.diagnostics if d.severity == "error"]
    assert not messages(result, "warning")
    return _core.Renderer(result.scene, width=64, height=64, spp=64, max_bounces=0).render()


def white_card(shot: Shot) -> None:
    card = shot.mesh("/Card", ((-50, -50, 0), (50, -50, 0), (50, 50, 0), (-50, 50, 0)))
    card.CreateDisplayColorAttr([Gf.Vec3f(1)])


@pytest.mark.parametrize("kind", ["DomeLight", "DistantLight"])
def test_a_ramp_from_0_to_1_within_the_shutter_gives_half(kind: str):
    shot = Shot((0.0, 1.0))
    white_card(shot)
    light = getattr(UsdLux, kind).Define(shot.stage, "/Light")
    light.CreateIntensityAttr().Set(0.0, 10.0)
    light.GetIntensityAttr().Set(math.pi if kind == "DistantLight" else 1.0, 11.0)
    if kind == "DistantLight":
        light.CreateAngleAttr(0.0)
    assert _rendered(shot)[..., 0].mean() == pytest.approx(0.5, rel=3e-3)


@pytest.mark.parametrize(("on", "off"), [(10.25, 10.75), (10.4711, 10.483)])
def test_a_light_switched_on_for_a_part_of_the_shutter_gives_that_part(on: float, off: float):
    shot = Shot((0.0, 1.0))
    white_card(shot)
    visibility = UsdLux.DomeLight.Define(shot.stage, "/Light").GetVisibilityAttr()
    visibility.Set("invisible", 10.0)
    visibility.Set("inherited", on)
    visibility.Set("invisible", off)
    # The shorter flash is met by a sample or two of 64 in each of the 4096 pixels: 5 standard deviations.
    assert _rendered(shot)[..., 0].mean() == pytest.approx(off - on, rel=0.03)


def test_lights_in_instances_are_normalised_where_they_stand():
    shot = Shot()
    shot.stage.CreateClassPrim("/Asset")
    light = UsdLux.RectLight.Define(shot.stage, "/Asset/Light")
    light.CreateNormalizeAttr(True)
    light.CreateIntensityAttr(1.0)
    for index in range(2):
        prim = UsdGeom.Xform.Define(shot.stage, f"/Instance_{index}")
        prim.AddScaleOp().Set(Gf.Vec3f(1 + index))
        prim.GetPrim().GetReferences().AddInternalReference("/Asset")
        prim.GetPrim().SetInstanceable(True)
    assert [light["radiance"][0] for light in shot.read().scene.lights] == pytest.approx([1.0, 0.25])


def test_a_light_whose_instance_appears_shines_from_then_on() -> None:
    """At a time code that is rounded to before itself on its way to the shutter's time and back."""
    shot = Shot((-0.25, 0.25))
    shot.stage.CreateClassPrim("/Asset")
    UsdLux.SphereLight.Define(shot.stage, "/Asset/Light").CreateIntensityAttr(3.0)
    instance = UsdGeom.Xform.Define(shot.stage, "/Instance")
    instance.GetPrim().GetReferences().AddInternalReference("/Asset")
    instance.GetPrim().SetInstanceable(True)
    instance.GetVisibilityAttr().Set("invisible", 9.0)
    instance.GetVisibilityAttr().Set("inherited", 10.025)
    result = shot.read()
    shutter = result.camera.shutter
    begin01 = shutter.time01(10.025)
    assert shutter.time_code(begin01).GetValue() < 10.025
    (handed,) = result.scene.lights
    assert [radiance_at(handed, begin01 + after)[0] for after in (-1e-4, 1e-9, 1e-4)] == [0.0, 3.0, 3.0]


def test_a_light_keeps_the_breakpoints_of_its_transform() -> None:
    """Thrown to a place and back between two of the even times at which curves are caught."""
    shot = Shot((0.0, 1.0))
    light = UsdLux.SphereLight.Define(shot.stage, "/Light")
    op = light.AddTranslateOp()
    for time, x in ((10.0, 0.0), (10.5011, 0.0), (10.5039, 6.0), (10.5067, 0.0), (11.0, 0.0)):
        op.Set(Gf.Vec3d(x, 0, 0), time)
    (found,) = shot.read().scene.lights
    places = np.interp(0.5039, found["times01"], found["world_from_light"][:, 3, 0])
    assert places == pytest.approx(6.0, abs=1e-6)
