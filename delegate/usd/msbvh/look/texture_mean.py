"""The mean of a texture: what stands in for it on cards (scene/cards.py)."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio
from pxr import Ar

PIXELS_AT_ONCE = 2**22
ENOUGH_PIXELS = 2**20
"""A level of a pyramid that has no more is taken for the whole."""
MOST_TILES = 16
"""Of a UDIM texture; the first ones stand for all."""
LARGEST = 65504.0
"""What is brighter counts as this, as everywhere (delegate/translate/primvars.h)."""


Rgba = tuple[float, float, float, float]


def texture_mean(files: list[str], colour_space: str) -> Rgba | None:
    """Linear red, green, blue, alpha of the texture in some files (texture_files()); None where it cannot be read.

    `colour_space` is UsdUVTexture's sourceColorSpace: raw, sRGB or auto (sRGB where there are 8 bits and
    three or four channels). One channel is grey; alpha is 1 where there is none. Every texel counts alike.
    """
    means = [mean for path in files[:MOST_TILES] if (mean := _mean(path, colour_space)) is not None]
    if not means:
        return None
    red, green, blue, alpha = np.mean(means, axis=0).tolist()
    return red, green, blue, alpha


@cache
def _mean(path: str, colour_space: str) -> np.ndarray | None:
    """Remembered for the frames of a run."""
    with on_disk(path) as file:
        if file is None:
            return None
        config = oiio.ImageSpec()
        config.attribute("oiio:UnassociatedAlpha", 1)
        image = oiio.ImageInput.open(file, config)
        if image is None:
            oiio.geterror()
            return None
        mean = _mean_of(image, colour_space)
        image.close()
        return mean


@contextmanager
def on_disk(path: str) -> Iterator[str | None]:
    """A file of its own for what lies in a package."""
    if not Ar.IsPackageRelativePath(path):
        yield path
        return
    asset = Ar.GetResolver().OpenAsset(Ar.ResolvedPath(path))
    if not asset:
        yield None
        return
    with tempfile.TemporaryDirectory(prefix="msbvh_texture_") as folder:
        file = Path(folder) / ("texture" + Path(path.rstrip("]")).suffix)
        file.write_bytes(bytes(asset.GetBuffer()))
        yield str(file)


def _mean_of(image: oiio.ImageInput, colour_space: str) -> np.ndarray | None:
    _seek_small_level(image)
    spec = image.spec()
    channels = min(spec.nchannels, 4)
    eight_bits = spec.format.basetype == oiio.UINT8
    srgb = is_srgb(spec, colour_space)
    encoded = np.arange(channels) < {1: 1, 2: 1}.get(channels, 3)  # All but alpha.
    sums, counts = np.zeros(channels), np.zeros(channels)
    for texels in _texels(image, spec, channels, oiio.UINT8 if eight_bits else oiio.FLOAT):
        if texels is None:
            return None
        for channel, values in enumerate(texels.reshape(-1, channels).T):
            total, count = _sum(values, srgb and encoded[channel])
            sums[channel] += total
            counts[channel] += count
    return _as_rgba(sums / counts) if counts.all() else None


def is_srgb(spec: oiio.ImageSpec, colour_space: str) -> bool:
    """Whether colours are encoded by sRGB's curve, by UsdUVTexture's sourceColorSpace."""
    eight_bits = spec.format.basetype == oiio.UINT8
    return colour_space == "sRGB" or (colour_space != "raw" and eight_bits and spec.nchannels in (3, 4))


def _sum(values: np.ndarray, srgb: bool) -> tuple[float, int]:
    """Of linear values, uint8[N] or float32[N]; and how many count: those that are finite."""
    if values.dtype == np.uint8:  # Each value once, which is 20 times as fast.
        table = np.arange(256) / 255.0
        return float(np.bincount(values, minlength=256) @ (linear(table) if srgb else table)), len(values)
    values = np.clip(values[np.isfinite(values)], -LARGEST, LARGEST)
    return float((linear(values) if srgb else values).sum(dtype=np.float64)), len(values)


def _seek_small_level(image: oiio.ImageInput) -> None:
    """A pyramid's levels are means already."""
    level = 0
    while image.spec().width * image.spec().height > ENOUGH_PIXELS and image.seek_subimage(0, level + 1):
        level += 1
    image.seek_subimage(0, level)


def _texels(image: oiio.ImageInput, spec: oiio.ImageSpec, channels: int, kind: Any) -> Iterator[np.ndarray | None]:
    """A part after the other; None where reading fails."""
    if spec.tile_width:
        yield image.read_image(0, channels, kind)
        return
    rows = max(PIXELS_AT_ONCE // max(spec.width, 1), 1)
    for begin in range(spec.y, spec.y + spec.height, rows):
        end = min(begin + rows, spec.y + spec.height)
        yield image.read_scanlines(begin, end, spec.z, 0, channels, kind)


def linear(encoded: np.ndarray) -> np.ndarray:
    """From sRGB's curve; IEC 61966-2-1."""
    return np.where(encoded <= 0.04045, encoded / 12.92, ((np.maximum(encoded, 0.0) + 0.055) / 1.055) ** 2.4)


def _as_rgba(mean: np.ndarray) -> np.ndarray:
    if len(mean) < 3:
        grey, alpha = mean[0], mean[1] if len(mean) == 2 else 1.0
        return np.array([grey, grey, grey, alpha])
    return np.append(mean, 1.0) if len(mean) == 3 else mean
