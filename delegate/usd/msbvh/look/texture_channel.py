"""One channel of a texture, texel by texel: what displacement reads as long as the core evaluates no textures."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import OpenImageIO as oiio

from .texture_mean import is_srgb, linear, on_disk

MOST_TEXELS = 2**26
"""A pyramid is read at the first level that has no more."""

Texels = tuple[np.ndarray, str, str]
"""float32[H, W], the uppermost row first; the wrap modes that the file names in s and t, empty for none."""


def texture_channel(files: list[str], colour_space: str, channel: int) -> Texels | None:
    """Red, green, blue or alpha (0 to 3) of the texture in a file (texture_files()), linear; None where it cannot be
    read.

    `colour_space` as in texture_mean(). One channel stands for all of red, green and blue, of two the first; alpha is 1
    where there is none.
    """
    return _read(files[0], colour_space, channel) if files else None


@lru_cache(maxsize=8)
def _read(path: str, colour_space: str, channel: int) -> Texels | None:
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
        texels = _texels(image, colour_space, channel)
        wrap_s, wrap_t = (image.spec().get_string_attribute(name) for name in ("wrapS", "wrapT"))
        image.close()
        return None if texels is None else (texels, wrap_s, wrap_t)


def _texels(image: oiio.ImageInput, colour_space: str, channel: int) -> np.ndarray | None:
    level = 0
    while image.spec().width * image.spec().height > MOST_TEXELS and image.seek_subimage(0, level + 1):
        level += 1
    image.seek_subimage(0, level)
    spec = image.spec()
    place = _place(channel, spec.nchannels)
    if place is None:
        return np.ones((spec.height, spec.width), np.float32)
    texels = image.read_image(0, level, place, place + 1, oiio.FLOAT)
    if texels is None:
        return None
    texels = np.ascontiguousarray(texels, np.float32).reshape(spec.height, spec.width)
    return linear(texels).astype(np.float32) if is_srgb(spec, colour_space) and channel < 3 else texels


def _place(channel: int, count: int) -> int | None:
    """Of a channel among those of a file; None: it has no alpha."""
    if channel == 3:
        return {1: None, 2: 1, 3: None}.get(count, 3)
    return 0 if count < 3 else channel
