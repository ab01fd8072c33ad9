"""Every input of UsdLux's lights: kinds, shaping, images, IES profiles, shadows, links, and what is wrong with them."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux
from recording import Shot, messages

IES = "IESNA:LM-63-2002\nTILT=NONE\n1 1000 1 2 1 1 2 0 0 0\n1 1 50\n0 90\n0\n100 50\n"


def only_light(shot: Shot) -> dict:
    (light,) = shot.read().scene.lights
    return light


def write_image(path: Path, texels: np.ndarray) -> str:
    height, width, channels = texels.shape
    out = oiio.ImageOutput.create(str(path))
    kind = oiio.UINT8 if texels.dtype == np.uint8 else oiio.FLOAT
    assert out.open(str(path), oiio.ImageSpec(width, height, channels, kind))
    assert out.write_image(texels)
    out.close()
    return str(path)


def test_a_cylinder_and_a_disk_by_their_sizes_and_areas():
    shot = Shot()
    tube = UsdLux.CylinderLight.Define(shot.stage, "/Light")
    light = only_light(shot)
    assert (light["kind"], light["radius"], light["length"]) == ("cylinder", 0.5, 1.0)
    tube.CreateRadiusAttr(0.25)
    tube.CreateLengthAttr(3.0)
    tube.CreateNormalizeAttr(True)
    tube.CreateIntensityAttr(1.0)
    tube.AddScaleOp().Set(Gf.Vec3f(2, 3, 3))
    assert only_light(shot)["radiance"][0] == pytest.approx(1 / (2 * math.pi * 0.75 * 6))
    shot.stage.RemovePrim("/Light")
    disk = UsdLux.DiskLight.Define(shot.stage, "/Light")
    disk.CreateRadiusAttr(2.0)
    disk.CreateNormalizeAttr(True)
    disk.AddScaleOp().Set(Gf.Vec3f(1, 3, 7))
    light = only_light(shot)
    assert light["kind"] == "disk" and light["radius"] == 2.0
    assert light["radiance"][0] == pytest.approx(1 / (math.pi * 4 * 3))


def test_defaults_without_and_with_shaping():
    shot = Shot()
    prim = UsdLux.SphereLight.Define(shot.stage, "/Light").GetPrim()
    light = only_light(shot)
    assert (light["focus"], light["cone_angle_degrees"], light["cone_softness"]) == (0.0, 180.0, 0.0)
    assert (light["diffuse"], light["specular"]) == (1.0, 1.0)
    UsdLux.ShapingAPI.Apply(prim)
    assert only_light(shot)["cone_angle_degrees"] == 90.0


def test_shaping_and_multipliers_are_read_and_clamped():
    shot = Shot()
    light = UsdLux.SphereLight.Define(shot.stage, "/Light")
    light.CreateDiffuseAttr(0.5)
    light.CreateSpecularAttr(0.0)
    shaping = UsdLux.ShapingAPI.Apply(light.GetPrim())
    shaping.CreateShapingFocusAttr(-3.0)
    shaping.CreateShapingConeAngleAttr(30.0)
    shaping.CreateShapingConeSoftnessAttr(4.0)
    found = only_light(shot)
    assert (found["diffuse"], found["specular"], found["focus"]) == (0.5, 0.0, 0.0)
    assert (found["cone_angle_degrees"], found["cone_softness"]) == (30.0, 1.0)


def test_shaping_that_changes_inside_the_shutter_moves():
    shot = Shot()
    light = UsdLux.DiskLight.Define(shot.stage, "/Light")
    angle = UsdLux.ShapingAPI.Apply(light.GetPrim()).CreateShapingConeAngleAttr()
    angle.Set(20.0, 9.0)
    angle.Set(60.0, 11.0)
    found = only_light(shot)
    column = list(_names()).index("shaping:cone:angle")
    assert found["numbers"][0, column] == pytest.approx(30.0, abs=1e-3)
    assert found["numbers"][-1, column] == pytest.approx(50.0, abs=1e-3)


def _names() -> dict[str, float]:
    from msbvh.look.light_values import NUMBERS

    return NUMBERS


def test_a_dome_and_a_rect_have_images(tmp_path: Path):
    shot = Shot()
    texels = np.full((4, 8, 3), 0.5, np.float32)
    file = write_image(tmp_path / "sky.exr", texels)
    for kind in ("DomeLight", "DomeLight_1", "RectLight"):
        getattr(UsdLux, kind).Define(shot.stage, "/Light").CreateTextureFileAttr(file)
        assert only_light(shot)["look"].has_image
        assert messages(shot.read(), "warning") == []
        shot.stage.RemovePrim("/Light")
    assert not only_light_of(shot, "SphereLight")["look"].has_image


def only_light_of(shot: Shot, kind: str) -> dict:
    getattr(UsdLux, kind).Define(shot.stage, "/Light")
    return only_light(shot)


def test_images_that_cannot_be_read_are_named(tmp_path: Path):
    broken = tmp_path / "broken.exr"
    broken.write_bytes(b"no picture")
    texels = np.ones((4, 8, 3), np.float32)
    texels[0, 0] = np.nan
    spotted = write_image(tmp_path / "spotted.exr", texels)
    for file, expected in (
        ("absent.exr", "found @absent.exr@, which cannot be read (no such file); lit by the plain colour"),
        (str(broken), "which cannot be read"),
        (spotted, "found NaN or infinity in 1 texels"),
    ):
        shot = Shot()
        UsdLux.DomeLight.Define(shot.stage, "/Dome").CreateTextureFileAttr(file)
        (warning,) = messages(shot.read(), "warning")
        assert warning.startswith("/Dome.inputs:texture:file: ") and expected in warning


def test_a_format_without_a_map_is_named(tmp_path: Path):
    shot = Shot()
    dome = UsdLux.DomeLight.Define(shot.stage, "/Dome")
    dome.CreateTextureFileAttr(write_image(tmp_path / "sky.exr", np.ones((4, 8, 3), np.float32)))
    dome.CreateTextureFormatAttr("cubeMapVerticalCross")
    (warning,) = messages(shot.read(), "warning")
    assert warning.startswith("/Dome.inputs:texture:format: found cubeMapVerticalCross, expected one of automatic")
    dome.GetTextureFormatAttr().Set("angular")
    assert only_light(shot)["look"].has_image


def test_the_pole_of_a_dome():
    """DomeLight's top is +y of its own space whatever the stage's up axis is; DomeLight_1's by its poleAxis."""
    for up, kind, axis, turned in (
        ("Z", "DomeLight", None, False),
        ("Y", "DomeLight_1", None, False),
        ("Z", "DomeLight_1", None, True),
        ("Z", "DomeLight_1", "Y", False),
        ("Y", "DomeLight_1", "Z", True),
    ):
        shot = Shot()
        UsdGeom.SetStageUpAxis(shot.stage, up)
        dome = getattr(UsdLux, kind).Define(shot.stage, "/Dome")
        if axis:
            dome.CreatePoleAxisAttr(axis)
        matrix = only_light(shot)["world_from_light"][0]
        top, middle = np.array([0, 1, 0, 0]) @ matrix, np.array([0, 0, 1, 0]) @ matrix
        assert top[:3] == pytest.approx([0, 0, 1] if turned else [0, 1, 0])
        assert middle[:3] == pytest.approx([0, -1, 0] if turned else [0, 0, 1])


