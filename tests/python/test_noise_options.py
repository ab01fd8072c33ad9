"""Noise that ends: `record --noise`, `--min-spp`, `--time-limit`, `--clamp-indirect`, `--denoise`."""

from __future__ import annotations

import importlib.machinery
import importlib.util
import json
import sys
import types
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from conftest import Fails, Run
from exr import read_exr
from msbvh.base.errors import SceneError
from msbvh.base.reporter import Reporter
from msbvh.cli.main import main
from msbvh.render.budget import Goals
from msbvh.render.record import record as record_frames
from msbvh.render.settings import RecordSettings, RenderSettings

SMALL = ("-w", 24, "--exr-float")


def layers(path: Path) -> tuple[dict[str, np.ndarray], oiio.ImageSpec]:
    """Channels by name, float32[height, width], and the file's description."""
    image = oiio.ImageInput.open(str(path))
    assert image, oiio.geterror()
    spec, pixels = image.spec(), np.asarray(image.read_image(oiio.FLOAT))
    image.close()
    return {name: pixels[..., i] for i, name in enumerate(spec.channelnames)}, spec


def record(msbvh: Run, tmp_path: Path, scene: Path, name: str, *options: object) -> str:
    done = msbvh("record", scene, name, *SMALL, *options)
    assert done.returncode == 0, done.stderr
    return done.stderr


def test_each_pixel_takes_as_many_samples_as_it_needs(msbvh: Run, scene: Path, tmp_path: Path) -> None:
    record(msbvh, tmp_path, scene, "a.exr", "--noise", 0.05, "--aov", "sampleCount", "--stats", "a.json")
    found, spec = layers(tmp_path / "a.exr")
    samples = found["sampleCount"]
    assert samples.min() == 32 and 32 < samples.max() <= 1024 and not (samples % 16).any()
    assert spec.get_int_attribute("msbvh:spp") == 1024 and spec.get_int_attribute("msbvh:minSpp") == 32
    assert spec.get_float_attribute("msbvh:noise") == pytest.approx(0.05)
    frame = json.loads((tmp_path / "a.json").read_text())["frames"][0]
    assert frame["render"]["camera_rays"] == samples.sum()
    few = int(samples.min())
    record(msbvh, tmp_path, scene, "even.exr", "--spp", few)
    even, _ = layers(tmp_path / "even.exr")
    for name in "RGBA":
        np.testing.assert_array_equal(found[name][samples == few], even[name][samples == few])


def test_the_most_and_the_least_are_kept(msbvh: Run, scene: Path, tmp_path: Path) -> None:
    options = ("--noise", 0.01, "--spp", 96, "--min-spp", 40, "--aov", "sampleCount")
    record(msbvh, tmp_path, scene, "a.exr", *options)
    samples = layers(tmp_path / "a.exr")[0]["sampleCount"]
    assert samples.min() == 64 and samples.max() == 96


def test_a_time_limit_says_which_samples_make_the_same_picture(msbvh: Run, scene: Path, tmp_path: Path) -> None:
    said = record(msbvh, tmp_path, scene, "a.exr", "--time-limit", 1, "--spp", 1 << 20, "--aov", "sampleCount")
    found, spec = layers(tmp_path / "a.exr")
    samples = spec.get_int_attribute("msbvh:spp")
    assert f"--spp {samples} renders the same picture" in said
    assert 16 <= samples < 1 << 20 and samples % 16 == 0 and (found["sampleCount"] == samples).all()
    record(msbvh, tmp_path, scene, "limited.exr", "--time-limit", 0.01, "--spp", 48)
    samples = layers(tmp_path / "limited.exr")[1].get_int_attribute("msbvh:spp")
    assert samples == 16
    record(msbvh, tmp_path, scene, "again.exr", "--spp", samples)
    np.testing.assert_array_equal(read_exr(tmp_path / "limited.exr"), read_exr(tmp_path / "again.exr"))


