"""Image output: what is stored comes back, display values are those of the sRGB formula, files are whole or
absent."""

from __future__ import annotations

import ctypes
import os
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from msbvh import _core
from msbvh.base.atomic import OutputError, write_whole
from msbvh.base.image_metadata import ImageMetadata, rational_rate, world_to_camera, world_to_ndc
from msbvh.look.color import ColorCorrection, ColorError
from msbvh.output import images
from msbvh.output.images import ImageSettings, write_image

WORLD_FROM_CAMERA = np.array([[0.0, 0.0, -1.0, 0.0], [0.0, 1.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], [5.0, 2.0, 3.0, 1.0]])
"""A camera at (5, 2, 3) that looks along -x; row vectors."""
WINDOW = (-0.5, 0.25, -0.2, 0.4)


def metadata() -> ImageMetadata:
    to_camera = world_to_camera(WORLD_FROM_CAMERA)
    return ImageMetadata(
        software="msbvh test",
        frame=101.25,
        frames_per_second=23.976,
        shutter=(-0.25, 0.125),
        spp=16,
        seed=7,
        render_seconds=1.5,
        world_to_camera=to_camera,
        world_to_ndc=world_to_ndc(to_camera, WINDOW, perspective=True),
    )


def random_rgba(height: int = 5, width: int = 7) -> np.ndarray:
    """Premultiplied, with empty, full and partial coverage."""
    random = np.random.default_rng(1)
    alpha = random.choice([0.0, 0.25, 0.6, 1.0], (height, width, 1))
    return (np.concatenate([random.random((height, width, 3)) * alpha, alpha], axis=-1)).astype(np.float32)


def read(path: Path, unassociated: bool = False) -> np.ndarray:
    """Stored values as float32[h, w, c]."""
    hint = oiio.ImageSpec()
    hint.attribute("oiio:UnassociatedAlpha", int(unassociated))
    source = oiio.ImageInput.open(str(path), hint)
    assert source, oiio.geterror()
    pixels = source.read_image(oiio.FLOAT)
    source.close()
    return pixels


def srgb(linear: np.ndarray) -> np.ndarray:
    """IEC 61966-2-1."""
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 0.0) ** (1 / 2.4) - 0.055)


def straight(rgba: np.ndarray) -> np.ndarray:
    alpha = rgba[..., 3:]
    return np.divide(rgba[..., :3], alpha, out=np.zeros_like(rgba[..., :3]), where=alpha > 0)


@pytest.mark.parametrize("exr_float", [False, True])
def test_exr_keeps_the_pixels(tmp_path: Path, exr_float: bool) -> None:
    rgba = random_rgba()
    path = tmp_path / "a.exr"
    write_image(path, rgba, metadata(), ImageSettings(exr_float=exr_float))
    expected = rgba if exr_float else rgba.astype(np.float16).astype(np.float32)
    assert np.array_equal(read(path), expected)


def test_exr_half_stays_finite(tmp_path: Path) -> None:
    rgba = np.full((1, 1, 4), 1e6, dtype=np.float32)
    write_image(tmp_path / "a.exr", rgba, metadata(), ImageSettings())
    assert np.array_equal(read(tmp_path / "a.exr"), np.full((1, 1, 4), images.HALF_MAX, dtype=np.float32))


def test_exr_says_how_it_was_made(tmp_path: Path) -> None:
    path = tmp_path / "a.exr"
    write_image(path, random_rgba(), metadata(), ImageSettings())
    spec = oiio.ImageInput.open(str(path)).spec()
    found = {attribute.name: attribute.value for attribute in spec.extra_attribs}
    assert found["Software"] == "msbvh test"
    assert found["framesPerSecond"] == (24000, 1001)
    assert found["msbvh:shutter"] == (-0.25, 0.125)
    assert (found["msbvh:spp"], found["msbvh:seed"], found["msbvh:frame"]) == (16, 7, 101.25)
    assert found["msbvh:renderSeconds"] == 1.5
    assert found["oiio:ColorSpace"] == "lin_rec709_scene"
    assert np.allclose(np.reshape(found["worldToCamera"], (4, 4)), metadata().world_to_camera)
    assert np.allclose(np.reshape(found["worldToNDC"], (4, 4)), metadata().world_to_ndc)


