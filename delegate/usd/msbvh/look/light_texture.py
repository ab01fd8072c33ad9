"""The image of a light, texel by texel, and the profile of a luminaire, as the translator wants them."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import OpenImageIO as oiio
from pxr import Ar

from .._core import IesProfile, LightPicture, ies_profile, light_picture
from .texture_mean import is_srgb, linear, on_disk

MOST_TEXELS = 2**23
"""A pyramid is read at the first level that has no more; the translator makes what is larger smaller."""
MOST_FILE_TEXELS = 2**28
"""What has more than that at every level is not read."""
MOST_PROFILE_BYTES = 2**24


def read_light_image(path: str, colour_space: str, layout: str) -> LightPicture:
    """`layout`: rect, latlong, angular or mirroredBall. Raises ValueError, which says what is wrong with the file."""
    return _read(path, colour_space, layout)


@lru_cache(maxsize=8)
def _read(path: str, colour_space: str, layout: str) -> LightPicture:
    """Remembered for the frames of a run."""
    with on_disk(path) as file:
        image = None if file is None else oiio.ImageInput.open(file)
        if image is None:
            raise ValueError(oiio.geterror().strip() or "no such file")
        try:
            texels = _texels(image, colour_space)
        finally:
            image.close()
    return light_picture(path, layout, np.ascontiguousarray(texels, np.float32))


def _texels(image: oiio.ImageInput, colour_space: str) -> np.ndarray:
    """float32[H, W, 3]."""
    level = 0
    while image.spec().width * image.spec().height > MOST_TEXELS and image.seek_subimage(0, level + 1):
        level += 1
    image.seek_subimage(0, level)
    spec = image.spec()
    if not 0 < spec.width * spec.height <= MOST_FILE_TEXELS:
        raise ValueError(f"found {spec.width} x {spec.height} texels; expected 1 to {MOST_FILE_TEXELS}")
    channels = 3 if spec.nchannels >= 3 else 1
    texels = image.read_image(0, level, 0, channels, oiio.FLOAT)
    if texels is None:
        raise ValueError(image.geterror().strip() or "it cannot be read")
    texels = np.asarray(texels, np.float32).reshape(spec.height, spec.width, channels)
    if is_srgb(spec, colour_space):
        texels = linear(texels)
    return np.broadcast_to(texels, (spec.height, spec.width, 3))


@lru_cache(maxsize=8)
def read_ies_profile(path: str) -> IesProfile:
    """Raises ValueError, which says what is wrong with the file."""
    asset = Ar.GetResolver().OpenAsset(Ar.ResolvedPath(path))
    if not asset:
        raise ValueError("no such file")
    if asset.GetSize() > MOST_PROFILE_BYTES:
        raise ValueError(f"found {asset.GetSize()} bytes; expected at most {MOST_PROFILE_BYTES}")
    return ies_profile(bytes(asset.GetBuffer()))
