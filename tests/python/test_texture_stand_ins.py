"""What is drawn in place of a texture, which is not evaluated yet: its mean, its fallback, or the input's
default."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from pxr import Gf, Sdf, UsdShade, UsdUtils
from recording import Shot, messages

NOT_EVALUATED = "connected to a UsdUVTexture, which is not evaluated yet; "


def write(path: Path, pixels: np.ndarray, kind: object = oiio.UINT8) -> str:
    """float[H, W, C] in [0, 1]."""
    height, width, channels = pixels.shape
    output = oiio.ImageOutput.create(str(path))
    spec = oiio.ImageSpec(width, height, channels, kind)
    spec.attribute("oiio:UnassociatedAlpha", 1)
    assert output.open(str(path), spec) and output.write_image(pixels.astype(np.float32)) and output.close()
    return str(path)


def linear(encoded: float) -> float:
    return encoded / 12.92 if encoded <= 0.04045 else ((encoded + 0.055) / 1.055) ** 2.4


class Textured(Shot):
    """A mesh whose surface reads a texture."""

    def __init__(self, file: str | None, **inputs: object) -> None:
        super().__init__()
        material = UsdShade.Material.Define(self.stage, "/Material")
        self.surface = UsdShade.Shader.Define(self.stage, "/Material/Surface")
        self.surface.CreateIdAttr("UsdPreviewSurface")
        material.CreateSurfaceOutput().ConnectToSource(self.surface.ConnectableAPI(), "surface")
        self.texture = UsdShade.Shader.Define(self.stage, "/Material/Texture")
        self.texture.CreateIdAttr("UsdUVTexture")
        if file is not None:
            self.texture.CreateInput("file", Sdf.ValueTypeNames.Asset).Set(Sdf.AssetPath(file))
        for name, value in inputs.items():
            kind = Sdf.ValueTypeNames.Token if isinstance(value, str) else Sdf.ValueTypeNames.Float4
            self.texture.CreateInput(name, kind).Set(value)
        UsdShade.MaterialBindingAPI.Apply(self.mesh("/Mesh").GetPrim()).Bind(material)

    def connect(self, name: str, output: str = "rgb") -> Textured:
        colour = name.endswith("Color")
        kind = Sdf.ValueTypeNames.Color3f if colour else Sdf.ValueTypeNames.Float
        wide = Sdf.ValueTypeNames.Float3 if output == "rgb" else Sdf.ValueTypeNames.Float
        self.surface.CreateInput(name, kind).ConnectToSource(self.texture.CreateOutput(output, wide))
        return self

    def material(self) -> tuple[dict, list[str]]:
        result = self.read()
        return result.scene.materials[0], messages(result, "warning")


HALVES = np.zeros((4, 8, 3))
HALVES[:, 4:] = (1.0, 0.6, 0.2)
"""Black and orange: the mean of linear values is not that of encoded ones."""


@pytest.mark.parametrize(("space", "encoded"), [(None, True), ("auto", True), ("sRGB", True), ("raw", False)])
def test_the_mean_is_taken_of_linear_values(tmp_path: Path, space: str | None, encoded: bool) -> None:
    inputs = {"sourceColorSpace": space} if space else {}
    file = write(tmp_path / "a.png", HALVES)
    material, warnings = Textured(file, fallback=Gf.Vec4f(0, 0, 0, 1), **inputs).connect("diffuseColor").material()
    expected = [(linear(x) if encoded else x) / 2 for x in (1.0, 0.6, 0.2)]
    assert material["diffuse_color"] == pytest.approx(expected, abs=1e-6)
    assert warnings == [f"/Material/Surface.inputs:diffuseColor: {NOT_EVALUATED}drawn as the mean of its texture"]


@pytest.mark.parametrize(
    ("name", "kind", "encoded"),
    [("a.png", oiio.UINT16, False), ("a.exr", oiio.HALF, False), ("a.jpg", oiio.UINT8, True)],
)
def test_auto_takes_eight_bits_alone_for_srgb(tmp_path: Path, name: str, kind: object, encoded: bool) -> None:
    file = write(tmp_path / name, np.full((16, 16, 3), 0.5), kind)
    material, _ = Textured(file).connect("diffuseColor").material()
    assert material["diffuse_color"] == pytest.approx([linear(0.5) if encoded else 0.5] * 3, abs=5e-3)


def test_outputs_scale_and_bias_grey_and_alpha(tmp_path: Path) -> None:
    pixels = np.full((4, 4, 4), (0.2, 0.4, 0.6, 0.25))
    file = write(tmp_path / "a.png", pixels)
    shot = Textured(file, sourceColorSpace="raw", scale=Gf.Vec4f(2, 1, 1, 2), bias=Gf.Vec4f(0, 0.1, 0, 0.25))
    material, _ = shot.connect("diffuseColor").connect("emissiveColor", "g").connect("opacity", "a").material()
    assert material["diffuse_color"] == pytest.approx([0.4, 0.5, 0.6], abs=0.01)
    assert material["emissive_color"] == pytest.approx([0.5] * 3, abs=0.01)
    assert material["opacity"] == pytest.approx(0.75, abs=0.01)
    grey = write(tmp_path / "grey.png", np.full((4, 4, 1), 0.5))
    material, _ = Textured(grey).connect("diffuseColor").connect("opacity", "r").material()
    assert material["diffuse_color"] == pytest.approx([0.5] * 3, abs=0.01)  # One channel: no sRGB.
    assert material["opacity"] == pytest.approx(0.5, abs=0.01)


def test_a_cutout_becomes_its_mean_not_nothing(tmp_path: Path) -> None:
    pixels = np.ones((4, 4, 4))
    pixels[:, 1:, 3] = 0.0
    shot = Textured(write(tmp_path / "a.png", pixels)).connect("opacity", "a")
    shot.surface.CreateInput("opacityThreshold", Sdf.ValueTypeNames.Float).Set(0.5)
    material, _ = shot.material()
    assert (material["opacity"], material["opacity_threshold"]) == (pytest.approx(0.25), 0.0)


def test_a_file_that_cannot_be_read_leaves_the_fallback_if_it_is_authored(tmp_path: Path) -> None:
    (tmp_path / "broken.png").write_bytes(b"\x89PNG\r\n\x1a\nnothing")
    for file, found in (
        (str(tmp_path / "broken.png"), "broken.png"),
        ("missing.jpg", "missing.jpg"),
        ("", "no file"),
    ):
        authored = Textured(file, fallback=Gf.Vec4f(0, 0, 1, 0.5)).connect("diffuseColor").connect("opacity", "a")
        material, warnings = authored.material()
        assert material["diffuse_color"] == (0, 0, 1) and material["opacity"] == 0.5
        assert any(found in w and w.endswith("drawn as its fallback, (0, 0, 1)") for w in warnings), warnings
        bare = Textured(file).connect("diffuseColor").connect("opacity", "a").connect("emissiveColor")
        material, warnings = bare.material()
        assert material["diffuse_color"] == pytest.approx((0.18, 0.18, 0.18))
        assert material["opacity"] == 1.0 and material["emissive_color"] == (0, 0, 0)
        assert any(found in w and w.endswith("has no fallback: drawn as (0.18, 0.18, 0.18)") for w in warnings), (
            warnings
        )


def test_textures_inside_a_package_and_in_tiles(tmp_path: Path) -> None:
    for tile, value in ((1001, 0.2), (1002, 0.8)):
        write(tmp_path / f"t.{tile}.png", np.full((4, 4, 3), value))
    shot = Textured(str(tmp_path / "t.<UDIM>.png"), sourceColorSpace="raw")
    material, _ = shot.connect("diffuseColor").material()
    assert material["diffuse_color"] == pytest.approx([0.5] * 3, abs=0.01)
    packed = Textured("t.1002.png", sourceColorSpace="raw").connect("diffuseColor")
    packed.stage.Export(str(tmp_path / "s.usda"))
    assert UsdUtils.CreateNewUsdzPackage(str(tmp_path / "s.usda"), str(tmp_path / "s.usdz"))
    assert "t.1002.png" in " ".join(zipfile.ZipFile(tmp_path / "s.usdz").namelist())
    packed.stage = type(packed.stage).Open(str(tmp_path / "s.usdz"))
    material, warnings = packed.material()
    assert material["diffuse_color"] == pytest.approx([0.8] * 3, abs=0.01), warnings


def test_values_that_are_no_colours_do_not_count(tmp_path: Path) -> None:
    pixels = np.full((8, 8, 3), 0.5)
    pixels[0, 0] = np.nan
    pixels[1, 1] = np.inf
    file = write(tmp_path / "a.exr", pixels, oiio.FLOAT)
    material, _ = Textured(file).connect("diffuseColor").material()
    assert material["diffuse_color"] == pytest.approx([0.5] * 3)
    file = write(tmp_path / "b.exr", np.full((8, 8, 3), np.nan), oiio.FLOAT)
    material, warnings = Textured(file).connect("diffuseColor").material()
    assert material["diffuse_color"] == pytest.approx((0.18, 0.18, 0.18)) and "b.exr" in warnings[0]


def test_many_materials_make_one_line(tmp_path: Path) -> None:
    file = write(tmp_path / "a.png", HALVES)
    shot = Textured(file).connect("diffuseColor")
    for index in range(3):
        other = shot.mesh(f"/Other_{index}").GetPrim()
        copied = Sdf.Path(f"/Material_{index}")
        Sdf.CopySpec(shot.stage.GetRootLayer(), "/Material", shot.stage.GetRootLayer(), copied)
        surface = UsdShade.Shader(shot.stage.GetPrimAtPath(copied.AppendChild("Surface")))
        surface.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).SetConnectedSources(
            [UsdShade.ConnectionSourceInfo(shot.texture.GetOutput("rgb"))]
        )
        material = UsdShade.Material(shot.stage.GetPrimAtPath(copied))
        material.GetSurfaceOutput().ConnectToSource(surface.ConnectableAPI(), "surface")
        UsdShade.MaterialBindingAPI.Apply(other).Bind(material)
    (warning,) = messages(shot.read(), "warning")
    assert warning.endswith("drawn as the mean of its texture (and 3 more prims)")
