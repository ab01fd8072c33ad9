"""Pictures that keep their shutter in slices, and the pictures of other shutters that `msbvh reshutter` makes of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from conftest import Run
from exr import read_exr

OPTIONS = ("-w", 48, "--spp", 64, "--max-bounces", 0, "--shutter", "-0.5:0.5", "--exr-float")
FRAME = ("--frames", 2)


def curve_file(path: Path, weights: list[float]) -> Path:
    """Steps of equal length."""
    n = len(weights)
    rows = [f"{t / n} {w}" for i, w in enumerate(weights) for t in (i, i + 1)]
    path.write_text("\n".join(rows))
    return path


@pytest.fixture
def sliced(msbvh: Run, scene: Path, tmp_path: Path) -> Path:
    done = msbvh("record", scene, "sliced.exr", *OPTIONS, "--shutter-slices", 8)
    assert done.returncode == 0, done.stderr
    return tmp_path / "sliced.exr"


def rgba(path: Path) -> np.ndarray:
    return read_exr(path)[..., :4]


def test_slices_sum_up_to_the_picture(msbvh: Run, scene: Path, sliced: Path, tmp_path: Path) -> None:
    pixels = read_exr(sliced)
    assert pixels.shape[-1] == 4 + 8 * 4
    layers = pixels[..., 4:].reshape(*pixels.shape[:2], 8, 4)
    np.testing.assert_allclose(layers.sum(axis=2), pixels[..., :4], atol=1e-6)
    msbvh("record", scene, "plain.exr", *OPTIONS)
    np.testing.assert_allclose(pixels[..., :4], rgba(tmp_path / "plain.exr"), atol=1e-6)
    spec = oiio.ImageInput.open(str(sliced)).spec()
    assert spec.get_int_attribute("msbvh:shutterSlices") == 8
    assert spec.channelnames[4:8] == ("shutter00.R", "shutter00.G", "shutter00.B", "shutter00.A")
    # Where something solid stays in a pixel for a slice, that holds an eighth: each has as many samples.
    assert layers[..., 3].max() == 0.125
    assert (layers[..., 3] == 0.125).sum() > 50


@pytest.mark.parametrize("weights", [[0, 0, 1, 1, 1, 1, 0, 0], [1, 0, 0, 0, 0, 0, 0, 1], [1, 2, 3, 4, 5, 6, 7, 8]])
def test_a_curve_afterwards_is_the_curve_of_the_render_to_the_bit(
    msbvh: Run, scene: Path, sliced: Path, tmp_path: Path, weights: list[float]
) -> None:
    curve = curve_file(tmp_path / "curve.txt", weights)
    done = msbvh("reshutter", sliced, "after.exr", "--curve", curve, "--exr-float")
    assert done.returncode == 0, done.stderr
    done = msbvh("record", scene, "masked.exr", *OPTIONS, "--shutter-slices", 8, "--shutter-curve", curve)
    assert done.returncode == 0, done.stderr
    np.testing.assert_array_equal(rgba(tmp_path / "after.exr"), rgba(tmp_path / "masked.exr"))
    assert not np.array_equal(rgba(tmp_path / "after.exr"), rgba(sliced))


def test_a_shorter_shutter_is_the_curve_that_masks_it(msbvh: Run, sliced: Path, tmp_path: Path) -> None:
    curve = curve_file(tmp_path / "curve.txt", [0, 0, 1, 1, 1, 1, 0, 0])
    msbvh("reshutter", sliced, "masked.exr", "--curve", curve, "--exr-float")
    done = msbvh("reshutter", sliced, "shorter.exr", "--shutter", "-0.25:0.25", "--exr-float")
    assert done.returncode == 0, done.stderr
    np.testing.assert_array_equal(rgba(tmp_path / "shorter.exr"), rgba(tmp_path / "masked.exr"))
    spec = oiio.ImageInput.open(str(tmp_path / "shorter.exr")).spec()
    assert spec.getattribute("msbvh:shutter") == pytest.approx((-0.25, 0.25))
    assert spec.nchannels == 4 and spec.get_int_attribute("msbvh:shutterSlices", 0) == 0


@pytest.mark.parametrize(("shutter", "curve"), [("-0.25:0.25", "box"), ("-0.5:0", "box"), ("-0.5:0.5", "triangle")])
def test_a_fresh_render_of_that_shutter_is_the_same_but_for_noise(
    msbvh: Run, scene: Path, tmp_path: Path, shutter: str, curve: str
) -> None:
    more = ("-w", 48, "--max-bounces", 0, "--exr-float")
    msbvh("record", scene, "s.exr", *more, "--spp", 1024, "--shutter", "-0.5:0.5", "--shutter-slices", 32)
    done = msbvh("reshutter", "s.exr", "after.exr", "--shutter", shutter, "--curve", curve, "--exr-float")
    assert done.returncode == 0, done.stderr
    fresh = [
        (
            "record",
            scene,
            f"{seed}.exr",
            *more,
            "--spp",
            512,
            "--seed",
            seed,
            "--shutter",
            shutter,
            "--shutter-curve",
            curve,
        )
        for seed in (1, 2)
    ]
    for command in fresh:
        assert msbvh(*command).returncode == 0
    after, first, second = (rgba(tmp_path / name)[..., 3] for name in ("after.exr", "1.exr", "2.exr"))
    noise = np.abs(first - second).max()
    # Within a slice the curve is taken as even: less than a part in 32 of the coverage that passes by.
    allowed = 3 * noise + (1 / 32 if curve == "triangle" else 0)
    assert np.abs(after - (first + second) / 2).max() <= allowed
    assert np.abs(after - (first + second) / 2).mean() <= 0.002
    assert (after > 0.01).sum() == pytest.approx((first > 0.01).sum(), rel=0.05)


def test_what_cannot_be_is_said(msbvh: Run, scene: Path, sliced: Path, tmp_path: Path) -> None:
    msbvh("record", scene, "plain.exr", "-w", 8, "--spp", 1)
    (tmp_path / "no.exr").write_text("no picture")
    (tmp_path / "zero.txt").write_text("0 1\n0.0625 0\n1 0")
    for arguments, code, expected in (
        (("reshutter", "plain.exr", "b.exr"), 1, "found 0 slices of the shutter"),
        (("reshutter", "no.exr", "b.exr"), 1, "cannot read 'no.exr'"),
        (("reshutter", "gone.exr", "b.exr"), 1, "cannot read 'gone.exr'"),
        (
            ("reshutter", sliced, "b.exr", "--shutter", "-1:0"),
            1,
            "found -1:0, expected a part of what was rendered, -0.5:0.5",
        ),
        (("reshutter", sliced, "b.exr", "--shutter", "0:0"), 1, "found 0:0"),
        (("reshutter", sliced, "b.gif"), 1, "extension '.gif'"),
        (("reshutter", sliced, sliced), 2, "is the picture that is read"),
        (("record", scene, "b.exr", "--spp", 12, "--shutter-slices", 8), 2, "multiple of 8"),
        (("record", scene, "b.exr", "--shutter-slices", 8, "--sampler", "independent"), 2, "sobol"),
        (("record", scene, "b.exr", "--shutter-slices", 8, "--rolling-shutter", 0.5), 2, "exclude each other"),
        (("record", scene, "b.exr", "--shutter-slices", 8, "--time-budget", "9s"), 2, "--time-budget"),
        (("record", scene, "b.png", "--shutter-slices", 8), 2, "only .exr"),
        (("record", scene, "b.exr", "--shutter-slices", 3), 2, "'2', '4'"),
    ):
        done = msbvh(*arguments)
        assert done.returncode == code and expected in " ".join(done.stderr.split()), done.stderr
        assert not (tmp_path / "b.exr").exists()
    done = msbvh("reshutter", sliced, "b.exr", "--curve", "zero.txt")  # all in one half of a slice
    assert done.returncode == 0, done.stderr
