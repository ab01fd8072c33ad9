"""Filters, shutter curves and the rolling shutter of `record`."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from conftest import Run
from exr import read_exr
from msbvh.render.shutter_curve import CurveError, area, shutter_curve

SMALL = ("-w", 24, "--spp", 16, "--max-bounces", 0, "--exr-float")


@pytest.mark.parametrize(
    ("content", "curve"),
    [
        ("0 0\n0.5 1 # open\n\n1 0\n", ((0, 0), (0.5, 1), (1, 0))),
        ("0.25, 1\n0.25, 3\n0.75, 3\n", ((0.25, 1), (0.25, 3), (0.75, 3))),
        ("[[0, 1], [1, 0.5]]", ((0, 1), (1, 0.5))),
    ],
)
def test_files_of_curves(tmp_path: Path, content: str, curve: object) -> None:
    file = tmp_path / "curve.txt"
    file.write_text(content)
    assert shutter_curve(str(file)) == curve


@pytest.mark.parametrize(
    ("content", "found"),
    [
        ("", "found 0 rows with no area"),
        ("0 1", "found 1 rows with no area"),
        ("0 0\n1 0", "found 2 rows with no area"),
        ("0 1\n1.5 1", "found 1.5 1 in row 2"),
        ("0.5 1\n0.25 1", "found 0.25 1 in row 2"),
        ("0 -1\n1 1", "found 0 -1 in row 1"),
        ("0 nan\n1 1", "found 0 nan in row 1"),
        ("0 1 2\n1 1", "in row 1"),
        ("open 1", "in row 1"),
        ("[[0, 1], [true, 1]]", "in row 2"),
        ("[[0, 1", "no JSON"),
        ("[1, 2]", "found 1 in row 1"),
    ],
)
def test_bad_curves_are_named(tmp_path: Path, content: str, found: str) -> None:
    file = tmp_path / "curve.txt"
    file.write_text(content)
    with pytest.raises(CurveError) as fault:
        shutter_curve(str(file))
    assert found in str(fault.value) and "curve.txt" in str(fault.value) and "\n" not in str(fault.value)


def test_areas_of_curves() -> None:
    triangle = shutter_curve("triangle")
    assert area(triangle) == 0.5 and area(triangle, 0.25, 0.5) == pytest.approx(0.1875)
    assert area(()) == 1.0 and area((), 0.5, 2.0) == 0.5


def test_defaults_change_no_bit(msbvh: Run, scene: Path, tmp_path: Path) -> None:
    msbvh("record", scene, "plain.exr", *SMALL)
    asked = ("--pixel-filter", "box", "--filter-width", 1, "--shutter-curve", "box", "--rolling-shutter", 0)
    done = msbvh("record", scene, "asked.exr", *SMALL, *asked)
    assert done.returncode == 0, done.stderr
    np.testing.assert_array_equal(read_exr(tmp_path / "plain.exr"), read_exr(tmp_path / "asked.exr"))


def test_each_makes_another_picture(msbvh: Run, scene: Path, tmp_path: Path) -> None:
    made = [()]
    made += [("--pixel-filter", name) for name in ("triangle", "gaussian", "blackman-harris")]
    made += [("--filter-width", 2), ("--shutter-curve", "triangle"), ("--rolling-shutter", 0.5)]
    pictures = []
    for i, options in enumerate(made):
        done = msbvh("record", scene, f"{i}.exr", *SMALL, *options)
        assert done.returncode == 0, done.stderr
        pictures.append(read_exr(tmp_path / f"{i}.exr"))
    for i, picture in enumerate(pictures):
        # The square stays in the picture: whatever the film, its light is about the same.
        assert picture[..., 3].sum() == pytest.approx(pictures[0][..., 3].sum(), rel=0.05), made[i]
        assert all(not np.array_equal(picture, other) for other in pictures[:i]), made[i]


def test_a_crop_rolls_as_the_whole_does(msbvh: Run, tmp_path: Path, scene: Path) -> None:
    text = scene.read_text()
    text += """def Scope "Render" {
    def RenderSettings "Upper" {
        uniform float4 dataWindowNDC = (0, 0.5, 1, 1)
        uniform int2 resolution = (24, 16)
    }
}
"""
    scene.write_text(text)
    options = ("--rolling-shutter", 1, "--spp", 256, "--max-bounces", 0, "--exr-float")
    msbvh("record", scene, "whole.exr", "--resolution", 24, 16, *options)
    done = msbvh("record", scene, "upper.exr", "-rs", "/Render/Upper", *options)
    assert done.returncode == 0, done.stderr
    whole, upper = read_exr(tmp_path / "whole.exr"), read_exr(tmp_path / "upper.exr")
    assert upper.shape[0] == 8
    np.testing.assert_allclose(upper[..., 3], whole[:8, :, 3], atol=0.05)


def test_wrong_options_are_usage_errors(msbvh: Run, scene: Path) -> None:
    for options, expected in (
        (("--filter-width", 9), "4.0"),
        (("--filter-width", "nan"), "finite"),
        (("--pixel-filter", "sinc"), "blackman-harris"),
        (("--shutter-curve", "none.txt"), "found 'none.txt', expected box, triangle, trapezoid or a file"),
        (("--rolling-shutter", 2), "1.0"),
    ):
        done = msbvh("record", scene, "a.exr", *options)
        assert done.returncode == 2 and expected in done.stderr, done.stderr
