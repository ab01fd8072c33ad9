"""Render settings prims: read by UsdRenderComputeSpec's rules, and followed by `msbvh record`."""

from __future__ import annotations

import json
import random
import re
from collections.abc import Iterator
from functools import cache
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
from msbvh.render_settings.render_prims import read_render_spec
from msbvh.scene.reader import ReadSettings, read_frame
from msbvh.stage import values
from pxr import Gf, Sdf, Usd, UsdGeom, UsdRender, UsdShade
from render_spec_oracle import Product, compute_spec
from shared_scenes import SCENES, SharedScene, every_scene, here, parameters, require
from soak import soak_count, soak_figure
from test_values import TYPES, sample_of

STAGE = """#usda 1.0
(
    startTimeCode = 1
    renderSettingsPrimPath = "/Render/Settings"
)
def Camera "Cam" {
    float horizontalAperture = 20
    float verticalAperture = 10
    float focalLength = 25
    float2 clippingRange = (1, 100)
    double shutter:open = -0.5
    double shutter:close = 0.5
    float fStop = 0.5
    float focusDistance = 2
    double3 xformOp:translate = (0, 0, 10)
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
def Camera "Other" {
    double3 xformOp:translate = (0, 0, 12)
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
def Mesh "Slope" {
    int[] faceVertexCounts = [3]
    int[] faceVertexIndices = [0, 1, 2]
    point3f[] points = [(-4, -2, 0), (4, -2, 0), (4, 2, 0)]
    color3f[] primvars:displayColor = [(0.2, 0.4, 0.6)]
    uniform token subdivisionScheme = "none"
}
def Scope "Render" {
    def RenderSettings "Settings" {
        rel camera = </Cam>
        rel products = [</Render/Product>, </Render/Second>]
        uniform int2 resolution = (80, 40)
        uniform float pixelAspectRatio = 1
        uniform token aspectRatioConformPolicy = "expandAperture"
        uniform float4 dataWindowNDC = (0, 0, 1, 1)
        uniform bool disableMotionBlur = 0
        uniform bool instantaneousShutter = 0
        uniform bool disableDepthOfField = 1
        uniform token[] includedPurposes = ["default", "render"]
        uniform token[] materialBindingPurposes = ["full", ""]
        uniform token renderingColorSpace = "lin_rec709_scene"
        uniform int msbvh:samplesPerPixel = 4
        uniform float msbvh:motionTolerance = 0.25
    }
    def RenderProduct "Product" {
        rel orderedVars = [</Render/Beauty>, </Render/far>, </Render/tint>]
        uniform token productType = "raster"
        token productName = "beauty.exr"
        uniform float4 dataWindowNDC = (0.25, 0.25, 0.75, 1.25)
    }
    def RenderProduct "Second" {
        rel camera = </Other>
        uniform int2 resolution = (30, 40)
        uniform float pixelAspectRatio = 2
    }
    def RenderVar "Beauty" {
        uniform token dataType = "color4h"
        uniform string sourceName = "C.*[LO]"
        uniform token sourceType = "lpe"
    }
    def RenderVar "far" {
        uniform token dataType = "half"
        uniform string sourceName = "z"
    }
    def RenderVar "tint" {
        uniform string sourceName = "albedo"
    }
}
"""
SETTINGS = "/Render/Settings"


def stage_of(text: str = STAGE) -> Usd.Stage:
    layer = Sdf.Layer.CreateAnonymous(".usda")
    assert layer.ImportFromString(text)
    return Usd.Stage.Open(layer)


def spec_of(stage: Usd.Stage, path: str = SETTINGS) -> tuple[_core.RenderSpec, list[str]]:
    """And what was said."""
    said = Diagnostics()
    with values.reported_to(said):
        return read_render_spec(stage.GetPrimAtPath(path)), [str(each) for each in said]


def applied(stage: Usd.Stage, *given: str, **read: Any) -> ReadSettings:
    said = Diagnostics()
    asked = asked_of(stage, SettingsChoice(SETTINGS), None, said)
    assert asked is not None
    return applied_to_reading(asked, ReadSettings(**read), set(given), said)


