"""Writes pixels as EXR, PNG, JPEG or TIFF by OpenImageIO, and reads coverage back.

EXR keeps what the renderer made: linear, premultiplied. The others are display-referred: colour correction
works on colours that are not premultiplied, then each format gets the alpha that it is defined with: PNG
unassociated, TIFF associated, JPEG none (the image lies over black).
"""

from __future__ import annotations

import errno
import json
import mmap
import os
import resource
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

from .. import _core
from ..base.atomic import Folders, OutputError, check_writable, write_whole
from ..base.image_metadata import ImageMetadata, rational_rate
from ..look.color import SRGB_DISPLAY, ColorCorrection
from ..stage.rendering_space import LINEAR_REC709

FORMATS = {
    ".exr": "openexr",
    ".png": "png",
    ".jpg": "jpeg",
    ".jpeg": "jpeg",
    ".tif": "tiff",
    ".tiff": "tiff",
}
"""OpenImageIO's name of the format of each extension."""
ENDINGS = {"png": b"IEND\xaeB`\x82", "jpeg": b"\xff\xd9"}
"""The last bytes of a complete file, in the formats that are written from their start to their end."""
HALF_MAX = 65504.0
"""Largest finite half; brighter pixels are written as this, because infinity ruins every filter behind us."""

_CHROMATICITIES = {
    LINEAR_REC709: (0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290),
    "acescg": (0.713, 0.293, 0.165, 0.830, 0.128, 0.044, 0.32168, 0.33767),
}
"""x and y of red, green, blue and white; SMPTE ST 2065-1 and Academy S-2014-004 of the second."""
INTEROP_IDS = {LINEAR_REC709: LINEAR_REC709, "acescg": "lin_ap1_scene"}
"""What OpenImageIO writes as colorInteropID."""


@dataclass(frozen=True)
class ImageSettings:
    """How an image is stored."""

    color: ColorCorrection = ColorCorrection()
    opaque: bool = False
    """Something lies behind what alpha covers (a visible dome): display formats then get alpha 1."""
    exr_float: bool = False
    """EXR in 32-bit floats: twice the bytes of half; no rounding to 11 bits, no limit at HALF_MAX."""


@dataclass(frozen=True)
class Layers:
    """What a frame consists of."""

    rgba: np.ndarray
    """float32[h, w, 4]: linear, premultiplied, top row first."""
    aovs: Mapping[str, np.ndarray] = field(default_factory=dict)
    """By name: int32[h, w] of ids, else float32[h, w, channels]. EXR alone stores them, in 32-bit floats."""
    prims: Sequence[str] = ()
    """The paths that primId counts."""
    channels: Mapping[str, Sequence[str]] = field(default_factory=dict)
    """Names of the channels of `aovs`."""
    attributes: Mapping[str, str | int] = field(default_factory=dict)
    """What describes `aovs`, in EXR's header."""
    halves: frozenset[str] = frozenset()
    """Names of `aovs` that are stored in 16 bits a number."""
    origin: tuple[int, int] = (0, 0)
    """Where the first pixel lies in the display window, x and y from its upper left corner; it may lie outside."""
    display: tuple[int, int] | None = None
    """Width and height of the display window; None: the pixels'. EXR alone stores both windows."""
    shown: np.ndarray | None = None
    """float32[h, w, 4], as `rgba`, in whose place formats other than EXR show it; None: they show that."""


class ImageReadError(Exception):
    """An image cannot be read; str() is one line that names it and says why."""


def read_alpha(path: Path) -> np.ndarray:
    """The alpha of an image, or its one channel: float64[height, width], top row first.

    Raises ImageReadError where there is no image, or one of several channels without alpha.
    """
    image, spec = _opened(path)
    channel = spec.alpha_channel if spec.nchannels > 1 else 0
    if channel < 0:
        names = ", ".join(spec.channelnames)
        raise ImageReadError(f"'{path.name}' has no alpha channel: found {names}, expected RGBA")
    return _channels(path, image, channel, channel + 1)[..., 0]


def read_colour(path: Path) -> np.ndarray:
    """The first three channels of an image: float64[height, width, 3], top row first.

    Raises ImageReadError where there is no image, or one of fewer channels.
    """
    image, spec = _opened(path)
    if spec.nchannels < 3:
        raise ImageReadError(f"'{path.name}' has no colours: found {spec.nchannels} channels, expected RGB")
    return _channels(path, image, 0, 3)


def _opened(path: Path) -> tuple[oiio.ImageInput, oiio.ImageSpec]:
    image = oiio.ImageInput.open(str(path))
    if image is None:
        raise ImageReadError(f"cannot read '{path}': {oiio.geterror()}")
    return image, image.spec()


