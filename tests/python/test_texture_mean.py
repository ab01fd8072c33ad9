"""The mean of a texture, which stands in for it on cards."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from material_stage import write_image as write
from msbvh.look.texture_mean import texture_mean


def linear(encoded: float) -> float:
    return encoded / 12.92 if encoded <= 0.04045 else ((encoded + 0.055) / 1.055) ** 2.4


HALVES = np.zeros((4, 8, 3))
HALVES[:, 4:] = (1.0, 0.6, 0.2)
"""Black and orange: the mean of linear values is not that of encoded ones."""


@pytest.mark.parametrize(("space", "encoded"), [("auto", True), ("sRGB", True), ("raw", False)])
def test_the_mean_is_taken_of_linear_values(tmp_path: Path, space: str, encoded: bool) -> None:
    mean = texture_mean([write(tmp_path / "a.png", HALVES)], space)
    expected = [(linear(x) if encoded else x) / 2 for x in (1.0, 0.6, 0.2)]
    assert mean == pytest.approx((*expected, 1.0), abs=1e-6)


@pytest.mark.parametrize(
    ("name", "kind", "encoded"),
    [("a.png", oiio.UINT16, False), ("a.exr", oiio.HALF, False), ("a.jpg", oiio.UINT8, True)],
)
def test_auto_takes_eight_bits_alone_for_srgb(tmp_path: Path, name: str, kind: object, encoded: bool) -> None:
    mean = texture_mean([write(tmp_path / name, np.full((16, 16, 3), 0.5), kind)], "auto")
    assert mean == pytest.approx(([linear(0.5) if encoded else 0.5] * 3 + [1.0]), abs=5e-3)


def test_grey_and_alpha(tmp_path: Path) -> None:
    grey = texture_mean([write(tmp_path / "grey.png", np.full((4, 4, 1), 0.5))], "auto")  # One channel: no sRGB.
    assert grey == pytest.approx((0.5, 0.5, 0.5, 1.0), abs=0.01)
    alpha = texture_mean([write(tmp_path / "a.png", np.full((4, 4, 4), (0.2, 0.4, 0.6, 0.25)))], "raw")
    assert alpha == pytest.approx((0.2, 0.4, 0.6, 0.25), abs=0.01)


def test_values_that_are_no_colours_do_not_count(tmp_path: Path) -> None:
    pixels = np.full((8, 8, 3), 0.5)
    pixels[0, 0], pixels[1, 1] = np.nan, np.inf
    assert texture_mean([write(tmp_path / "a.exr", pixels, oiio.FLOAT)], "raw") == pytest.approx((0.5, 0.5, 0.5, 1.0))
    assert texture_mean([write(tmp_path / "b.exr", np.full((8, 8, 3), np.nan), oiio.FLOAT)], "raw") is None


def test_tiles_count_alike_and_what_cannot_be_read_is_none(tmp_path: Path) -> None:
    tiles = [write(tmp_path / f"t.{tile}.png", np.full((4, 4, 3), tile / 5000)) for tile in (1000, 4000)]
    assert texture_mean(tiles, "raw") == pytest.approx((0.5, 0.5, 0.5, 1.0), abs=0.01)
    (tmp_path / "broken.png").write_bytes(b"\x89PNG\r\n\x1a\nnothing")
    assert texture_mean([str(tmp_path / "broken.png")], "raw") is None and texture_mean([], "raw") is None
