"""What an image says about its making: the camera's matrices, the shutter, the sampling."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np


@dataclass(frozen=True)
class ImageMetadata:
    """Matrices map row vectors (p' = p M), as in USD and in OpenEXR."""

    software: str
    frame: float | None
    """Time code; None: USD's default time."""
    frames_per_second: float
    shutter: tuple[float, float]
    """Open and close, in frames relative to the frame."""
    spp: int
    seed: int
    render_seconds: float
    world_to_camera: np.ndarray
    """float64[4, 4], OpenEXR's convention, see world_to_camera()."""
    world_to_ndc: np.ndarray
    """float64[4, 4], OpenEXR's convention, see world_to_ndc()."""
    pixel_aspect_ratio: float = 1.0
    """Width of a pixel over its height."""
    noise: float = 0.0
    """Relative error that decided how many samples each pixel has, spp at most; 0: all have spp."""
    min_spp: int = 0


def world_to_camera(world_from_camera: np.ndarray) -> np.ndarray:
    """OpenEXR's worldToCamera of a USD camera, both float64[4, 4].

    OpenEXR's camera space is left-handed and looks along +z (ImfStandardAttributes.h); USD's looks along -z.
    Raises numpy.linalg.LinAlgError for a singular camera.
    """
    return np.linalg.inv(world_from_camera) @ np.diag([1.0, 1.0, -1.0, 1.0])


def world_to_ndc(to_camera: np.ndarray, window: tuple[float, float, float, float], perspective: bool) -> np.ndarray:
    """OpenEXR's worldToNDC: (0, 0) is the upper left corner of the image, (1, 1) the lower right one.

    `to_camera` is float64[4, 4] from world_to_camera(); `window` is left, right, bottom, top of the image
    plane at unit distance (perspective) or in scene units. After the division by w, z is 1 for a perspective
    camera (depth is not part of NDC) and the distance for an orthographic one.
    """
    left, right, bottom, top = window
    from_camera = np.zeros((4, 4))
    from_camera[0, 0] = 1.0 / (right - left)
    from_camera[1, 1] = -1.0 / (top - bottom)
    from_camera[2, 2] = 1.0
    row = 2 if perspective else 3  # What is multiplied by w: the distance, or 1.
    from_camera[row, 0] = -left / (right - left)
    from_camera[row, 1] = top / (top - bottom)
    from_camera[row, 3] = 1.0
    return to_camera @ from_camera


def rational_rate(frames_per_second: float) -> tuple[int, int]:
    """A frame rate as a fraction; 23.976 and its kin become the NTSC rates that they mean, n * 1000 /
    1001. The rate lies within what stage_metadata.frames_per_second() allows."""
    ntsc = round(frames_per_second * 1.001)
    if abs(frames_per_second * 1.001 - ntsc) < 1e-3:
        return ntsc * 1000, 1001
    rate = Fraction(frames_per_second).limit_denominator(1000)
    return rate.numerator, rate.denominator