def _channels(path: Path, image: oiio.ImageInput, first: int, end: int) -> np.ndarray:
    """float64[height, width, end - first]; closes the image."""
    spec = image.spec()
    pixels = image.read_image(first, end, oiio.FLOAT)
    image.close()
    if pixels is None:
        raise ImageReadError(f"cannot read '{path}': {image.geterror()}")
    return np.asarray(pixels, np.float64).reshape(spec.height, spec.width, end - first)


def check_image_path(path: Path, folders: Folders | None = None) -> Path:
    """Raises OutputError where no image can be written to `path`, because of its format or its place. Returns the
    file that would be replaced."""
    if path.suffix.lower() not in FORMATS:
        found = f"extension '{path.suffix}'" if path.suffix else "no extension"
        raise OutputError(f"cannot write '{path}': {found}, expected one of {' '.join(FORMATS)}")
    return check_writable(path, folders)


def write_image(path: Path, layers: np.ndarray | Layers, metadata: ImageMetadata, settings: ImageSettings) -> None:
    """Writes a frame, or its colour alone (Layers.rgba), complete or not at all. Raises OutputError."""
    check_image_path(path)
    suffix = path.suffix.lower()
    layers = layers if isinstance(layers, Layers) else Layers(layers)
    shown = layers.rgba if layers.shown is None or suffix == ".exr" else layers.shown
    pixels, spec = _encode(suffix, shown, settings)
    if suffix == ".exr" and layers.aovs:
        pixels = _add_aovs(pixels, spec, layers)
    if suffix == ".exr":
        _place(spec, layers)
    _describe(spec, metadata)
    try:
        content = _file_content(FORMATS[suffix], pixels, spec)
    except _EncodingError as error:
        raise OutputError(f"cannot write '{path}': {error}") from None
    write_whole(path, content)


def write_display_png(path: Path, rgb: np.ndarray) -> None:
    """Writes float32[h, w, 3] of display values in [0, 1] as an opaque PNG of 8 bits, complete or not at all. Raises
    OutputError."""
    pixels = np.ascontiguousarray(rgb, np.float32)
    try:
        content = _file_content("png", pixels, _spec(pixels, oiio.UINT8))
    except _EncodingError as error:
        raise OutputError(f"cannot write '{path}': {error}") from None
    write_whole(path, content)


class _EncodingError(Exception):
    """OpenImageIO cannot encode an image; str() says why."""


def _file_content(form: str, pixels: np.ndarray, spec: oiio.ImageSpec) -> bytes | memoryview:
    """A whole file, in memory. OpenImageIO must never meet a full disk: its PNG writer says that all went well,
    and libjpeg ends the process.

    What is written from start to end goes through a pipe, which has no limit at all. The others seek; they write
    to a file in memory, and are read back: RLIMIT_FSIZE holds there too.
    """
    if form in ENDINGS:
        pipe = _core.PipeReader()
        done = _write(form, pipe.path, pixels, spec)
        content = pipe.finish()
        if not (done and content.endswith(ENDINGS[form])):
            raise _EncodingError("the image could not be encoded")
        return content
    file = os.memfd_create("msbvh")
    try:
        name = f"/proc/self/fd/{file}"
        done = _write(form, name, pixels, spec)
        if not (done and _reads_back(name, spec)):
            raise _EncodingError(_limit_reached(os.fstat(file).st_size) or "the image could not be encoded")
        return memoryview(mmap.mmap(file, 0, access=mmap.ACCESS_READ))
    finally:
        os.close(file)


def _create_output(form: str) -> oiio.ImageOutput | None:
    return oiio.ImageOutput.create(form)


def _write(form: str, name: str, pixels: np.ndarray, spec: oiio.ImageSpec) -> bool:
    output = _create_output(form)
    if output is None:
        raise _EncodingError(oiio.geterror())
    done = output.open(name, spec) and output.write_image(pixels) and not output.geterror()
    closed = output.close()
    output.geterror()  # Of TIFF, 3.2 always says that an empty Exif block failed; reading back decides.
    oiio.geterror()  # What nobody asks for is printed at the process's end.
    return bool(done and closed)


def _reads_back(name: str, spec: oiio.ImageSpec) -> bool:
    """Whether the header and the last row can be read."""
    image = oiio.ImageInput.open(name)
    rows = None
    if image is not None:
        last = spec.y + spec.height - 1
        rows = image.read_scanlines(last, last + 1, 0, 0, spec.nchannels)
        image.geterror()
        image.close()
    oiio.geterror()
    return rows is not None


def _limit_reached(size: int) -> str:
    limit = resource.getrlimit(resource.RLIMIT_FSIZE)[0]
    return os.strerror(errno.EFBIG) if limit != resource.RLIM_INFINITY and size >= limit else ""