def product_of(spec: _core.ProductSpec, product: Product, stage: Usd.Stage) -> Product:
    """A product of ours as the oracle puts it; what is kept of USD's own, because ours says it otherwise: the name, which is
    the frame's here, and the type and the vars, which are checked."""
    camera = UsdGeom.Camera(stage.GetPrimAtPath(spec.camera))
    across, up = camera.GetHorizontalApertureAttr().Get(), camera.GetVerticalApertureAttr().Get()
    window = (-across / 2, across / 2, -up / 2, up / 2)
    (left, right, bottom, top), pixel_aspect = _core.conformed_picture(
        window, spec.width, spec.height, spec.pixel_aspect_ratio, spec.policy
    )
    return Product(
        path=spec.path,
        type=product.type,
        name=product.name,
        camera=spec.camera,
        disable_motion_blur=not spec.motion_blur,
        disable_depth_of_field=not spec.depth_of_field,
        resolution=(spec.width, spec.height),
        pixel_aspect_ratio=pytest.approx(pixel_aspect, rel=1e-6),
        policy=spec.policy,
        aperture=(pytest.approx(right - left, rel=1e-6), pytest.approx(top - bottom, rel=1e-6)),
        data_window=tuple(spec.data_window_ndc),
        vars=product.vars,
    )


def assert_as_usd(stage: Usd.Stage) -> int:
    """All settings of a stage; how many products there were."""
    count = 0
    for prim in stage.Traverse():
        if not prim.IsA(UsdRender.Settings):
            continue
        spec, _ = spec_of(stage, str(prim.GetPath()))
        expected = compute_spec(UsdRender.Settings(prim))
        assert len(spec.products) == len(expected)
        for ours, theirs in zip(spec.products, expected, strict=True):
            assert product_of(ours, theirs, stage) == theirs
            assert [var.path for var in ours.vars] == [path for path, *_ in theirs.vars]
            count += 1
        settings = UsdRender.Settings(prim)
        assert spec.included_purposes == list(settings.GetIncludedPurposesAttr().Get())
        purposes = list(settings.GetMaterialBindingPurposesAttr().Get())
        assert spec.material_purpose == purposes[0].replace("allPurpose", "")
    return count


def with_settings(scene: SharedScene) -> str:
    return "" if scene.opens else "broken on purpose: USD does not open it"


FOLDERS = ("render_settings", "cameras")


@pytest.mark.shared
@pytest.mark.parametrize("scene", parameters([each for each in every_scene() if each.group in FOLDERS], with_settings))
def test_public_scenes_ask_for_what_usd_computes(scene):
    stage = Usd.Stage.Open(str(here(scene).path))
    found = assert_as_usd(stage)
    assert found or scene.group == "cameras"


@pytest.mark.parametrize("policy", _core.ASPECT_POLICIES)
@pytest.mark.parametrize("pixel_aspect", [0.5, 1.0, 2.0])
def test_settings_are_what_usd_computes(policy, pixel_aspect):
    stage = stage_of()
    settings = UsdRender.Settings.Get(stage, SETTINGS)
    settings.GetAspectRatioConformPolicyAttr().Set(policy)
    settings.GetPixelAspectRatioAttr().Set(pixel_aspect)
    for disabled in (False, True):
        settings.GetDisableMotionBlurAttr().Set(disabled)
        assert assert_as_usd(stage) == 2


# What is read, and what is said of what is wrong.


@cache
def asked() -> dict[tuple[str, str], Any]:
    values.asked = {}
    try:
        spec_of(stage_of())
        return values.asked
    finally:
        values.asked = None


@cache
def whole_stage() -> Usd.Stage:
    return stage_of()


def attributes() -> Iterator[Usd.Attribute]:
    """Those that are authored on render settings prims."""
    for prim in whole_stage().Traverse():
        if prim.GetTypeName() in ("RenderSettings", "RenderProduct", "RenderVar"):
            yield from prim.GetAuthoredAttributes()


