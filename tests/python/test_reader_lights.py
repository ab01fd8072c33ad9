"""Lights as radiance."""

from __future__ import annotations

import math

import numpy as np
import pytest
from pxr import Gf, Sdf, UsdGeom, UsdLux
from recording import Shot, messages


def only_light(shot: Shot) -> dict:
    (light,) = shot.read().scene.lights
    return light


def test_intensity_exposure_colour_and_temperature_multiply():
    shot = Shot()
    light = UsdLux.SphereLight.Define(shot.stage, "/Light")
    light.CreateIntensityAttr(3.0)
    light.CreateExposureAttr(2.0)
    light.CreateColorAttr(Gf.Vec3f(1, 0.5, 0.25))
    assert only_light(shot)["radiance"] == pytest.approx((12, 6, 3))
    light.CreateEnableColorTemperatureAttr(True)
    light.CreateColorTemperatureAttr(3000.0)
    kelvin = np.array(UsdLux.BlackbodyTemperatureAsRgb(3000.0))
    assert only_light(shot)["radiance"] == pytest.approx(np.array([12, 6, 3]) * kelvin)


def test_normalised_lights_are_divided_by_their_area_in_the_world():
    shot = Shot()
    sphere = UsdLux.SphereLight.Define(shot.stage, "/Light")
    sphere.CreateIntensityAttr(1.0)
    sphere.CreateRadiusAttr(0.5)
    sphere.CreateNormalizeAttr(True)
    sphere.AddScaleOp().Set(Gf.Vec3f(3, 3, 3))
    assert only_light(shot)["radiance"][0] == pytest.approx(1 / (4 * math.pi * 1.5**2))
    shot.stage.RemovePrim("/Light")
    rect = UsdLux.RectLight.Define(shot.stage, "/Light")
    rect.CreateNormalizeAttr(True)
    rect.CreateWidthAttr(2.0)
    rect.CreateHeightAttr(3.0)
    rect.AddScaleOp().Set(Gf.Vec3f(1, 2, 5))
    assert only_light(shot)["radiance"][0] == pytest.approx(1 / (2 * 3 * 2))


def test_a_distant_light_is_normalised_by_its_solid_angle():
    shot = Shot()
    sun = UsdLux.DistantLight.Define(shot.stage, "/Light")
    sun.CreateIntensityAttr(1.0)
    sun.CreateAngleAttr(60.0)
    sun.CreateNormalizeAttr(True)
    light = only_light(shot)
    assert light["kind"] == "distant" and light["angle_degrees"] == 60.0
    assert light["radiance"][0] == pytest.approx(1 / (math.pi * 0.25))
    sun.GetAngleAttr().Set(0.0)
    assert only_light(shot)["radiance"][0] == 1.0


def test_a_light_of_radius_zero_is_a_point_with_intensity():
    shot = Shot()
    sphere = UsdLux.SphereLight.Define(shot.stage, "/Light")
    sphere.CreateRadiusAttr(0.0)
    sphere.CreateIntensityAttr(8.0)
    sphere.CreateNormalizeAttr(True)
    assert only_light(shot)["radiance"][0] == pytest.approx(2.0)


def test_lights_move_with_their_ancestors():
    shot = Shot()
    move = UsdGeom.Xform.Define(shot.stage, "/Parent").AddTranslateOp()
    move.Set(Gf.Vec3d(0), 9.0)
    move.Set(Gf.Vec3d(2, 0, 0), 11.0)
    UsdLux.SphereLight.Define(shot.stage, "/Parent/Light")
    light = only_light(shot)
    assert light["world_from_light"][[0, -1], 3, 0] == pytest.approx([0.5, 1.5])


def test_the_camera_light_where_there_is_no_other():
    shot = Shot()
    light = only_light(shot)
    assert light["kind"] == "camera" and light["radiance"] == (1.0, 1.0, 1.0)
    assert light["world_from_light"][0, 3, 2] == 20.0
    assert shot.read(disable_camera_light=True).scene.lights == []
    UsdLux.DomeLight.Define(shot.stage, "/Dome")
    assert only_light(shot)["kind"] == "dome"


def test_invisible_lights_do_not_shine():
    shot = Shot()
    UsdGeom.Imageable(UsdLux.DomeLight.Define(shot.stage, "/Dome")).MakeInvisible()
    assert only_light(shot)["kind"] == "camera"


def test_lights_in_instances_shine_in_each():
    shot = Shot()
    shot.stage.CreateClassPrim("/Asset")
    UsdLux.SphereLight.Define(shot.stage, "/Asset/Light")
    for index in range(2):
        prim = UsdGeom.Xform.Define(shot.stage, f"/Instance_{index}")
        prim.AddTranslateOp().Set(Gf.Vec3d(index, 0, 0))
        prim.GetPrim().GetReferences().AddInternalReference("/Asset")
        prim.GetPrim().SetInstanceable(True)
    assert [light["world_from_light"][0, 3, 0] for light in shot.read().scene.lights] == [0.0, 1.0]


def test_lights_that_are_left_out_are_named():
    shot = Shot()
    UsdLux.PortalLight.Define(shot.stage, "/Portal")
    UsdLux.GeometryLight.Define(shot.stage, "/Geometry")
    shot.stage.DefinePrim("/Plugin", "PluginLight")
    UsdLux.SphereLight.Define(shot.stage, "/Light").GetFiltersRel().AddTarget("/Filter")
    result = shot.read()
    assert len(result.scene.lights) == 1
    warnings = messages(result, "warning")
    assert any(w.startswith("/Portal: no dome light lists it in its portals") for w in warnings)
    assert any(w.startswith("/Geometry.geometry: found no geometry") for w in warnings)
    assert "/Plugin: lights of type PluginLight are not supported yet; left out" in warnings
    assert any(w.startswith("/Light.light:filters: light filters are not supported yet") for w in warnings)


def test_a_sphere_light_that_is_an_ellipsoid_is_named():
    shot = Shot()
    for path, scale in (("/Ball", (2, 2, 2)), ("/Egg", (1, 1, 2))):
        light = UsdLux.SphereLight.Define(shot.stage, path)
        light.AddRotateXYZOp().Set(Gf.Vec3f(10, 20, 30))
        light.AddScaleOp().Set(Gf.Vec3f(*scale))
    (warning,) = messages(shot.read(), "warning")
    assert warning.startswith("/Egg.xformOpOrder: found a transform that shears or scales unevenly")


def test_a_light_with_a_value_of_another_type_is_left_out():
    shot = Shot()
    UsdLux.SphereLight.Define(shot.stage, "/Light")
    light = shot.stage.GetRootLayer().GetPrimAtPath("/Light")
    Sdf.AttributeSpec(light, "inputs:radius", Sdf.ValueTypeNames.String).default = "wide"
    result = shot.read(disable_camera_light=True)
    assert messages(result) == ["/Light.inputs:radius: found string, expected float; the light is left out"]
    assert result.scene.lights == []


def test_an_exposure_beyond_all_numbers_is_left_to_the_translators_check():
    shot = Shot()
    UsdLux.SphereLight.Define(shot.stage, "/Light").CreateExposureAttr(2000.0)
    assert only_light(shot)["radiance"] == (math.inf,) * 3