def test_ies_profiles_are_read_or_named(tmp_path: Path):
    good, bad = tmp_path / "good.ies", tmp_path / "bad.ies"
    good.write_text(IES)
    bad.write_text(IES.replace("100 50", "100 nan"))
    shot = Shot()
    light = UsdLux.SphereLight.Define(shot.stage, "/Light")
    file = UsdLux.ShapingAPI.Apply(light.GetPrim()).CreateShapingIesFileAttr(str(good))
    result = shot.read()
    assert result.scene.lights[0]["look"].has_ies and messages(result, "warning") == []
    for path, expected in ((bad, 'line 7: found "nan'), (tmp_path / "none.ies", "no such file")):
        file.Set(str(path))
        result = shot.read()
        (warning,) = messages(result, "warning")
        assert warning.startswith("/Light.inputs:shaping:ies:file: found @") and expected in warning
        assert not result.scene.lights[0]["look"].has_ies


def test_a_shadow_gamma_that_is_no_power_is_named():
    shot = Shot()
    light = UsdLux.SphereLight.Define(shot.stage, "/Light")
    shadow = UsdLux.ShadowAPI.Apply(light.GetPrim())
    shadow.CreateShadowEnableAttr(False)
    shadow.CreateShadowFalloffGammaAttr(0.0)
    (warning,) = messages(shot.read(), "warning")
    assert warning == "/Light.inputs:shadow:falloffGamma: found 0, expected a finite number above 0; took 1"