def test_a_render_settings_prim_may_ask_for_noise(msbvh: Run, scene: Path, tmp_path: Path) -> None:
    prims = (
        f'def RenderSettings "{name}" {{\n    uniform double msbvh:noise = {noise}\n}}\n'
        for name, noise in (("Clean", 0.05), ("Wrong", -1))
    )
    scene.write_text(scene.read_text() + "\n" + "".join(prims))
    options = ("--resolution", 24, 16, "--aov", "sampleCount")
    record(msbvh, tmp_path, scene, "a.exr", "-rs", "/Clean", *options)
    record(msbvh, tmp_path, scene, "b.exr", "--noise", 0.05, *options)
    np.testing.assert_array_equal(read_exr(tmp_path / "a.exr"), read_exr(tmp_path / "b.exr"))
    said = record(msbvh, tmp_path, scene, "c.exr", "-rs", "/Wrong", "--spp", 1)
    assert "msbvh:noise: found -1, expected a number from 0 to 1" in said


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        (("--noise", 0), "0"),
        (("--noise", -0.1), "-0.1"),
        (("--noise", "nan"), "found nan, expected a finite number above 0"),
        (("--noise", 2), "1.0"),
        (("--noise", 0.1, "--min-spp", 0), "--min-spp"),
        (("--min-spp", 64), "--min-spp: expected --noise"),
        (("--noise", 0.1, "--spp", 16, "--min-spp", 32), "--min-spp: found 32, expected at most --spp, 16"),
        (("--noise", 0.1, "--target-flip", 0.1), "--noise and --target-flip exclude each other"),
        (("--time-limit", 0), "0"),
        (("--time-limit", "nan"), "found nan"),
        (("--time-limit", "inf"), "found inf"),
        (("--time-limit", 5, "--time-budget", "9s"), "--time-limit and --time-budget exclude each other"),
        (("--noise", 0.1, "--shutter-slices", 32), "expected at most 16 slices"),
        (("--clamp-indirect", "nan"), "found nan"),
        (("--clamp-indirect", 0), "0"),
        (("--texture-rate", 0), "64"),
        (("--texture-rate", "nan"), "finite"),
    ],
)
def test_wrong_options_are_usage_errors(fails: Fails, scene: Path, options: tuple[object, ...], expected: str) -> None:
    fails(["record", str(scene), "a.exr", *options], 2, expected)


def test_fewer_samples_than_noise_is_judged_by_are_all_taken(msbvh: Run, scene: Path, tmp_path: Path) -> None:
    record(msbvh, tmp_path, scene, "a.exr", "--noise", 0.1, "--spp", 16, "--aov", "sampleCount")
    assert (layers(tmp_path / "a.exr")[0]["sampleCount"] == 16).all()


@pytest.mark.parametrize("settings", [{"render": RenderSettings(noise=0.1)}, {"time_limit": 5.0}])
def test_two_that_decide_the_samples_are_refused(settings: dict, scene: Path, tmp_path: Path) -> None:
    both = RecordSettings(goals=Goals(seconds=9.0), **settings)
    with pytest.raises(SceneError, match="decide the samples"):
        record_frames(str(scene), [str(tmp_path / "a.exr")], both, Reporter())
    assert not (tmp_path / "a.exr").exists()


def test_what_is_denoised_is_a_layer_and_what_png_shows(
    scene: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By a stand-in for the library, which halves: what goes to it, and where what it gives goes."""
    halves = types.ModuleType("pyoidn")
    halves.__spec__ = importlib.machinery.ModuleSpec("pyoidn", None)
    halves.denoise = lambda color, albedo, normal, hdr: np.float32(0.5) * color  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "pyoidn", halves)
    for name, more in (("raw", []), ("clean", ["--denoise"])):
        files = [str(tmp_path / f"{name}.{end}") for end in ("exr", "png")]
        assert main(["record", str(scene), *files, "-w", "24", "--spp", "4", "--exr-float", *more]) == 0
    raw, clean = (layers(tmp_path / f"{name}.exr")[0] for name in ("raw", "clean"))
    assert set(clean) == {*raw, "denoised.R", "denoised.G", "denoised.B"}
    np.testing.assert_array_equal(clean["denoised.R"], np.float32(0.5) * np.maximum(raw["R"], 0))
    np.testing.assert_array_equal(clean["R"], raw["R"])
    assert (tmp_path / "raw.png").read_bytes() != (tmp_path / "clean.png").read_bytes()


@pytest.mark.skipif(importlib.util.find_spec("pyoidn") is not None, reason="pyoidn is installed")
def test_denoising_without_its_package_is_one_clear_line(msbvh: Run, scene: Path) -> None:
    done = msbvh("record", scene, "a.exr", "--denoise")
    assert done.returncode == 2 and "pip install 'msbvh[denoise]'" in done.stderr, done.stderr


@pytest.mark.skipif(
    importlib.util.find_spec("pyoidn") is None, reason="pyoidn is not installed: pip install .[denoise]"
)
def test_a_denoised_picture_lies_beside_the_raw_one(msbvh: Run, scene: Path, tmp_path: Path) -> None:
    options = ("-w", 96, "--spp", 4, "--exr-float")
    for name, more in (("raw", ()), ("clean", ("--denoise",))):
        done = msbvh("record", scene, f"{name}.exr", f"{name}.png", *options, *more)
        assert done.returncode == 0, done.stderr
    raw, _ = layers(tmp_path / "raw.exr")
    clean, _ = layers(tmp_path / "clean.exr")
    assert set(clean) == {*raw, "denoised.R", "denoised.G", "denoised.B"}
    for name in "RGBA":
        np.testing.assert_array_equal(raw[name], clean[name])
    differs = np.abs(clean["denoised.R"] - raw["R"])
    assert 0.0 < differs.mean() < 0.2
    assert (tmp_path / "raw.png").read_bytes() != (tmp_path / "clean.png").read_bytes()
