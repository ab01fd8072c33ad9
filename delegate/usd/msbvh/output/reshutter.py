"""Reads a picture with slices of its shutter, and writes that of another shutter."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

from ..base.image_metadata import ImageMetadata
from ..stage.rendering_space import LINEAR_REC709
from .images import INTEROP_IDS, ImageReadError
from .time_slices import MOST_SLICES, SLICES, channel_names, combined, covers, slice_weights

DESCRIBED = ("framesPerSecond", "worldToCamera", "worldToNDC", "msbvh:shutter", "msbvh:seed")
"""Attributes that a picture of ours has."""


@dataclass(frozen=True)
class SlicedPicture:
    """What a file holds."""

    slices: np.ndarray
    """float32[count, height, width, 4]."""
    metadata: ImageMetadata
    origin: tuple[int, int]
    display: tuple[int, int]
    rendering_space: str = LINEAR_REC709
    """Of its colours."""

    def with_shutter(
        self, wanted: tuple[float, float] | None, area: Callable[[float, float], float]
    ) -> tuple[np.ndarray, tuple[float, float]]:
        """The pixels, float32[height, width, 4], of a shutter, and it; None: the one that was rendered. `area`: of its curve,
        from one share of it to another. Raises ImageReadError for one that lies outside of what was rendered, or between whose
        ends the curve is 0."""
        rendered = self.metadata.shutter
        wanted = rendered if wanted is None else wanted
        if not covers(rendered, wanted):
            found, expected = ("{:g}:{:g}".format(*shutter) for shutter in (wanted, rendered))
            raise ImageReadError(f"--shutter: found {found}, expected a part of what was rendered, {expected}")
        wanted = max(wanted[0], rendered[0]), min(wanted[1], rendered[1])
        return combined(self.slices, slice_weights(len(self.slices), rendered, wanted, area)), wanted


def read_slices(path: Path) -> SlicedPicture:
    """Raises ImageReadError where a file holds no slices."""
    image = oiio.ImageInput.open(str(path))
    if image is None:
        raise ImageReadError(f"cannot read '{path}': {oiio.geterror()}")
    spec = image.spec()
    count = spec.get_int_attribute(SLICES, 0)
    lacking = [name for name in DESCRIBED if spec.getattribute(name) is None]
    names = {name: i for i, name in enumerate(spec.channelnames)}
    wanted = [name for i in range(max(0, min(count, MOST_SLICES))) for name in channel_names(i)]
    missing = [name for name in wanted if name not in names]
    if not 2 <= count <= MOST_SLICES or count & (count - 1) or missing or lacking:
        image.close()
        found = f"{count} slices of the shutter"
        if missing or (count and lacking):
            found = f"no channel {missing[0]}" if missing else f"no attribute {lacking[0]}"
        raise ImageReadError(
            f"cannot read '{path}': found {found}, expected what record --shutter-slices N writes, 2 to {MOST_SLICES}"
        )
    pixels = image.read_image(oiio.FLOAT)
    image.close()
    if pixels is None:
        raise ImageReadError(f"cannot read '{path}': {image.geterror()}")
    taken = np.asarray(pixels, np.float32)[..., [names[name] for name in wanted]]
    slices = np.moveaxis(taken.reshape(spec.height, spec.width, count, 4), 2, 0)
    return SlicedPicture(slices, _metadata(spec), (spec.x, spec.y), (spec.full_width, spec.full_height), _space(spec))


def _space(spec: oiio.ImageSpec) -> str:
    said = spec.get_string_attribute("oiio:ColorSpace")
    return next((space for space, interop in INTEROP_IDS.items() if interop == said), LINEAR_REC709)


def _metadata(spec: oiio.ImageSpec) -> ImageMetadata:
    """As images.write_image() described it."""

    def matrix(name: str) -> np.ndarray:
        return np.array(spec.getattribute(name), np.float64).reshape(4, 4)

    rate = spec.getattribute("framesPerSecond")
    opening, closing = spec.getattribute("msbvh:shutter")
    return ImageMetadata(
        software=spec.get_string_attribute("Software"),
        frame=spec.getattribute("msbvh:frame"),
        frames_per_second=float(Fraction(*rate)) if isinstance(rate, tuple) else float(rate),
        shutter=(float(opening), float(closing)),
        spp=spec.get_int_attribute("msbvh:spp"),
        seed=int(spec.getattribute("msbvh:seed")),
        render_seconds=spec.get_float_attribute("msbvh:renderSeconds"),
        world_to_camera=matrix("worldToCamera"),
        world_to_ndc=matrix("worldToNDC"),
        pixel_aspect_ratio=spec.get_float_attribute("PixelAspectRatio", 1.0),
        noise=spec.get_float_attribute("msbvh:noise", 0.0),
        min_spp=spec.get_int_attribute("msbvh:minSpp", 0),
    )