def _encode(suffix: str, rgba: np.ndarray, settings: ImageSettings) -> tuple[np.ndarray, oiio.ImageSpec]:
    """The stored pixels of a format, float32, and their description."""
    if suffix == ".exr":
        return _encode_exr(rgba, settings.exr_float, settings.color.rendering_space)
    if suffix in (".jpg", ".jpeg"):
        pixels = settings.color.apply(rgba[..., :3])  # Premultiplied is over black.
        spec = _spec(pixels, oiio.UINT8)
        spec.attribute("Compression", "jpeg:95")
    else:
        associated = suffix != ".png"
        pixels = _display_rgba(rgba, settings, associated)
        spec = _spec(pixels, oiio.UINT16 if associated else oiio.UINT8)
        spec.attribute("oiio:UnassociatedAlpha", 0 if associated else 1)
    resolved = settings.color.resolve()
    if resolved is not None and resolved[0] == SRGB_DISPLAY:
        spec.attribute("oiio:ColorSpace", "srgb_rec709_display")
    return pixels, spec


def _encode_exr(rgba: np.ndarray, exr_float: bool, space: str) -> tuple[np.ndarray, oiio.ImageSpec]:
    pixels = rgba if exr_float else np.clip(rgba, -HALF_MAX, HALF_MAX)
    spec = _spec(pixels, oiio.FLOAT if exr_float else oiio.HALF)
    spec.attribute("compression", "zip")
    spec.attribute("oiio:ColorSpace", INTEROP_IDS[space])
    spec.attribute("chromaticities", oiio.TypeDesc("float[8]"), _CHROMATICITIES[space])
    return pixels, spec


def _add_aovs(pixels: np.ndarray, spec: oiio.ImageSpec, layers: Layers) -> np.ndarray:
    """The pixels with the channels of the AOVs behind them."""
    names, parts = list(spec.channelnames), [pixels]
    formats = [oiio.TypeDesc(spec.format)] * pixels.shape[2]
    for name, values in layers.aovs.items():
        part = values.astype(np.float32).reshape(*pixels.shape[:2], -1)
        # An infinite value spoils every filter behind us; Hydra clears cameraDepth to 0.
        part = np.where(np.isinf(part), np.float32(0.0), part)
        half = name in layers.halves
        parts.append(np.clip(part, -HALF_MAX, HALF_MAX) if half else part)
        names += layers.channels[name]
        formats += [oiio.TypeDesc("half" if half else "float")] * part.shape[2]
    spec.nchannels = len(names)
    spec.channelnames = tuple(names)
    spec.channelformats = tuple(formats)
    for name, value in layers.attributes.items():
        spec.attribute(name, value)
    if layers.prims:
        spec.attribute("msbvh:prims", json.dumps(list(layers.prims)))
    return np.ascontiguousarray(np.concatenate(parts, axis=2))


def _place(spec: oiio.ImageSpec, layers: Layers) -> None:
    """The data window, which the pixels fill, in the display window."""
    spec.x, spec.y = layers.origin
    spec.full_x = spec.full_y = 0
    spec.full_width, spec.full_height = layers.display or (spec.width, spec.height)


def _spec(pixels: np.ndarray, storage: oiio.BASETYPE) -> oiio.ImageSpec:
    height, width, channels = pixels.shape
    return oiio.ImageSpec(width, height, channels, storage)


def _display_rgba(rgba: np.ndarray, settings: ImageSettings, associated: bool) -> np.ndarray:
    """Display-referred float32[h, w, 4] of linear, premultiplied pixels; alpha is not corrected."""
    alpha = np.ones_like(rgba[..., 3:]) if settings.opaque else rgba[..., 3:]
    straight = np.divide(rgba[..., :3], alpha, out=np.array(rgba[..., :3]), where=alpha > 0.0)
    display = settings.color.apply(straight)
    return np.concatenate([display * alpha if associated else display, alpha], axis=-1)


def _describe(spec: oiio.ImageSpec, metadata: ImageMetadata) -> None:
    """Formats without arbitrary metadata drop what they cannot hold; EXR holds all of it."""
    spec.attribute("Software", metadata.software)
    spec.attribute("PixelAspectRatio", metadata.pixel_aspect_ratio)
    spec.attribute("framesPerSecond", oiio.TypeRational, rational_rate(metadata.frames_per_second))
    spec.attribute("worldToCamera", oiio.TypeMatrix, _floats(metadata.world_to_camera))
    spec.attribute("worldToNDC", oiio.TypeMatrix, _floats(metadata.world_to_ndc))
    spec.attribute("msbvh:shutter", oiio.TypeDesc("float[2]"), metadata.shutter)
    spec.attribute("msbvh:spp", metadata.spp)
    spec.attribute("msbvh:seed", metadata.seed)
    if metadata.noise > 0.0:
        spec.attribute("msbvh:noise", metadata.noise)
        spec.attribute("msbvh:minSpp", metadata.min_spp)
    spec.attribute("msbvh:renderSeconds", metadata.render_seconds)
    if metadata.frame is not None:
        spec.attribute("msbvh:frame", metadata.frame)


def _floats(matrix: np.ndarray) -> tuple[float, ...]:
    return tuple(float(value) for value in np.asarray(matrix).ravel())
