"""Colours in the space that is rendered in, whatever they come from, and what a picture says of its own."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import PyOpenColorIO as ocio
import pytest
from material_stage import TYPES, write_image
from msbvh import _core
from msbvh.base.errors import Diagnostics
from msbvh.base.reporter import Reporter
from msbvh.cli.main import main
from msbvh.look.color import CONFIG
from msbvh.render.record import record
from msbvh.render.settings import RecordSettings
from msbvh.scene.reader import ReadSettings, read_frame
from msbvh.stage.rendering_space import LINEAR_REC709, rendered, rendered_in
from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux
from recording import Shot
from test_textured_pictures import GlowingShot

COLOUR = (0.8, 0.3, 0.1)


def by_ocio(colour: object, source: str, target: str) -> np.ndarray:
    config = ocio.Config.CreateFromFile(CONFIG)
    return np.array(config.getProcessor(source, target).getDefaultCPUProcessor().applyRGB(list(colour)))


def constant(shot: GlowingShot, tmp_path: Path) -> None:
    shot.surface.CreateInput("emissiveColor", TYPES.Color3f).Set(Gf.Vec3f(*COLOUR))


def texture(shot: GlowingShot, tmp_path: Path) -> None:
    pixels = np.tile(np.array(COLOUR), (4, 4, 1))
    node = shot.glowing(write_image(tmp_path / "flat.png", pixels))
    node.CreateInput("wrapS", TYPES.Token).Set("black")  # so that it is no constant


def folded(shot: GlowingShot, tmp_path: Path) -> None:
    texture(shot, tmp_path)
    node = shot.stage.GetPrimAtPath("/Look/Texture")
    for wrap in ("wrapS", "wrapT"):
        node.CreateAttribute(f"inputs:{wrap}", TYPES.Token).Set("repeat")


def display_color(shot: GlowingShot, tmp_path: Path) -> None:
    UsdGeom.Gprim(shot.square).CreateDisplayColorAttr([Gf.Vec3f(*COLOUR)])
    shot.reader("displayColor", kind="float3", to="emissiveColor")


def named_primvar(shot: GlowingShot, tmp_path: Path) -> None:
    tint = UsdGeom.PrimvarsAPI(shot.square).CreatePrimvar("tint", TYPES.Color3fArray, "constant")
    tint.Set([Gf.Vec3f(*COLOUR)])
    shot.reader("tint", kind="float3", to="emissiveColor")


SOURCES = [constant, texture, folded, display_color, named_primvar]


@pytest.mark.parametrize("source", SOURCES)
def test_acescg_holds_the_same_colour(source: Callable, tmp_path: Path) -> None:
    shot = GlowingShot()
    source(shot, tmp_path)
    middles = {}
    for space in (LINEAR_REC709, "acescg"):
        result = read_frame(shot.stage, 10.0, ReadSettings(rendering_space=space), diagnostics=Diagnostics())
        picture = _core.Renderer(result.scene, width=8, height=6, spp=4, rendering_space=space).render()
        middles[space] = picture[3, 4, :3]
    expected = by_ocio(middles[LINEAR_REC709], LINEAR_REC709, "ACEScg")
    assert middles["acescg"] == pytest.approx(expected, abs=1e-3)
    assert np.abs(middles["acescg"] - middles[LINEAR_REC709]).max() > 0.05


@pytest.mark.parametrize("space", ["acescg", "lin_ap1_scene", "srgb_rec709_scene", "lin_p3d65_scene", "raw"])
def test_a_constant_says_its_space(space: str) -> None:
    shot = GlowingShot()
    constant(shot, Path())
    shot.surface.GetInput("emissiveColor").GetAttr().SetColorSpace(space)
    (material,) = read_frame(shot.stage, 10.0).scene.materials
    expected = COLOUR if space == "raw" else np.maximum(by_ocio(COLOUR, space, LINEAR_REC709), 0.0)
    assert material["emissive_color"] == pytest.approx(expected, abs=2e-4)


def test_a_prim_above_says_it_unless_the_attribute_does() -> None:
    shot = GlowingShot()
    constant(shot, Path())
    Usd.ColorSpaceAPI.Apply(shot.stage.GetPrimAtPath("/Look")).CreateColorSpaceNameAttr("lin_ap1_scene")
    material = read_frame(shot.stage, 10.0).scene.materials[0]
    assert material["emissive_color"] == pytest.approx(
        np.maximum(by_ocio(COLOUR, "ACEScg", LINEAR_REC709), 0), abs=1e-4
    )
    shot.surface.GetInput("emissiveColor").GetAttr().SetColorSpace(LINEAR_REC709)
    assert read_frame(shot.stage, 10.0).scene.materials[0]["emissive_color"] == pytest.approx(COLOUR, abs=1e-7)


def test_an_unknown_space_is_named_and_counts_as_linear_rec709() -> None:
    shot = GlowingShot()
    constant(shot, Path())
    shot.surface.GetInput("emissiveColor").GetAttr().SetColorSpace("lin_nowhere")
    diagnostics = Diagnostics()
    result = read_frame(shot.stage, 10.0, diagnostics=diagnostics)
    said = [str(each) for each in diagnostics if "lin_nowhere" in str(each)]
    assert len(said) == 1 and said[0].startswith("/Look/Surface.inputs:emissiveColor") and "expected" in said[0]
    assert result.scene.materials[0]["emissive_color"] == pytest.approx(COLOUR)


def test_light_is_converted_with_its_temperature() -> None:
    shot = Shot()
    light = UsdLux.SphereLight.Define(shot.stage, "/Light")
    light.CreateIntensityAttr(2.0)
    light.CreateColorAttr(Gf.Vec3f(*COLOUR)).SetColorSpace("srgb_rec709_scene")
    light.CreateEnableColorTemperatureAttr(True)
    light.CreateColorTemperatureAttr(3000.0)
    (read,) = shot.read(rendering_space="acescg").scene.lights
    warm = by_ocio(UsdLux.BlackbodyTemperatureAsRgb(3000.0), LINEAR_REC709, "ACEScg")
    assert read["radiance"] == pytest.approx(2.0 * by_ocio(COLOUR, "srgb_rec709_scene", "ACEScg") * warm, rel=1e-3)


def test_a_dome_image_is_converted(tmp_path: Path) -> None:
    shot = GlowingShot()
    shot.stage.RemovePrim("/Dark")
    file = write_image(tmp_path / "sky.exr", np.tile(np.array(COLOUR), (4, 8, 1)), oiio.FLOAT)
    dome = UsdLux.DomeLight.Define(shot.stage, "/Sky")
    dome.CreateTextureFileAttr(Sdf.AssetPath(file))
    for said, space in (("", LINEAR_REC709), ("", "acescg"), ("acescg", LINEAR_REC709)):
        if said:
            dome.GetTextureFileAttr().SetColorSpace(said)
        result = read_frame(shot.stage, 10.0, ReadSettings(rendering_space=space))
        corner = _core.Renderer(result.scene, width=8, height=6, spp=4, show_domes=True).render()[0, 0, :3]
        expected = np.maximum(by_ocio(COLOUR, said or LINEAR_REC709, space), 0.0)
        assert corner == pytest.approx(expected, abs=2e-3), (said, space)


def test_what_nothing_is_said_about_is_the_very_same_array() -> None:
    shot = GlowingShot()
    attribute = UsdGeom.Gprim(shot.square).CreateDisplayColorAttr([Gf.Vec3f(*COLOUR)])
    values = np.array([COLOUR], np.float32)
    with rendered_in(LINEAR_REC709):
        assert rendered(values, attribute) is values
    with rendered_in("acescg"):
        assert rendered(values, attribute) is not values


def test_pictures_say_their_space_and_look_alike(tmp_path: Path) -> None:
    shot = GlowingShot()
    constant(shot, tmp_path)
    scene = tmp_path / "shot.usda"
    shot.stage.Export(str(scene))
    shown = {}
    for space in (LINEAR_REC709, "acescg"):
        exr, png = tmp_path / f"{space}.exr", tmp_path / f"{space}.png"
        arguments = ["record", str(scene), str(exr), str(png), "-w", "16", "--spp", "4", "--exr-float"]
        assert main([*arguments, "--rendering-space", space]) == 0
        spec = oiio.ImageInput.open(str(exr)).spec()
        shown[space] = (
            oiio.ImageBuf(str(png)).get_pixels(oiio.FLOAT),
            spec.getattribute("chromaticities"),
            spec.get_string_attribute("oiio:ColorSpace"),
        )
    ours, aces = shown[LINEAR_REC709], shown["acescg"]
    assert np.abs(ours[0] - aces[0]).max() <= 1.001 / 255 and ours[0][..., :3].max() > 0.5
    assert aces[1] == pytest.approx((0.713, 0.293, 0.165, 0.830, 0.128, 0.044, 0.32168, 0.33767))
    assert ours[1][0] == pytest.approx(0.64) and (ours[2], aces[2]) == (LINEAR_REC709, "lin_ap1_scene")


def test_what_is_read_decides_the_space_of_the_picture(tmp_path: Path) -> None:
    shot = GlowingShot()
    constant(shot, tmp_path)
    scene, exr = tmp_path / "shot.usda", tmp_path / "out.exr"
    shot.stage.Export(str(scene))
    record(str(scene), [str(exr)], RecordSettings(read=ReadSettings(width=16, rendering_space="acescg")), Reporter())
    assert oiio.ImageInput.open(str(exr)).spec().get_string_attribute("oiio:ColorSpace") == "lin_ap1_scene"


def test_render_settings_ask_for_a_space_unless_an_option_does(tmp_path: Path) -> None:
    shot = GlowingShot()
    constant(shot, tmp_path)
    scene = tmp_path / "shot.usda"
    prim = shot.stage.DefinePrim("/Render/Settings", "RenderSettings")
    prim.CreateAttribute("renderingColorSpace", TYPES.Token).Set("lin_ap1_scene")
    shot.stage.SetMetadata("renderSettingsPrimPath", "/Render/Settings")
    shot.stage.Export(str(scene))
    for options, expected in (([], "lin_ap1_scene"), (["--rendering-space", LINEAR_REC709], LINEAR_REC709)):
        exr = tmp_path / "out.exr"
        assert main(["record", str(scene), str(exr), "-w", "16", "--spp", "1", *options]) == 0
        assert oiio.ImageInput.open(str(exr)).spec().get_string_attribute("oiio:ColorSpace") == expected
