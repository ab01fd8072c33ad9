"""The image of a light, texel by texel, and the profile of a luminaire, as the translator wants them."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import OpenImageIO as oiio
from pxr import Ar

from .._core import IesProfile, LightPicture, converted_colors, ies_profile, light_picture
from ..stage.rendering_space import LINEAR_REC709
from .texture_mean import is_srgb, linear, on_disk

MOST_TEXELS = 2**23
"""A pyramid is read at the first level that has no more; the translator makes what is larger smaller."""
MOST_FILE_TEXELS = 2**28
"""What has more than that at every level is not read."""
MOST_PROFILE_BYTES = 2**24


_AS_IT_IS = {"raw", "Raw", "data", "identity", "unknown"}
_LINEAR = {"lin_rec709", LINEAR_REC709, "linear"}
_SRGB = {"sRGB", "srgb_texture", "srgb_tx", "srgb_rec709_scene"}
"""Names of colour spaces; others are converted by OpenColorIO."""


def read_light_image(path: str, colour_space: str, layout: str, rendering_space: str) -> LightPicture:
    """`layout`: rect, latlong, angular or mirroredBall. `colour_space`: of the file; empty: sRGB where there are 8 bits and
    three or four channels, else linear Rec.709. Raises ValueError, which says what is wrong with the file, and Error for an
    unknown colour space."""
    return _read(path, colour_space, layout, rendering_space)


@lru_cache(maxsize=8)
def _read(path: str, colour_space: str, layout: str, rendering_space: str) -> LightPicture:
    """Remembered for the frames of a run."""
    with on_disk(path) as file:
        image = None if file is None else oiio.ImageInput.open(file)
        if image is None:
            raise ValueError(oiio.geterror().strip() or "no such file")
        try:
            texels = _texels(image, colour_space, rendering_space)
        finally:
            image.close()
    return light_picture(path, layout, np.ascontiguousarray(texels, np.float32))


def _texels(image: oiio.ImageInput, colour_space: str, rendering_space: str) -> np.ndarray:
    """float32[H, W, 3], in the rendering space."""
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
    if colour_space in _SRGB or (not colour_space and is_srgb(spec, "auto")):
        texels = linear(texels)
    texels = np.broadcast_to(texels, (spec.height, spec.width, 3))
    known = not colour_space or colour_space in _SRGB or colour_space in _LINEAR
    given = LINEAR_REC709 if known else colour_space
    if given in _AS_IT_IS or given == rendering_space:
        return texels
    flat = np.ascontiguousarray(texels, np.float32).reshape(-1, 3)
    return converted_colors(flat, given, rendering_space).reshape(texels.shape)


@lru_cache(maxsize=8)
def read_ies_profile(path: str) -> IesProfile:
    """Raises ValueError, which says what is wrong with the file."""
    asset = Ar.GetResolver().OpenAsset(Ar.ResolvedPath(path))
    if not asset:
        raise ValueError("no such file")
    if asset.GetSize() > MOST_PROFILE_BYTES:
        raise ValueError(f"found {asset.GetSize()} bytes; expected at most {MOST_PROFILE_BYTES}")
    return ies_profile(bytes(asset.GetBuffer()) if asset.GetSize() else b"")
