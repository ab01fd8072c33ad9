"""Paints the showcase's textures, all of them small, beside this file.

    python testenv/showcase/textures/make_textures.py [FOLDER]

flag, die, ball and backdrop are drawn from shapes; floor (colour, roughness, normals) is stone tiles; studio.exr is what the
metal mirrors and the sky that lights it: a latlong picture of a dark room with soft boxes. The same pixels every time.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

Array = np.ndarray

CREAM, RED, NAVY = (0.80, 0.71, 0.55), (0.52, 0.035, 0.025), (0.012, 0.035, 0.075)
TEAL, ORANGE, GOLD = (0.02, 0.30, 0.33), (0.83, 0.24, 0.025), (0.83, 0.50, 0.06)
"""Linear Rec.709."""


def main(folder: Path) -> None:
    write(folder / "flag.png", srgb(flag(768, 512)))
    write(folder / "die.png", srgb(die(128)))
    write(folder / "ball.png", srgb(ball(256, 128)))
    color, roughness, normal = floor(512)
    write(folder / "backdrop.jpg", srgb(backdrop(256, 128)))
    write(folder / "floor.jpg", srgb(color))
    write(folder / "floor_roughness.jpg", roughness[..., None])
    write(folder / "floor_normal.png", normal)
    write(folder / "studio.exr", studio(256, 128))


def flag(width: int, height: int) -> Array:
    """Nested boxes of a bounding volume hierarchy, between two stripes; float64[height, width, 3], top row first."""
    x, y = places(width, height)
    x = x * width / height
    picture = np.broadcast_to(CREAM, (height, width, 3)).copy()
    for low in (0.0, 0.88):
        paint(picture, (y >= low) & (y < low + 0.12), RED)
    boxes: Sequence[tuple[float, float, float, float, tuple[float, float, float]]] = (
        (0.20, 0.19, 1.30, 0.81, NAVY),
        (0.25, 0.25, 0.73, 0.75, TEAL),
        (0.80, 0.25, 1.25, 0.63, TEAL),
        (0.29, 0.30, 0.52, 0.52, ORANGE),
        (0.45, 0.46, 0.69, 0.70, GOLD),
        (0.84, 0.30, 1.00, 0.58, GOLD),
        (1.05, 0.34, 1.21, 0.54, ORANGE),
    )
    for left, top, right, bottom, color in boxes:
        paint(picture, (x > left) & (x < right) & (y > top) & (y < bottom), color)
    for at_x, at_y, size in ((0.385, 0.40, 0.065), (0.575, 0.585, 0.075), (0.92, 0.44, 0.06), (1.13, 0.44, 0.06)):
        paint(picture, np.hypot(x - at_x, y - at_y) < size, CREAM)
    # Threads: light and dark across, and along.
    weave = 1.0 + 0.05 * np.cos(2 * np.pi * x * 96) * np.cos(2 * np.pi * y * 96)
    return picture * weave[..., None]


def die(side: int) -> Array:
    """Six faces in a row, with pips; float64[side, 6 side, 3]."""
    picture = np.broadcast_to(RED, (side, 6 * side, 3)).copy()
    x, y = np.meshgrid((np.arange(6 * side) + 0.5) / side, (np.arange(side) + 0.5) / side)
    low, mid, high = 0.26, 0.5, 0.74
    corners = [(low, low), (high, high), (low, high), (high, low)]
    pips = {
        1: [(mid, mid)],
        2: corners[:2],
        3: [*corners[:2], (mid, mid)],
        4: corners,
        5: [*corners, (mid, mid)],
        6: [*corners, (low, mid), (high, mid)],
    }
    for number, places_of in pips.items():
        for u, v in places_of:
            paint(picture, np.hypot(x - (number - 1) - u, y - v) < 0.105, (0.85, 0.8, 0.7))
    return picture


def ball(width: int, height: int) -> Array:
    """Eight gores and two caps; float64[height, width, 3]."""
    x, y = places(width, height)
    picture = np.broadcast_to(CREAM, (height, width, 3)).copy()
    for gore, color in enumerate((TEAL, None, ORANGE, None, GOLD, None, RED, None)):
        if color is not None:
            paint(picture, (x >= gore / 8) & (x < (gore + 1) / 8), color)
    paint(picture, (y < 0.09) | (y > 0.91), NAVY)
    return picture


def backdrop(width: int, height: int) -> Array:
    """A painted canvas, lighter in its middle; float64[height, width, 3]."""
    x, y = places(width, height)
    glow = np.exp(-(((x - 0.52) / 0.16) ** 2 + ((y - 0.74) / 0.30) ** 2))
    mottled = smooth_noise(width, 3.6, 4)[:height]
    return mix((0.008, 0.014, 0.026), (0.19, 0.29, 0.32), np.clip(glow + 0.06 * mottled * glow, 0.0, 1.0))


def floor(side: int) -> tuple[Array, Array, Array]:
    """Two by two stone tiles that continue at each edge: linear colour [side, side, 3]; roughness [side, side]; normals as
    a picture has them [side, side, 3]."""
    x, y = places(side, side)
    dark_tile = (np.floor(2 * x) + np.floor(2 * y)) % 2 == 1
    veins = np.abs(smooth_noise(side, 2.2, 1)) ** 0.7
    cloud = smooth_noise(side, 2.6, 2)
    pale = np.array((0.46, 0.41, 0.35)) * (1.0 - 0.16 * np.exp(-14 * veins) + 0.05 * cloud)[..., None]
    dark = np.array((0.018, 0.024, 0.032)) * (1.0 + 0.2 * cloud)[..., None]
    dark += np.array((0.07, 0.065, 0.06)) * np.exp(-30 * veins)[..., None]
    color = np.where(dark_tile[..., None], dark, pale)
    # Distance to the nearest joint, in tiles.
    joint = np.minimum(*(0.5 - np.abs((2 * axis) % 1.0 - 0.5) for axis in (x, y)))
    grout = 1.0 - np.clip((joint - 0.004) / 0.006, 0.0, 1.0)
    color = color * (1 - grout[..., None]) + np.array((0.06, 0.055, 0.05)) * grout[..., None]
    roughness = np.where(dark_tile, 0.10, 0.14) + 0.02 * smooth_noise(side, 2.4, 3)
    roughness = np.clip(roughness + 0.5 * grout, 0.05, 1.0)
    height = 0.6 * np.clip(joint / 0.02, 0.0, 1.0) ** 0.5 / side
    slope = [(np.roll(height, -1, axis) - np.roll(height, 1, axis)) * side * 2 for axis in (1, 0)]
    # t grows upwards, rows downwards.
    normal = np.stack([-slope[0], slope[1], np.ones_like(height)], axis=-1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    return np.clip(color, 0.0, 1.0), roughness, 0.5 + 0.5 * normal


def studio(width: int, height: int) -> Array:
    """A room at dusk: a warm horizon, a blue ceiling, soft boxes; linear, float64[height, width, 3]. Directions are
    OpenEXR's: +z in the middle, +x to the left of it."""
    x, y = places(width, height)
    longitude, latitude = np.pi - 2 * np.pi * x, np.pi / 2 - np.pi * y
    up = np.sin(latitude)
    picture = mix((0.10, 0.14, 0.20), (0.045, 0.08, 0.15), np.clip(up, 0, 1))
    picture += np.array((0.22, 0.13, 0.07)) * np.exp(-((latitude - 0.05) ** 2) / 0.03)[..., None]
    picture *= np.where(up[..., None] < 0, np.exp(4 * up)[..., None], 1.0)
    # (degrees towards +x from +z, degrees up, half width, half height, colour)
    boxes = (
        (-52.0, 40.0, 22.0, 18.0, (3.4, 3.0, 2.4)),
        (68.0, 30.0, 10.0, 28.0, (1.9, 2.6, 3.7)),
        (-118.0, 24.0, 8.0, 22.0, (3.0, 1.6, 0.7)),
        (150.0, 34.0, 22.0, 7.0, (1.6, 2.3, 3.4)),
        (10.0, 74.0, 40.0, 9.0, (2.2, 2.3, 2.4)),
    )
    for east, north, wide, tall, color in boxes:
        across = np.abs((longitude - np.radians(east) + np.pi) % (2 * np.pi) - np.pi) / np.radians(wide)
        along = np.abs(latitude - np.radians(north)) / np.radians(tall)
        edge = np.clip((1.0 - np.maximum(across, along)) / 0.16, 0.0, 1.0)
        picture += np.array(color) * (edge**2 * (3 - 2 * edge))[..., None]
    return picture