def test_every_attribute_that_is_authored_is_asked_for():
    """Otherwise the sweep would not try it."""
    read = {(str(attribute.GetPrim().GetTypeName()), attribute.GetName()) for attribute in attributes()}
    assert read == set(asked())


def test_the_kinds_that_are_asked_for_are_those_of_the_schemas():
    for attribute in attributes():
        kind = asked()[str(attribute.GetPrim().GetTypeName()), attribute.GetName()]
        definition = attribute.GetPrim().GetPrimDefinition().GetAttributeDefinition(attribute.GetName())
        if definition:
            assert type(definition.GetTypeName().defaultValue) is kind.exact, attribute.GetPath()


CASES = 250
"""Of the sweep, in a sample."""


@pytest.mark.soak
def test_a_value_of_any_type_is_taken_or_named():
    """Every attribute that is read x every type of value, scalar and array."""
    every = [(attribute.GetPath(), typed) for attribute in attributes() for typed in TYPES]
    chosen = random.Random(5).sample(every, soak_count(min(CASES, len(every)), len(every)))
    faults = [fault for path, typed in chosen if (fault := _fault(path, typed))]
    assert not faults, f"{len(faults)} of {len(chosen)}:\n" + "\n".join(faults[:40])
    soak_figure("render settings of any type", f"{len(chosen)} of {len(every)} attributes x types, all taken or named")


def _fault(path: Sdf.Path, typed: Sdf.ValueTypeName) -> str:
    stage = stage_of()
    spec = Sdf.CreatePrimInLayer(stage.GetSessionLayer(), path.GetPrimPath())
    Sdf.AttributeSpec(spec, path.name, typed).default = sample_of(typed)
    try:
        found, said = spec_of(stage)
    except Exception as error:
        return f"{path} as {typed}: {type(error).__name__}: {error}"
    if len(found.products) != 2:
        return f"{path} as {typed}: {len(found.products)} products"
    kind = asked()[str(stage.GetPrimAtPath(path.GetPrimPath()).GetTypeName()), path.name]
    held = type(stage.GetAttributeAtPath(path).Get())
    takes = kind is values.ANY or held in {kind.exact, *kind.conversions}
    if not takes and not any(str(path) in line for line in said):
        return f"{path} as {typed}: not a word; said {said}"
    return ""


NUMBERS = (
    0.0,
    -0.0,
    1.0,
    0.5,
    -1.0,
    1e-30,
    1e-45,
    65535.0,
    1e9,
    3e38,
    -3e38,
    float("inf"),
    -float("inf"),
    float("nan"),
)


