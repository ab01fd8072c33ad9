"""Textures whose texels are all alike are constants, so that nothing is called for that a texture needs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from material_stage import TYPES, write_image
from msbvh import _core
from msbvh.base.errors import Diagnostics
from msbvh.scene.reader import read_frame
from pxr import Gf, UsdShade
from test_textured_pictures import GlowingShot

FLAT = np.tile(np.array((0.8, 0.4, 0.2, 0.5)), (8, 8, 1))


def with_texture(
    pixels: np.ndarray, path: Path, wrap: str = "repeat", kind: object = oiio.UINT8, **to: str
) -> GlowingShot:
    shot = GlowingShot()
    texture = shot.glowing(write_image(path, pixels, kind), **to)
    for name in ("wrapS", "wrapT"):
        texture.CreateInput(name, TYPES.Token).Set(wrap)
    return shot


def read(shot: GlowingShot) -> tuple[dict, object]:
    result = read_frame(shot.stage, 10.0, diagnostics=Diagnostics())
    (material,) = result.scene.materials
    return material, result


def effects(result: object) -> set[str]:
    return {effect for effect, _, _ in _core.Renderer(result.scene, width=8, height=6, spp=1).plan}


@pytest.mark.parametrize("space", ["raw", "sRGB"])
def test_one_that_is_the_same_everywhere_is_a_constant(space: str, tmp_path: Path) -> None:
    shot = with_texture(FLAT, tmp_path / "flat.png")
    node = UsdShade.Shader(shot.stage.GetPrimAtPath("/Look/Texture"))
    node.CreateInput("sourceColorSpace", TYPES.Token).Set(space)
    node.CreateInput("scale", TYPES.Float4).Set(Gf.Vec4f(2, 2, 2, 1))
    node.CreateInput("bias", TYPES.Float4).Set(Gf.Vec4f(0.25, 0, 0, 0))
    material, result = read(shot)
    folded = shot.at(shot.picture(), 0.5, 0.5)
    assert not material["driven"] and not material["texture_reads"] and not result.scene.textures
    assert not result.scene.primvars[0][1], "the coordinates are still read"
    assert "textures" not in effects(result)
    node.GetInput("wrapS").Set("black")  # beyond the square it is another then
    material, result = read(shot)
    assert material["driven"] and "textures" in effects(result)
    assert folded[:3] == pytest.approx(shot.at(shot.picture(), 0.5, 0.5)[:3], rel=1e-3)


def test_coordinates_that_normals_are_bent_along_stay(tmp_path: Path) -> None:
    shot = with_texture(FLAT, tmp_path / "flat.png")
    shot.surface.CreateInput("normal", TYPES.Normal3f).Set(Gf.Vec3f(0.1, 0, 1))
    material, result = read(shot)
    assert not material["driven"] and not result.scene.textures
    assert any(values for _, values in result.scene.primvars)


def test_a_channel_is_a_number(tmp_path: Path) -> None:
    shot = with_texture(FLAT, tmp_path / "flat.tif", kind=oiio.FLOAT, to="roughness", output="g")
    material, _ = read(shot)
    assert material["roughness"] == pytest.approx(0.4) and not material["driven"]


def test_a_presence_of_nothing_does_not_shine(tmp_path: Path) -> None:
    pixels = FLAT * (1, 1, 1, 0)
    shot = with_texture(pixels, tmp_path / "flat.png", to="opacity", output="a")
    shot.surface.CreateInput("opacityMode", TYPES.Token).Set("presence")
    material, result = read(shot)
    assert material["opacity"] == 0.0 and not material["specular"] and "specular" not in effects(result)


@pytest.mark.parametrize("place", [(0, 7), (7, 7), (3, 0)])
@pytest.mark.parametrize("tile", [0, 16])
def test_one_texel_makes_the_difference(place: tuple[int, int], tile: int, tmp_path: Path) -> None:
    pixels = np.tile(FLAT, (8, 8, 1)).astype(np.float32)
    pixels[tuple(8 * i + 7 for i in place)] += 0.25
    path = tmp_path / "almost.tif"
    spec = oiio.ImageSpec(64, 64, 4, oiio.FLOAT)
    spec.tile_width = spec.tile_height = tile
    output = oiio.ImageOutput.create(str(path))
    assert output.open(str(path), spec) and output.write_image(pixels) and output.close()
    shot = GlowingShot()
    texture = shot.glowing(str(path))
    for name in ("wrapS", "wrapT"):
        texture.CreateInput(name, TYPES.Token).Set("clamp")
    assert read(shot)[0]["driven"]
    pixels[:] = pixels[0, 0]
    assert output.open(str(tmp_path / "flat.tif"), spec) and output.write_image(pixels) and output.close()
    texture.GetInput("file").Set(str(tmp_path / "flat.tif"))
    assert not read(shot)[0]["driven"]


def test_what_is_not_finite_and_normals_stay_textures(tmp_path: Path) -> None:
    assert read(with_texture(FLAT * np.nan, tmp_path / "nan.tif", kind=oiio.FLOAT))[0]["driven"]
    up = np.tile(np.array((0.5, 0.5, 1.0)), (8, 8, 1))
    assert read(with_texture(up, tmp_path / "up.png", to="normal"))[0]["driven"]


def test_a_texture_of_two_inputs_is_kept_for_the_other(tmp_path: Path) -> None:
    shot = with_texture(FLAT, tmp_path / "flat.png")
    other = shot.texture(write_image(tmp_path / "other.png", np.random.default_rng(1).random((4, 4, 3))), "Other")
    shot.connect(other, "st", shot.reader("uv"))
    shot.connect(shot.surface, "metallic", other, "b")
    material, result = read(shot)
    assert set(material["driven"]) == {"diffuse_color", "metallic"}
    (texture,) = result.scene.textures
    assert texture["name"].endswith("other.png") and material["texture_reads"][0]["coordinates"] == "uv"