def places(width: int, height: int) -> tuple[Array, Array]:
    """x from the left and y from the top of each pixel's middle, in [0, 1]; float64[height, width]."""
    x, y = np.meshgrid((np.arange(width) + 0.5) / width, (np.arange(height) + 0.5) / height)
    return x, y


def paint(picture: Array, where: Array, color: Sequence[float]) -> None:
    picture[where] = color


def mix(first: Sequence[float], second: Sequence[float], share: Array) -> Array:
    return np.array(first) * (1 - share[..., None]) + np.array(second) * share[..., None]


def smooth_noise(side: int, falloff: float, seed: int) -> Array:
    """Noise that continues at each edge: frequencies fall by 1 / f^(falloff / 2); a variance of 1."""
    random = np.random.default_rng(seed)
    frequency = np.hypot(*np.meshgrid(np.fft.fftfreq(side, 1 / side), np.fft.fftfreq(side, 1 / side)))
    weight = np.where(frequency > 0, np.maximum(frequency, 1.0) ** (-falloff / 2) * np.exp(-frequency / 90), 0.0)
    found = np.fft.ifft2(np.fft.fft2(random.standard_normal((side, side))) * weight).real
    return found / found.std()


def srgb(linear: Array) -> Array:
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 0.0031308) ** (1 / 2.4) - 0.055)


def write(path: Path, picture: Array) -> None:
    """8 bits, or half floats for EXR; rows from the top."""
    height, width, channels = picture.shape
    spec = oiio.ImageSpec(width, height, channels, "half" if path.suffix == ".exr" else "uint8")
    spec.attribute("compression", {".jpg": "jpeg:88", ".exr": "zip"}.get(path.suffix, "zip:9"))
    if path.suffix == ".exr":
        spec.attribute("DateTime", "2026:11:28 00:00:00")  # Else the time of writing, and other bytes.
    file = oiio.ImageOutput.create(str(path))
    if not file or not file.open(str(path), spec):
        raise SystemExit(f"make_textures: error: {path}: {oiio.geterror()}")
    file.write_image(np.ascontiguousarray(np.clip(picture, 0.0, None), np.float32))
    file.close()


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent)
