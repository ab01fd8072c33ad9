"""What reading and `msbvh record` make of render settings prims: pictures, files and the command line."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio
import pytest
from conftest import Fails, Run
from msbvh import _core
from msbvh.base.errors import Diagnostics, SceneError
from msbvh.output.images import read_alpha
from msbvh.render_settings.asked import SettingsChoice, applied_to_reading, asked_of
from msbvh.render_settings.layers import file_layers
from msbvh.scene.reader import ReadSettings, read_frame
from pxr import Gf, Sdf, Usd, UsdRender, UsdShade
from render_settings_stage import SETTINGS, STAGE, stage_of
from shared_scenes import SCENES, require


def applied(stage: Usd.Stage, *given: str, **read: Any) -> ReadSettings:
    said = Diagnostics()
    asked = asked_of(stage, SettingsChoice(SETTINGS), None, said)
    assert asked is not None
    return applied_to_reading(asked, ReadSettings(**read), set(given), said)


# What reading follows.


def test_settings_win_over_usdrecords_camera_and_width_and_lose_to_the_rest():
    stage = stage_of()
    for given in ((), ("camera", "image_width")):
        read = applied(stage, *given, camera="Other", width=960)
        assert (read.camera, read.width, read.height) == ("/Cam", 80, 40)
    assert applied(stage, "resolution", width=10, height=20).picture.sized(1.0) == (10, 20)
    assert applied(stage).purposes == ("render",)
    assert applied(stage, "purposes", purposes=("guide",)).purposes == ("guide",)
    assert applied(stage).motion_tolerance == 0.25
    assert applied(stage, "motion_tolerance", motion_tolerance=0.5).motion_tolerance == 0.5
    stage.GetAttributeAtPath(f"{SETTINGS}.aspectRatioConformPolicy").Set("cropAperture")
    assert applied(stage).conform == "cropAperture"
    assert applied(stage, "conform").conform == "expandAperture"
    stage.GetAttributeAtPath(f"{SETTINGS}.disableMotionBlur").Set(True)
    assert not applied(stage).motion_blur
    assert applied(stage, "shutter", shutter=(0.0, 1.0)).motion_blur


def test_what_is_not_authored_leaves_the_options_defaults():
    stage = stage_of(re.sub(r"\n +uniform (int2|token\[\]) [^\n]*", "", STAGE))
    read = applied(stage)
    assert (read.width, read.height, read.purposes) == (960, None, ("proxy",))


def test_blur_is_turned_off():
    stage = stage_of()
    moving = stage.GetPrimAtPath("/Cam").GetAttribute("xformOp:translate")
    moving.Set(Gf.Vec3d(0, 0, 9), 0.0)
    moving.Set(Gf.Vec3d(0, 0, 11), 2.0)
    result = read_frame(stage, 1.0, applied(stage))
    assert result.camera.shutter.moving and (result.camera.lenses[:, 0] == 0).all()
    stage.GetAttributeAtPath(f"{SETTINGS}.disableDepthOfField").Set(False)
    stage.GetAttributeAtPath(f"{SETTINGS}.instantaneousShutter").Set(True)
    result = read_frame(stage, 1.0, applied(stage))
    assert not result.camera.shutter.moving and (result.camera.lenses[:, 0] > 0).all()


def test_the_purpose_of_materials_is_followed():
    stage = stage_of()
    square = stage.GetPrimAtPath("/Slope")
    for purpose, colour in (("full", (1, 0, 0)), ("preview", (0, 1, 0)), ("", (0, 0, 1))):
        material = UsdShade.Material.Define(stage, f"/Looks/M{purpose}")
        shader = UsdShade.Shader.Define(stage, f"/Looks/M{purpose}/S")
        shader.CreateIdAttr("UsdPreviewSurface")
        shader.CreateInput("emissiveColor", Sdf.ValueTypeNames.Color3f).Set(Gf.Vec3f(*colour))
        shader.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).Set(Gf.Vec3f(0))
        material.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "surface")
        binding = UsdShade.MaterialBindingAPI.Apply(square)
        binding.Bind(material, materialPurpose=purpose or UsdShade.Tokens.allPurpose)
    stage.GetAttributeAtPath("/Render/Product.dataWindowNDC").Set(Gf.Vec4f(0, 0, 1, 1))
    for purposes, channel in ((["full", ""], 0), (["preview", ""], 1), ([""], 2)):
        stage.GetAttributeAtPath(f"{SETTINGS}.materialBindingPurposes").Set(purposes)
        result = read_frame(stage, 1.0, applied(stage))
        image = _core.Renderer(result.scene, width=80, height=40, spp=1).render()
        # What it emits; what a UsdPreviewSurface reflects whatever its colour is in all channels alike.
        others = np.delete(image[..., :3], channel, axis=2)
        assert np.array_equal(others[..., 0], others[..., 1])
        assert (image[..., channel] - others[..., 0]).max() == pytest.approx(1.0, abs=1e-5)


def picture(stage: Usd.Stage, **changes: Any) -> np.ndarray:
    read = applied(stage, **changes)
    result = read_frame(stage, 1.0, read)
    size = {"width": result.camera.width, "height": result.camera.height}
    return _core.Renderer(result.scene, **size, spp=64, max_bounces=0).render()


@pytest.mark.parametrize("projection", ["perspective", "orthographic"])
def test_a_crop_is_that_part_of_the_picture_and_overscan_what_lies_around_it(projection):
    stage = stage_of()
    stage.GetPrimAtPath("/Cam").GetAttribute("projection").Set(projection)
    if projection == "orthographic":
        stage.GetPrimAtPath("/Cam").GetAttribute("horizontalAperture").Set(80.0)
        stage.GetPrimAtPath("/Cam").GetAttribute("verticalAperture").Set(40.0)
    window = stage.GetAttributeAtPath("/Render/Product.dataWindowNDC")
    window.Set(Gf.Vec4f(0, 0, 1, 1))
    whole = picture(stage)[..., 3]
    assert whole.shape == (40, 80) and ((whole > 0.02) & (whole < 0.98)).sum() > 20, "the test sees no edges"
    window.Set(Gf.Vec4f(0.5, 0.25, 1.0, 1.0))
    crop = picture(stage)[..., 3]
    assert crop.shape == (30, 40)
    near = np.abs(crop - whole[:30, 40:])
    assert near.max() < 0.25 and near.mean() < 0.004
    assert np.abs(crop - whole[1:31, 40:]).mean() > 0.012, "a pixel more would pass too"
    window.Set(Gf.Vec4f(-0.25, -0.5, 1.5, 1.25))
    wide = picture(stage)[..., 3]
    assert wide.shape == (70, 140)
    inside = np.abs(wide[10:50, 20:100] - whole)
    assert inside.max() < 0.25 and inside.mean() < 0.004


def test_pixels_that_are_no_squares_change_the_height():
    stage = stage_of(re.sub(r"\n +uniform int2 [^\n]*", "", STAGE))
    stage.GetAttributeAtPath(f"{SETTINGS}.pixelAspectRatio").Set(2.0)
    stage.GetAttributeAtPath("/Render/Product.dataWindowNDC").Set(Gf.Vec4f(0, 0, 1, 1))
    camera = read_frame(stage, 1.0, applied(stage, width=80)).camera
    # 80 pixels twice as wide as high, for a window of 2 to 1.
    assert (camera.width, camera.height, camera.pixel_aspect_ratio) == (80, 80, 2.0)
    assert camera.windows[0].tolist() == pytest.approx([-0.4, 0.4, -0.2, 0.2])


# The command line.


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    path = tmp_path / "stage.usda"
    path.write_text(STAGE)
    return path


def test_record_writes_the_first_products_windows_and_layers(msbvh: Run, scene: Path, tmp_path: Path):
    done = msbvh("record", scene, "a.exr", "--stats", "s.json", "--aov", "primId")
    assert done.returncode == 0, done.stderr
    image = oiio.ImageBuf(str(tmp_path / "a.exr"))
    spec = image.spec()
    assert (spec.x, spec.y, spec.width, spec.height) == (20, -10, 40, 40)
    assert (spec.full_x, spec.full_y, spec.full_width, spec.full_height) == (0, 0, 80, 40)
    formats = {name: str(spec.channelformat(i)) for i, name in enumerate(spec.channelnames)}
    colour = dict.fromkeys("RGBA", "half")
    tint = dict.fromkeys(("tint.R", "tint.G", "tint.B"), "float")
    assert formats == {**colour, "far": "half", **tint, "primId": "float"}
    pixels = {name: image.get_pixels(oiio.FLOAT)[..., i] for i, name in enumerate(spec.channelnames)}
    assert pixels["far"].max() == 10.0
    assert pixels["tint.B"].max() == pytest.approx(0.6, abs=1e-6)
    assert json.loads((tmp_path / "s.json").read_text())["settings"]["render"]["spp"] == 4
    lines = done.stderr.splitlines()
    assert "msbvh: /Render/Product.productName: found 'beauty.exr'; written to a.exr instead" in lines
    assert [line for line in lines if "warning" in line] == [
        "msbvh: warning: /Render/Second: not rendered: of several products the first is, /Render/Product"
    ]


def test_a_render_var_and_an_aov_of_one_name_are_told_apart():
    stage = stage_of()
    stage.GetAttributeAtPath("/Render/far.sourceName").Set("Neye")
    stage.GetPrimAtPath("/Render/Product").GetRelationship("orderedVars").SetTargets(["/Render/far", "/Render/tint"])
    said = Diagnostics()
    asked = asked_of(stage, SettingsChoice(SETTINGS), None, said)
    assert asked is not None
    said = Diagnostics()
    found = file_layers(asked, ("depth", "albedo"), said)
    assert [(layer.name, layer.aov) for layer in found.layers] == [
        ("far", "Neye"), ("tint", "albedo"), ("depth", "depth"), ("albedo", "albedo"),
    ]  # fmt: skip
    assert found.aovs == ("Neye", "albedo", "depth") and found.color_half is None
    assert [str(each) for each in said] == [
        "/Render/Product.orderedVars: names no colour, which is written all the same"
    ]
    depth = UsdRender.Var.Define(stage, "/Render/depth")
    depth.CreateSourceNameAttr("z")
    stage.GetPrimAtPath("/Render/Product").GetRelationship("orderedVars").SetTargets(
        ["/Render/Beauty", "/Render/depth"]
    )
    asked = asked_of(stage, SettingsChoice(SETTINGS), None, Diagnostics())
    assert asked is not None
    said = Diagnostics()
    assert file_layers(asked, ("depth",), said).aovs == ("cameraDepth",)
    assert "depth: not written: a render var of that name is cameraDepth" in str(next(iter(said)))


def test_record_follows_the_option_rather_than_the_metadata(msbvh: Run, scene: Path, tmp_path: Path):
    scene.write_text(STAGE + 'def RenderSettings "Small" {\n uniform int2 resolution = (8, 6)\n}')
    for option, size in ((("-rs", "/Small"), (8, 6)), (("-rs", "Small"), (8, 6)), (("-rs", ""), (32, 16))):
        done = msbvh("record", scene, "a.exr", "--imageWidth", "32", "--spp", "1", *option)
        assert done.returncode == 0, done.stderr
        spec = oiio.ImageBuf(str(tmp_path / "a.exr")).spec()
        assert (spec.width, spec.height) == size


def test_display_formats_hold_the_data_window_alone(msbvh: Run, scene: Path, tmp_path: Path):
    done = msbvh("record", scene, "a.png", "b.tif", "--spp", "1")
    assert done.returncode == 0, done.stderr
    for name in ("a.png", "b.tif"):
        spec = oiio.ImageBuf(str(tmp_path / name)).spec()
        assert (spec.x, spec.y, spec.width, spec.height) == (0, 0, 40, 40)
    assert "/Render/far: not written: only .exr files hold AOVs" in done.stderr


def test_other_commands_look_through_the_same_settings(msbvh: Run, scene: Path):
    done = msbvh("plan", scene, "--json", "--disableCameraLight")
    assert done.returncode == 0, done.stderr
    assert msbvh("motion", scene, "-rs", "/Nowhere").returncode == 1


def test_settings_that_are_not_there_are_an_error(fails: Fails, scene: Path):
    for path in ("/Render", "/Nowhere", "not a path//"):
        message = (
            f"renderSettingsPrimPath: found no RenderSettings at '{path}', expected one of the stage's: {SETTINGS}"
        )
        fails(["record", scene, "a.exr", "-rs", path], 1, message)


def test_metadata_that_names_nothing_is_a_warning():
    stage = stage_of(STAGE.replace(f'Path = "{SETTINGS}"', 'Path = "/Nowhere"'))
    said = Diagnostics()
    assert asked_of(stage, SettingsChoice(), None, said) is None
    assert [str(each) for each in said] == [
        "renderSettingsPrimPath: found '/Nowhere', expected the path of a RenderSettings prim; ignored"
    ]
    with pytest.raises(SceneError):
        asked_of(stage, SettingsChoice("/Nowhere"), None, said)


@pytest.mark.shared
def test_a_crop_with_overscan_is_where_another_renderer_has_it(msbvh: Run, tmp_path: Path):
    """Arnold's picture of a window of (0.4, 0.1, 0.6, 1.2). It keeps the camera's width, whatever the conform policy is."""
    folder = SCENES / "render_settings" / "arnold_0233"
    require(folder)
    options = (
        "-rs",
        "/Render/rendersettings",
        "--conform",
        "adjustApertureHeight",
        "--max-bounces",
        "0",
        "--spp",
        "256",
    )
    done = msbvh("record", folder / "data" / "test.usda", "a.exr", *options)
    assert done.returncode == 0, done.stderr
    ours, theirs = read_alpha(tmp_path / "a.exr"), read_alpha(folder / "ref" / "reference.tif")
    assert np.abs(ours - theirs).mean() < 0.001
    for rows in ((slice(1, None), slice(None, -1)), (slice(None, -1), slice(1, None))):
        assert np.abs(ours[rows[0]] - theirs[rows[1]]).mean() > 0.005, "a row more or less would pass too"