@pytest.mark.parametrize("perspective", [True, False])
def test_matrices_take_the_window_to_the_unit_square(perspective: bool) -> None:
    """OpenEXR: the camera looks along +z, NDC (0, 0) is the upper left corner, (1, 1) the lower right one."""
    left, right, bottom, top = WINDOW
    distance = 4.0
    scale = distance if perspective else 1.0
    to_camera = world_to_camera(WORLD_FROM_CAMERA)
    for x, y, expected in ((left, top, (0.0, 0.0)), (right, bottom, (1.0, 1.0)), (right, top, (1.0, 0.0))):
        world = np.array([x * scale, y * scale, -distance, 1.0]) @ WORLD_FROM_CAMERA
        assert np.allclose((world @ to_camera)[2], distance)
        ndc = world @ world_to_ndc(to_camera, WINDOW, perspective)
        assert np.allclose(ndc[:2] / ndc[3], expected)


@pytest.mark.parametrize(
    ("rate", "expected"),
    [
        (24.0, (24, 1)),
        (23.976, (24000, 1001)),
        (29.97, (30000, 1001)),
        (59.94, (60000, 1001)),
        (12.5, (25, 2)),
        (128.0, (128, 1)),
    ],
)
def test_frame_rates(rate: float, expected: tuple[int, int]) -> None:
    assert rational_rate(rate) == expected


def test_png_is_srgb_with_unassociated_alpha(tmp_path: Path) -> None:
    rgba = random_rgba()
    path = tmp_path / "a.png"
    write_image(path, rgba, metadata(), ImageSettings())
    stored = read(path, unassociated=True)
    covered = rgba[..., 3] > 0
    assert np.abs(stored[..., 3] - rgba[..., 3]).max() <= 0.5 / 255 + 1e-6
    # Half a code for the rounding, 1e-4 for OpenColorIO's single-precision matrices and tables.
    assert np.abs(stored[..., :3] - srgb(straight(rgba)))[covered].max() <= 0.5 / 255 + 1e-4


def test_an_opaque_png_keeps_what_lies_behind(tmp_path: Path) -> None:
    rgba = random_rgba() + np.float32([0.1, 0.2, 0.3, 0.0])
    write_image(tmp_path / "a.png", rgba, metadata(), ImageSettings(opaque=True))
    stored = read(tmp_path / "a.png", unassociated=True)
    assert np.array_equal(stored[..., 3], np.ones_like(stored[..., 3]))
    assert np.abs(stored[..., :3] - np.clip(srgb(rgba[..., :3]), 0, 1)).max() <= 0.5 / 255 + 1e-4


def test_tiff_is_srgb_with_associated_alpha(tmp_path: Path) -> None:
    rgba = random_rgba()
    path = tmp_path / "a.tif"
    write_image(path, rgba, metadata(), ImageSettings())
    expected = srgb(straight(rgba)) * rgba[..., 3:]
    assert np.abs(read(path)[..., :3] - expected).max() <= 1e-4


def test_jpeg_lies_over_black(tmp_path: Path) -> None:
    """Composited in linear light: the premultiplied colour is encoded. One flat colour, so that JPEG keeps
    it."""
    rgba = np.broadcast_to(np.float32([0.1, 0.1, 0.1, 0.5]), (16, 16, 4))
    path = tmp_path / "a.jpg"
    write_image(path, rgba, metadata(), ImageSettings())
    stored = read(path)
    assert stored.shape[2] == 3
    assert np.abs(stored - srgb(np.float32(0.1))).max() <= 1.5 / 255


def test_disabled_stores_linear_values(tmp_path: Path) -> None:
    rgba = random_rgba()
    write_image(tmp_path / "a.tif", rgba, metadata(), ImageSettings(ColorCorrection("disabled")))
    assert np.abs(read(tmp_path / "a.tif") - rgba).max() <= 1e-4


def test_open_color_io_takes_a_view(tmp_path: Path) -> None:
    rgba = np.full((2, 2, 4), 1.0, dtype=np.float32)
    default = ColorCorrection("openColorIO")
    plain = ColorCorrection("openColorIO", "sRGB - Display", "Un-tone-mapped")
    for name, color in (("default", default), ("plain", plain), ("srgb", ColorCorrection("sRGB"))):
        write_image(tmp_path / f"{name}.png", rgba, metadata(), ImageSettings(color))
    assert np.array_equal(read(tmp_path / "plain.png"), read(tmp_path / "srgb.png"))
    # The config's default view tone-maps: diffuse white is not display white.
    assert read(tmp_path / "default.png")[..., :3].max() < 0.95