def test_whatever_numbers_are_authored_the_picture_is_one_that_can_be_rendered():
    dice = random.Random(3)
    for _ in range(3000):
        settings = _core.RenderSettingsInput()
        product, base = _core.RenderProductInput(), _core.RenderBaseInput()
        base.path = "/Render/Product"
        if dice.random() < 0.7:
            base.resolution = (
                dice.choice((-(2**31), -1, 0, 1, 7, 1920, 65535, 65536, 2**31 - 1)),
                dice.randrange(1, 9),
            )
        base.pixel_aspect_ratio = dice.choice((None, *NUMBERS))
        base.data_window_ndc = tuple(dice.choice((*NUMBERS, dice.uniform(-2, 2))) for _ in range(4))
        base.aspect_ratio_conform_policy = dice.choice((*_core.ASPECT_POLICIES, "", "none"))
        product.base = base
        settings.products = [product]
        spec, said = _core.render_spec(settings)
        found = spec.products[0]
        assert 1 <= found.width <= 65535 and 1 <= found.height <= 65535
        (x, y, width, height), more = _core.pixels_of(found.data_window_ndc, found.path, found.width, found.height)
        assert 1 <= width <= 65535 and 1 <= height <= 65535 and abs(x) <= 65535 and abs(y) <= 2 * 65535
        window, pixel_aspect = _core.conformed_picture(
            (-1, 1, -1, 1), found.width, found.height, found.pixel_aspect_ratio, found.policy
        )
        assert np.isfinite(window).all() and window[0] < window[1] and window[2] < window[3] and pixel_aspect > 0
        for each in (*said, *more):
            assert each.path == "/Render/Product" and each.severity == "warning" and "expected" in each.message


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        ("Settings.resolution", Gf.Vec2i(0, 40), "/Render/Settings.resolution: found (0, 40), expected 1 to 65535"),
        ("Settings.resolution", Gf.Vec2i(2**31 - 1, 1), "expected 1 to 65535 pixels each way; ignored"),
        ("Settings.pixelAspectRatio", float("nan"), "/Render/Settings.pixelAspectRatio: found nan, expected a number"),
        ("Settings.aspectRatioConformPolicy", "stretch", "found 'stretch', expected one of expandAperture"),
        (
            "Product.dataWindowNDC",
            Gf.Vec4f(0, float("nan"), 1, 1),
            "/Render/Product.dataWindowNDC: found (0, nan, 1, 1)",
        ),
        ("Product.dataWindowNDC", Gf.Vec4f(1, 0, 0, 1), "expected finite xmin, ymin, xmax, ymax"),
        ("Product.productType", "deepRaster", "/Render/Product.productType: found deepRaster"),
        ("far.sourceName", "motionvector", "/Render/far.sourceName: found 'motionvector', expected color, Ci"),
        ("far.sourceType", "primvar", "/Render/far.sourceType: found primvar"),
        ("Beauty.sourceName", "C<RD>L", "/Render/Beauty.sourceName: found the light path expression 'C<RD>L'"),
        ("tint.sourceName", "Ci", "/Render/tint: found channel R twice in the product"),
        ("tint.dataType", "half", "/Render/tint.dataType: found half, expected 3 numbers a pixel"),
        ("Settings.msbvh:samplesPerPixel", -1, "/Render/Settings.msbvh:samplesPerPixel: found -1, expected an integer"),
    ],
)
def test_what_makes_no_sense_is_named_once(path, value, message):
    stage = stage_of()
    attribute = stage.GetAttributeAtPath(f"/Render/{path}") or stage.GetPrimAtPath(
        f"/Render/{path.partition('.')[0]}"
    ).GetAttribute(path.partition(".")[2])
    attribute.Set(value)
    _, said = spec_of(stage)
    assert len(said) == 1 and message in said[0], said


def test_relationships_to_what_is_not_there_are_named():
    stage = stage_of()
    settings = UsdRender.Settings.Get(stage, SETTINGS)
    settings.GetCameraRel().SetTargets(["/Slope"])
    settings.GetProductsRel().AddTarget("/Nowhere")
    UsdRender.Product.Get(stage, "/Render/Product").GetOrderedVarsRel().AddTarget("/Cam")
    spec, said = spec_of(stage)
    assert said == [
        "/Render/Settings.camera: found no Camera at </Slope>, expected one; ignored",
        "/Render/Product.orderedVars: found no RenderVar at </Cam>, expected one; it is left out",
        "/Render/Settings.products: found no RenderProduct at </Nowhere>, expected one; it is left out",
    ]
    assert spec.base.camera == "" and len(spec.products) == 2 and len(spec.products[0].vars) == 3


def test_values_at_times_are_no_settings_but_for_a_products_name():
    stage = stage_of()
    UsdRender.Settings.Get(stage, SETTINGS).GetPrim().RemoveProperty("resolution")
    UsdRender.Settings.Get(stage, SETTINGS).CreateResolutionAttr().Set(Gf.Vec2i(8, 8), 1.0)
    name = UsdRender.Product.Get(stage, "/Render/Product").GetProductNameAttr()
    name.Clear()
    name.Set("a.exr", 1.0)
    name.Set("b.exr", 2.0)
    spec, said = spec_of(stage)
    assert said == [f"{SETTINGS}.resolution: found values at times, expected one for all times; ignored"]
    assert not spec.base.sets_resolution
    with values.reported_to(Diagnostics()):
        assert read_render_spec(stage.GetPrimAtPath(SETTINGS), Usd.TimeCode(2.0)).products[0].name == "b.exr"


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
        assert image[..., channel].sum() > 100 and np.delete(image[..., :3], channel, axis=2).sum() == 0


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