def test_links_group_prims_by_the_lights_that_reach_them():
    shot = Shot()
    for name in ("A", "B", "C"):
        UsdGeom.Cube.Define(shot.stage, f"/{name}")
    UsdLux.SphereLight.Define(shot.stage, "/All")
    light = UsdLux.LightAPI(UsdLux.SphereLight.Define(shot.stage, "/Light"))
    light.GetLightLinkCollectionAPI().CreateExcludesRel().AddTarget("/A")
    light.GetShadowLinkCollectionAPI().CreateExcludesRel().AddTarget("/B")
    result = shot.read()
    assert messages(result, "warning") == []
    looks = {light["name"]: light["look"] for light in result.scene.lights}
    assert looks["/All"].links == ([], [])
    lit, shadowed = looks["/Light"].links
    groups = {path: group for path, (group,) in result.scene.light_groups.items()}
    assert lit[groups["/C"]] and shadowed[groups["/C"]]
    assert not lit[groups["/A"]] and shadowed[groups["/A"]]
    assert lit[groups["/B"]] and not shadowed[groups["/B"]]


def test_a_stage_without_links_has_no_groups():
    shot = Shot()
    UsdGeom.Cube.Define(shot.stage, "/A")
    UsdLux.SphereLight.Define(shot.stage, "/Light")
    scene = shot.read().scene
    assert scene.light_groups == {}
    assert scene.lights[0]["look"].links == ([], [])


def test_treat_as_point_and_line_are_hints():
    shot = Shot()
    UsdLux.SphereLight.Define(shot.stage, "/Light").CreateTreatAsPointAttr(True)
    assert only_light(shot)["radius"] == 0.5


def test_an_input_of_another_type_is_named():
    shot = Shot()
    light = UsdLux.SphereLight.Define(shot.stage, "/Light")
    UsdLux.ShadowAPI.Apply(light.GetPrim())
    spec = shot.stage.GetRootLayer().GetPrimAtPath("/Light")
    Sdf.AttributeSpec(spec, "inputs:shadow:distance", Sdf.ValueTypeNames.String).default = "far"
    result = shot.read()
    assert [m for m in messages(result) if "shadow:distance" in m]
    assert len(result.scene.lights) == 1


def test_a_light_of_negative_size_is_left_out():
    shot = Shot()
    UsdLux.DiskLight.Define(shot.stage, "/Light").CreateRadiusAttr(-1.0)
    result = shot.read(disable_camera_light=True)
    assert any(m.startswith("/Light.inputs:radius: found -1") for m in messages(result))


def test_lights_in_instancers_shine_at_each_place():
    shot = Shot()
    UsdLux.DiskLight.Define(shot.stage, "/Instancer/Lamp")
    instancer = UsdGeom.PointInstancer.Define(shot.stage, "/Instancer")
    instancer.CreatePrototypesRel().AddTarget("/Instancer/Lamp")
    instancer.CreateProtoIndicesAttr([0, 0, 0])
    instancer.CreatePositionsAttr([(0, 0, 0), (1, 0, 0), (2, 0, 0)])
    lights = shot.read().scene.lights
    assert [light["world_from_light"][0, 3, 0] for light in lights] == [0.0, 1.0, 2.0]
    assert {light["kind"] for light in lights} == {"disk"}


def test_the_stage_is_not_changed():
    shot = Shot()
    UsdLux.CylinderLight.Define(shot.stage, "/Light")
    before = shot.stage.GetRootLayer().ExportToString()
    shot.read()
    assert shot.stage.GetRootLayer().ExportToString() == before
    assert isinstance(shot.stage, Usd.Stage)