@pytest.mark.parametrize(
    ("color", "message"),
    [
        (
            ColorCorrection("openColorIO", "Nowhere"),
            "unknown OpenColorIO display 'Nowhere'; expected one of: sRGB",
        ),
        (
            ColorCorrection("openColorIO", None, "Nothing"),
            "unknown OpenColorIO view 'Nothing'; expected one of: ACES",
        ),
    ],
)
def test_unknown_display_or_view(color: ColorCorrection, message: str) -> None:
    with pytest.raises(ColorError, match=message):
        color.resolve()


@pytest.mark.parametrize("named", [False, True])
def test_nothing_is_left_behind_on_failure(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, named: bool) -> None:
    """Also where the file system has no files without a name."""
    path = tmp_path / "a.exr"
    path.write_text("old")
    if named:
        monkeypatch.setattr(os, "O_TMPFILE", os.O_DIRECTORY)

    def fails(*_: object, **__: object) -> None:
        raise failure

    for step in ("write", "fsync", "rename", "close"):
        for failure in (KeyboardInterrupt(), OSError(5, "planted")):
            with monkeypatch.context() as patch:
                if step == "close":
                    close = os.close
                    patch.setattr(os, "close", lambda file: (close(file), fails()))
                else:
                    patch.setattr(os, step, fails)
                with pytest.raises((KeyboardInterrupt, OutputError)):
                    write_whole(path, b"new")
            assert os.listdir(tmp_path) == ["a.exr"]
        assert path.read_text() == "old" or step == "close"
    write_whole(path, b"new")
    assert path.read_text() == "new"


def test_a_write_that_takes_only_a_part(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As where a signal comes, or the disk is full only at the end."""
    write = os.write
    monkeypatch.setattr(os, "write", lambda file, content: write(file, content[:3]))
    write_whole(tmp_path / "a", bytes(range(100)))
    assert (tmp_path / "a").read_bytes() == bytes(range(100))


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("a.bmp", "extension '.bmp', expected one of .exr"),
        ("a", "no extension"),
        ("no/a.exr", "there is no folder"),
        ("folder.exr", "not a regular file"),
    ],
)
def test_a_path_that_cannot_be_written(tmp_path: Path, name: str, message: str) -> None:
    (tmp_path / "folder.exr").mkdir()
    with pytest.raises(OutputError, match=message):
        write_image(tmp_path / name, random_rgba(), metadata(), ImageSettings())
    assert os.listdir(tmp_path) == ["folder.exr"]


def test_the_system_s_refusal_is_one_line(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match=r"cannot write '.*a\.json': No such file"):
        write_whole(tmp_path / "nowhere" / "a.json", b"")


def test_what_cannot_be_encoded_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An encoder that stops half way without a word, as OpenImageIO's PNG writer can."""

    class Half:
        def __init__(self, output: object) -> None:
            self._output = output

        def __getattr__(self, name: str) -> object:
            return getattr(self._output, name)

        def write_image(self, pixels: np.ndarray) -> bool:
            return self._output.write_scanlines(0, 2, 0, pixels[:2])  # type: ignore[attr-defined]

    create = oiio.ImageOutput.create
    monkeypatch.setattr(images, "_create_output", lambda form: Half(create(form)))
    for name in ("a.png", "a.exr", "a.tif"):
        with pytest.raises(OutputError, match=f"{name}': the image could not be encoded"):
            write_image(tmp_path / name, random_rgba(), metadata(), ImageSettings())
    assert os.listdir(tmp_path) == []


def test_a_pipe_has_no_limit_and_needs_no_end() -> None:
    """A megabyte and more, while the one who writes holds the GIL; a second descriptor stays open."""
    pipe = _core.PipeReader()
    content = np.random.default_rng(0).bytes(3_000_001)
    file = os.open(pipe.path, os.O_WRONLY)
    assert ctypes.PyDLL(None).write(file, content[:3_000_000], 3_000_000) == 3_000_000
    os.write(file, content[3_000_000:])
    assert pipe.finish() == content
    os.close(file)
    assert _core.PipeReader().finish() == b""
