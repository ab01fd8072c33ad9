"""UsdGeomCamera's exposure attributes."""

from __future__ import annotations

import random
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from material_stage import TYPES
from msbvh import _core
from msbvh.base.errors import Diagnostics
from msbvh.cli.main import main
from msbvh.render.film import Film, film_settings
from msbvh.scene.reader import ReadSettings, read_frame
from pxr import Gf, Usd, UsdGeom
from test_textured_pictures import GlowingShot

NAMES = ("exposure", "exposure:time", "exposure:iso", "exposure:fStop", "exposure:responsivity")
WAYS = ("emission", "directDiffuse", "noise", "albedo", "depth")


def glowing() -> GlowingShot:
    shot = GlowingShot()
    shot.surface.CreateInput("emissiveColor", TYPES.Color3f).Set(Gf.Vec3f(0.5, 0.25, 0.125))
    return shot


def camera_of(shot: GlowingShot) -> Usd.Prim:
    return next(prim for prim in shot.stage.Traverse() if prim.IsA(UsdGeom.Camera))


def exposed(shot: GlowingShot, **settings: object) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    result = read_frame(shot.stage, 10.0, ReadSettings(**settings))
    film = film_settings(Film(), result.camera)
    return _core.Renderer(result.scene, width=16, height=12, spp=16, aovs=WAYS, film=film).render_with_aovs()


def test_the_scale_is_usds() -> None:
    shot, draw = glowing(), random.Random(5)
    camera = camera_of(shot)
    for _ in range(20):
        values = draw.uniform(-4, 4), *(draw.uniform(0.1, 300) for _ in NAMES[1:])
        for name, number in zip(NAMES, values, strict=True):
            camera.GetAttribute(name).Set(number, 10.0)
        expected = UsdGeom.Camera(camera).ComputeLinearExposureScale(10.0)
        assert read_frame(shot.stage, 10.0).camera.exposure == pytest.approx(expected, rel=1e-6)


def test_light_is_scaled_and_nothing_else() -> None:
    shot = glowing()
    plain, parts = exposed(shot)
    camera_of(shot).GetAttribute("exposure").Set(2.0)
    picture, brighter = exposed(shot)
    assert np.array_equal(picture[..., :3], 4 * plain[..., :3]) and np.array_equal(picture[..., 3], plain[..., 3])
    for way in ("emission", "directDiffuse", "noise"):
        assert np.array_equal(brighter[way], 4 * parts[way])
    assert brighter["noise"].any() and brighter["emission"].any()
    for way in ("albedo", "depth"):
        assert np.array_equal(brighter[way], parts[way])
    assert np.array_equal(exposed(shot, exposure=False)[0], plain)


@pytest.mark.parametrize(("name", "number"), [("exposure:fStop", 0.0), ("exposure", 1e6), ("exposure:iso", -100.0)])
def test_exposure_that_makes_no_sense_is_named(name: str, number: float) -> None:
    shot = glowing()
    camera_of(shot).GetAttribute(name).Set(number)
    diagnostics = Diagnostics()
    result = read_frame(shot.stage, 10.0, diagnostics=diagnostics)
    said = [str(each) for each in diagnostics if "exposure scale" in str(each)]
    assert result.camera.exposure == 1.0 and len(said) == 1 and f"{name} {number:g}" in said[0]


def test_the_frames_value_is_held() -> None:
    shot = GlowingShot()
    camera = camera_of(shot)
    UsdGeom.Camera(camera).GetShutterCloseAttr().Set(0.5)
    for time in (10.0, 11.0):
        camera.GetAttribute("exposure").Set(time - 9.0, time)
    diagnostics = Diagnostics()
    assert read_frame(shot.stage, 10.0, diagnostics=diagnostics).camera.exposure == 2.0
    assert [str(each) for each in diagnostics if "exposure" in str(each)]


def test_an_option_leaves_it_out(tmp_path: Path) -> None:
    shot = glowing()
    camera_of(shot).GetAttribute("exposure").Set(1.0)
    scene, out = tmp_path / "shot.usda", tmp_path / "out.exr"
    shot.stage.Export(str(scene))
    means = []
    for options in ([], ["--disableExposureCompensation"]):
        assert main(["record", str(scene), str(out), "-w", "16", "--spp", "4", "--exr-float", *options]) == 0
        means.append(oiio.ImageBuf(str(out)).get_pixels(oiio.FLOAT)[..., :3].mean())
    assert means[0] == pytest.approx(2 * means[1]) and means[1] > 0.05
