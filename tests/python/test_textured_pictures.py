"""What textures and primvars look like: pictures of a square that glows in what its material reads, against the texels."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from material_stage import TYPES, LookShot, write_image
from msbvh import _core
from msbvh.base.errors import Diagnostics
from msbvh.cli.main import main
from msbvh.scene.reader import read_frame
from pxr import Gf, UsdGeom, UsdLux, UsdShade

RED, GREEN, BLUE, GREY = (1, 0, 0), (0, 1, 0), (0, 0, 1), (0.5, 0.5, 0.5)
SIZE = 4.0


class GlowingShot(LookShot):
    """A square of 4 x 4 units that fills most of the picture; nothing but itself gives light."""

    def __init__(self) -> None:
        super().__init__(shutter=(0.0, 0.0))
        h = SIZE / 2
        self.square = self.mesh("/Square", ((-h, -h, 0), (h, -h, 0), (h, h, 0), (-h, h, 0)))
        st = UsdGeom.PrimvarsAPI(self.square).CreatePrimvar("st", TYPES.TexCoord2fArray, "varying")
        st.Set([Gf.Vec2f(0, 0), Gf.Vec2f(1, 0), Gf.Vec2f(1, 1), Gf.Vec2f(0, 1)])
        self.surface.CreateInput("diffuseColor", TYPES.Color3f).Set(Gf.Vec3f(0))
        UsdLux.DistantLight.Define(self.stage, "/Dark").CreateIntensityAttr(0.0)  # no camera light
        self.bind(self.square)

    def glowing(self, file: str, to: str = "emissiveColor", output: str = "rgb") -> UsdShade.Shader:
        texture = self.texture(file, to=to, output=output)
        self.connect(texture, "st", self.reader("st"))
        return texture

    def picture(self, **settings: object) -> np.ndarray:
        """float32[60, 80, 4]."""
        result = read_frame(self.stage, 10.0, diagnostics=Diagnostics())
        return _core.Renderer(result.scene, width=80, height=60, spp=16, max_bounces=0, **settings).render()

    def at(self, picture: np.ndarray, s: float, t: float) -> np.ndarray:
        """The pixel at texture coordinates of the square."""
        height, width = picture.shape[:2]
        pixel = 20.0 * 20.955 / 50.0 / width  # units, at the square's distance
        x, y = (s - 0.5) * SIZE / pixel, (t - 0.5) * SIZE / pixel
        return picture[int(height / 2 - y), int(width / 2 + x)]


def quarters(path: Path) -> str:
    """Seen with s to the right and t upwards: red at the lower left, green right of it, blue above, grey opposite."""
    pixels = np.empty((64, 64, 3))
    pixels[32:, :32], pixels[32:, 32:], pixels[:32, :32], pixels[:32, 32:] = RED, GREEN, BLUE, GREY
    return write_image(path, pixels)


def test_texels_stand_where_their_coordinates_say(tmp_path: Path) -> None:
    shot = GlowingShot()
    shot.glowing(quarters(tmp_path / "quarters.png")).CreateInput("sourceColorSpace", TYPES.Token).Set("raw")
    picture = shot.picture()
    for (s, t), colour in {(0.25, 0.25): RED, (0.75, 0.25): GREEN, (0.25, 0.75): BLUE, (0.75, 0.75): GREY}.items():
        assert shot.at(picture, s, t)[:3] == pytest.approx(colour, abs=0.005), (s, t)
    assert picture[0, 0].tolist() == [0, 0, 0, 0]


@pytest.mark.parametrize(("space", "expected"), [("raw", 0.5), ("sRGB", 0.2140), ("auto", 0.2140)])
def test_colours_are_linear(tmp_path: Path, space: str, expected: float) -> None:
    shot = GlowingShot()
    file = write_image(tmp_path / "grey.png", np.full((8, 8, 3), 0.5))
    shot.glowing(file).CreateInput("sourceColorSpace", TYPES.Token).Set(space)
    assert shot.at(shot.picture(), 0.5, 0.5)[:3] == pytest.approx((expected,) * 3, abs=0.003)


def test_scale_bias_and_a_channel(tmp_path: Path) -> None:
    shot = GlowingShot()
    pixels = np.zeros((8, 8, 4))
    pixels[:] = (0.25, 0.5, 0.75, 1.0)
    texture = shot.glowing(write_image(tmp_path / "four.tif", pixels, "float"), output="g")
    texture.CreateInput("sourceColorSpace", TYPES.Token).Set("raw")
    texture.CreateInput("scale", TYPES.Float4).Set(Gf.Vec4f(3))
    texture.CreateInput("bias", TYPES.Float4).Set(Gf.Vec4f(-0.25))
    assert shot.at(shot.picture(), 0.5, 0.5)[:3] == pytest.approx((1.25,) * 3, abs=1e-3)


def test_coordinates_are_transformed(tmp_path: Path) -> None:
    shot = GlowingShot()
    texture = shot.texture(quarters(tmp_path / "quarters.png"), to="emissiveColor")
    texture.CreateInput("sourceColorSpace", TYPES.Token).Set("raw")
    for wrap in ("wrapS", "wrapT"):
        texture.CreateInput(wrap, TYPES.Token).Set("repeat")
    turn = shot.node("Turn", "UsdTransform2d")
    turn.CreateInput("rotation", TYPES.Float).Set(90.0)
    shot.connect(turn, "in", shot.reader("st"))
    shot.connect(texture, "st", turn)
    picture = shot.picture()
    # (s, t) is read at (-t, s): what is at the lower left is from the lower right.
    assert shot.at(picture, 0.25, 0.25)[:3] == pytest.approx(GREEN, abs=0.005)
    assert shot.at(picture, 0.25, 0.75)[:3] == pytest.approx(RED, abs=0.005)


@pytest.mark.parametrize("threshold", [0.0, 0.5])
def test_opacity_by_a_texture_is_coverage(tmp_path: Path, threshold: float) -> None:
    shot = GlowingShot()
    pixels = np.full((64, 64, 1), 0.25)
    pixels[:, 32:] = 0.75
    shot.glowing(write_image(tmp_path / "mask.tif", pixels, "float"), to="opacity", output="r")
    shot.surface.CreateInput("emissiveColor", TYPES.Color3f).Set(Gf.Vec3f(1))
    shot.surface.CreateInput("opacityThreshold", TYPES.Float).Set(threshold)
    mode = shot.surface.CreateInput("opacityMode", TYPES.Token)
    mode.Set("presence")
    picture = shot.picture()
    left, right = (0.25, 0.75) if threshold == 0.0 else (0.0, 1.0)
    assert picture[20:40, 25:38, 3].mean() == pytest.approx(left, abs=0.02)
    assert picture[20:40, 42:55, 3].mean() == pytest.approx(right, abs=0.02)
    assert picture[..., :3] == pytest.approx(np.repeat(picture[..., 3:], 3, axis=2), abs=1e-5)
    if threshold == 0.0:
        mode.Set("transparent")
        picture = shot.picture()
        # What it reflects covers as well, and what it gives off is whole.
        assert picture[20:40, 25:38, 3].mean() == pytest.approx(left + (1 - left) * 0.04, abs=0.02)
        assert picture[20:40, 25:38, :3].mean() == pytest.approx(1.0, abs=0.05)


def test_far_away_a_texture_is_its_mean(tmp_path: Path) -> None:
    shot = GlowingShot()
    board = np.indices((256, 256)).sum(axis=0) % 2
    texture = shot.glowing(write_image(tmp_path / "board.png", np.repeat(board[..., None], 3, axis=2)))
    texture.CreateInput("sourceColorSpace", TYPES.Token).Set("sRGB")
    picture = shot.picture()
    board_seen = picture[20:40, 25:55, 0]  # six texels a pixel
    assert board_seen.mean() == pytest.approx(0.5, abs=0.005)  # of light, not of numbers
    assert board_seen.std() < 0.03  # without a filter: 0.5 over the root of 16 samples


def test_a_primvar_drives_an_input_by_corner(tmp_path: Path) -> None:
    shot = GlowingShot()
    tint = UsdGeom.PrimvarsAPI(shot.square).CreatePrimvar("tint", TYPES.Color3fArray, "faceVarying")
    tint.Set([Gf.Vec3f(0), Gf.Vec3f(1, 0, 0), Gf.Vec3f(1, 1, 0), Gf.Vec3f(0, 1, 0)])
    shot.reader("tint", kind="float3", to="emissiveColor")
    assert shot.at(shot.picture(), 0.3, 0.6)[:3] == pytest.approx((0.3, 0.6, 0.0), abs=0.03)


def test_a_corrupt_file_is_named_once_and_its_fallback_drawn(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shot = GlowingShot()
    file = tmp_path / "broken.png"
    file.write_bytes(b"\x89PNG\r\n\x1a\n" + b"nothing of a picture" * 10)
    shot.glowing(str(file)).CreateInput("fallback", TYPES.Float4).Set(Gf.Vec4f(0.5, 0.25, 0.125, 1))
    assert shot.at(shot.picture(), 0.5, 0.5)[:3] == pytest.approx((0.5, 0.25, 0.125), abs=1e-3)
    scene = tmp_path / "shot.usda"
    shot.stage.Export(str(scene))
    arguments = ["record", str(scene), str(tmp_path / "out.exr"), "-w", "32", "--spp", "4"]
    assert main(arguments) == 0
    said = [line for line in capsys.readouterr().err.splitlines() if "broken.png" in line and "warning" in line]
    assert len(said) == 1 and "drawn as its fallback" in said[0]
    assert main([*arguments, "--strict"]) == 3


def test_light_by_its_way_adds_up_where_surfaces_shine(tmp_path: Path) -> None:
    shot = GlowingShot()
    shot.surface.CreateInput("metallic", TYPES.Float).Set(0.3)
    shot.surface.CreateInput("emissiveColor", TYPES.Color3f).Set(Gf.Vec3f(0.125, 0, 0))
    shot.stage.GetPrimAtPath("/Look/Surface").GetAttribute("inputs:diffuseColor").Set(Gf.Vec3f(0.2, 0.5, 0.7))
    sphere = UsdLux.SphereLight.Define(shot.stage, "/Lamp")
    sphere.AddTranslateOp().Set(Gf.Vec3d(1, 2, 5))
    sphere.CreateIntensityAttr(30.0)
    UsdLux.LightAPI(sphere.GetPrim()).CreateSpecularAttr(2.0)
    UsdLux.DomeLight.Define(shot.stage, "/Dome").CreateIntensityAttr(0.5)
    ways = ("directDiffuse", "directSpecular", "indirectDiffuse", "indirectSpecular", "emission")
    result = read_frame(shot.stage, 10.0, diagnostics=Diagnostics())
    renderer = _core.Renderer(result.scene, width=40, height=30, spp=64, max_bounces=1, aovs=ways)
    picture, parts = renderer.render_with_aovs()
    assert sum(parts[way] for way in ways) == pytest.approx(picture[..., :3], abs=1e-4)
    middle = (slice(12, 18), slice(16, 24))
    assert (parts["directSpecular"][middle] > 0.005).all() and (parts["directDiffuse"][middle] > 0.005).all()
    shot.stage.GetPrimAtPath("/Look/Surface").GetAttribute("inputs:metallic").Set(1.0)
    result = read_frame(shot.stage, 10.0, diagnostics=Diagnostics())
    metal = _core.Renderer(result.scene, width=40, height=30, spp=16, max_bounces=1, aovs=ways).render_with_aovs()[1]
    assert not metal["directDiffuse"].any() and not metal["indirectDiffuse"].any() and metal["directSpecular"].any()


def test_a_file_that_is_not_there_is_named_with_its_prim(tmp_path: Path) -> None:
    shot = GlowingShot()
    shot.glowing(str(tmp_path / "none.png"))
    diagnostics = Diagnostics()
    read_frame(shot.stage, 10.0, diagnostics=diagnostics)
    said = [str(d) for d in diagnostics if "none.png" in str(d)]
    assert len(said) == 1 and said[0].startswith("/Look/Surface.inputs:emissiveColor") and "cannot be found" in said[0]


def test_textures_are_filtered_over_so_many_footprints(tmp_path: Path) -> None:
    shot = GlowingShot()
    pixels = np.random.default_rng(1).random((64, 64, 1)).repeat(3, axis=2)
    shot.glowing(write_image(tmp_path / "grain.tif", pixels, "float")).CreateInput("sourceColorSpace", TYPES.Token).Set(
        "raw"
    )
    inside = np.s_[20:40, 30:50, 0]
    plain, one, wide = (shot.picture(**rate) for rate in ({}, {"texture_rate": 1.0}, {"texture_rate": 16.0}))
    np.testing.assert_array_equal(plain, one)
    assert wide[inside].mean() == pytest.approx(plain[inside].mean(), abs=0.03)
    assert wide[inside].std() < 0.4 * plain[inside].std()
