"""The part of _core that says what cameras' optics and lights' inputs mean (delegate/translate/look)."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]
Window = tuple[float, float, float, float]
Rgb = tuple[float, float, float]

ASPECT_POLICIES: tuple[str, ...]
"""UsdRenderSettings' aspectRatioConformPolicy."""

class Optics:
    """UsdGeomCamera's attributes at a time. Apertures, their offsets and the focal length are in tenths of a stage
    unit."""

    projection: str
    """perspective or orthographic"""
    horizontal_aperture: float
    vertical_aperture: float
    horizontal_aperture_offset: float
    vertical_aperture_offset: float
    focal_length: float
    f_stop: float
    focus_distance: float
    @property
    def window(self) -> Window:
        """left, right, bottom, top of the image plane, at unit distance (perspective) or in stage units."""
    @property
    def lens(self) -> tuple[float, float]:
        """Radius and focus distance of a thin lens; radius 0: a pinhole."""

def conformed(window: Window, image_aspect: float, policy: str) -> tuple[Window, float]:
    """The window that fills an image of width / height = ``image_aspect``, and the width of a pixel over its height.
    Raises ValueError for an unknown policy."""

def image_height(width: int, aspect_ratio: float) -> int:
    """By usdrecord's rule: rounded down, never below one pixel."""

def light_emission(intensity: float, exposure: float, color: Rgb, temperature: Rgb) -> Rgb:
    """intensity * 2^exposure * color * the black body's colour."""

def light_normalization(kind: str, sizes: tuple[float, float, float, float], world_from_light: F64) -> float:
    """What inputs:normalize divides by. ``sizes``: angle in degrees, radius, width, height."""

def light_radiances(kind: str, emission: F64, sizes: F64, normalize: Sequence[bool], world_from_light: F64) -> F64:
    """float64[T, 3] from float64[T, 3], [T, 4], as many flags, and [T, 4, 4]."""
