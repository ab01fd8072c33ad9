"""What is transparent, bends light or is hair, as stages say it; and both sides of surfaces."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from material_stage import TYPES, LookShot, add_primvar
from msbvh import _core
from msbvh.base.errors import Diagnostics
from msbvh.cli.main import main
from msbvh.scene.reader import ReadResult, ReadSettings, read_frame
from pxr import Gf, UsdGeom, UsdLux
from recording import Shot
from round_stages import curves


def picture(shot: Shot, samples: int = 16, bounces: int = 2, refraction: bool = False) -> np.ndarray:
    """float32[36, 48, 4]."""
    result = read_frame(shot.stage, 10.0, ReadSettings(width=48), Diagnostics())
    renderer = _core.Renderer(
        result.scene, width=48, height=36, spp=samples, max_bounces=bounces, refraction=refraction, show_domes=False
    )
    return renderer.render()


class Ball(LookShot):
    """A ball of a material in a white furnace that is not shown."""

    def __init__(self, **inputs: float | str) -> None:
        super().__init__(shutter=(0.0, 0.0))
        ball = UsdGeom.Sphere.Define(self.stage, "/Ball")
        ball.CreateRadiusAttr(2.0)
        UsdLux.DomeLight.Define(self.stage, "/Dome")
        for name, value in inputs.items():
            self.surface.CreateInput(name, TYPES.Token if isinstance(value, str) else TYPES.Float).Set(value)
        self.bind(ball)


def test_reflections_remain_where_a_surface_is_transparent_and_not_where_it_is_a_presence() -> None:
    glass = picture(Ball(opacity=0.0, roughness=0.0))
    assert 0.01 < glass[18, 24, 3] < 0.3 and glass[..., 0].sum() > 1
    assert not picture(Ball(opacity=0.0, roughness=0.0, opacityMode="presence")).any()
    assert not picture(Ball(opacity=0.0, roughness=0.0, opacityThreshold=0.1)).any()


def test_refraction_is_an_option_and_a_setting(tmp_path: Path) -> None:
    shot = Ball(opacity=0.0, roughness=0.0)
    UsdGeom.Cube.Define(shot.stage, "/Behind").AddTranslateOp().Set(Gf.Vec3d(2, 0, -8))
    assert picture(shot, refraction=True)[18, 24, 3] == 1.0
    scene, image = tmp_path / "scene.usda", tmp_path / "out.exr"

    def alpha(*options: str) -> float:
        shot.stage.Export(str(scene))
        given = ("--imageWidth", "48", "--spp", "16", "--frames", "10", *options)
        assert main(["record", str(scene), str(image), *given]) == 0
        pixels = oiio.ImageBuf(str(image)).get_pixels(oiio.FLOAT)
        return float(pixels[pixels.shape[0] // 2, 24, 3])

    assert alpha() < 0.3
    assert alpha("--refraction") == 1.0
    settings = shot.stage.DefinePrim("/Render/Settings", "RenderSettings")
    settings.CreateAttribute("msbvh:refraction", TYPES.Bool).Set(True)
    assert alpha("--renderSettingsPrimPath", "/Render/Settings") == 1.0


def asked(result: ReadResult, refraction: bool = False) -> Mapping[str, list[tuple[str, str]]]:
    return {row["effect"]: row["asked_by"] for row in _core.effects(result.scene, refraction=refraction)["effects"]}


def test_the_plan_says_what_bends_light() -> None:
    result = read_frame(Ball(opacity=0.25, ior=1.25).stage, 10.0, diagnostics=Diagnostics())
    assert not asked(result)["refraction"]
    assert asked(result, refraction=True)["refraction"] == [("/Ball", "ior 1.25 of /Look")]


@pytest.mark.parametrize("kind, value", [("Int", 1), ("Float", 1.0), ("FloatArray", [1.0])])
def test_curves_are_hair_by_a_primvar_of_their_own_or_inherited(kind: str, value: object) -> None:
    shot = Shot(shutter=(0.0, 0.0))
    strand = curves(shot, "/Groom/Strand")
    result = read_frame(shot.stage, 10.0, diagnostics=Diagnostics())
    assert not asked(result)["fibre"]
    add_primvar(shot.stage.GetPrimAtPath("/Groom"), "msbvh:fibre", getattr(TYPES, kind), "constant", value)
    inherited = read_frame(shot.stage, 10.0, diagnostics=Diagnostics())
    assert [prim for prim, _ in asked(inherited)["fibre"]] == ["/Groom/Strand"]
    add_primvar(strand, "msbvh:fibre", TYPES.Int, "constant", 0)
    assert not asked(read_frame(shot.stage, 10.0, diagnostics=Diagnostics()))["fibre"]


def test_what_is_no_hair_is_named() -> None:
    shot = Shot(shutter=(0.0, 0.0))
    strand = curves(shot)
    add_primvar(strand, "msbvh:fibre", TYPES.Float, "constant", 0.5)
    said = read_frame(shot.stage, 10.0, diagnostics=Diagnostics()).diagnostics
    assert any("msbvh:fibre" in str(each) and "expected constant, 0 or 1" in str(each) for each in said)
    add_primvar(strand, "msbvh:fibre", TYPES.Float, "constant", 1.0)
    strand.CreateNormalsAttr([Gf.Vec3f(0, 0, 1)] * len(strand.GetPointsAttr().Get()))
    strand.SetNormalsInterpolation("vertex")
    result = read_frame(shot.stage, 10.0, diagnostics=Diagnostics())
    assert not asked(result)["fibre"]
    assert any("curves with normals are flat ribbons" in str(each) for each in result.diagnostics)


def test_a_constant_normal_is_bent_along_st() -> None:
    shot = LookShot(shutter=(0.0, 0.0))
    square = shot.mesh("/Square", ((-2, -2, 0), (2, -2, 0), (2, 2, 0), (-2, 2, 0)))
    shot.bind(square)
    shot.surface.CreateInput("roughness", TYPES.Float).Set(1.0)
    sun = UsdLux.DistantLight.Define(shot.stage, "/Sun")
    sun.CreateAngleAttr(0.0)
    sun.AddRotateYOp().Set(60.0)
    plain = picture(shot, bounces=0)[18, 24, 0]
    shot.surface.CreateInput("normal", TYPES.Normal3f).Set(Gf.Vec3f(0.866, 0, 0.5))
    assert picture(shot, bounces=0)[18, 24, 0] == plain  # no st
    st = [Gf.Vec2f(0, 0), Gf.Vec2f(1, 0), Gf.Vec2f(1, 1), Gf.Vec2f(0, 1)]
    add_primvar(square, "st", TYPES.TexCoord2fArray, "varying", st)
    assert picture(shot, bounces=0)[18, 24, 0] > 1.6 * plain


def test_surfaces_are_drawn_from_both_sides_whatever_double_sided_says() -> None:
    def seen(double_sided: bool | None, turned: bool) -> np.ndarray:
        shot = Shot(shutter=(0.0, 0.0))
        square = shot.mesh("/Square", ((-2, -2, 0), (2, -2, 0), (2, 2, 0), (-2, 2, 0)))
        if double_sided is not None:
            square.CreateDoubleSidedAttr(double_sided)
        if turned:
            square.CreateOrientationAttr("leftHanded")
        return picture(shot, samples=4, bounces=0)

    front = seen(None, False)
    assert front[18, 24, 3] == 1.0 and front[18, 24, 0] > 0
    for double_sided in (None, False, True):
        for turned in (False, True):
            assert np.allclose(seen(double_sided, turned), front, atol=1e-5)


def test_a_stage_of_hair_and_glass_gives_no_warning() -> None:
    shot = Ball(opacity=0.0)
    add_primvar(curves(shot), "msbvh:fibre", TYPES.Int, "constant", 1)
    result = read_frame(shot.stage, 10.0, diagnostics=Diagnostics())
    assert not [each for each in result.diagnostics if each.severity == "warning"]
