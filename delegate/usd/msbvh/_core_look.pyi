"""The part of _core that says what cameras' optics and lights' inputs mean, and what lights give over the shutter
(delegate/translate/look)."""

from collections.abc import Sequence
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from ._core_sample import MotionSource

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

def image_height(width: int, aspect_ratio: float) -> int:
    """By usdrecord's rule: rounded down, never below one pixel."""

LIGHT_SIZES: dict[str, float]
"""Inputs by which lights differ in size (angle, radius, width, height), with the values of those that have none. Degrees
and stage units."""

def light_emission(intensity: float, exposure: float, color: Rgb, temperature: Rgb) -> Rgb:
    """intensity * 2^exposure * color * the black body's colour."""

def light_normalization(kind: str, sizes: tuple[float, float, float, float], world_from_light: F64) -> float:
    """What inputs:normalize divides by. ``sizes``: angle in degrees, radius, width, height."""

def is_similarity(matrix: F64) -> bool:
    """Whether float64[4, 4] scales lengths evenly and keeps angles; true of NaN, which others report."""

class LightSamples:
    """A light's inputs at T times of the shutter."""

    def __init__(self, times01: F64, emission: F64, sizes: F64, normalize: Sequence[bool]) -> None:
        """float64[T], increasing; [T, 3], by light_emission(); [T, 4], in the order of LIGHT_SIZES; and as many flags."""

class SampledLight:
    """The values of a light over the shutter, wherever it stands."""

    @overload
    def __init__(self, at_frame: LightSamples) -> None:
        """Of one that is still."""
    @overload
    def __init__(
        self, at_frame: LightSamples, over_shutter: LightSamples, visible: Sequence[bool], shown: F64 | None
    ) -> None:
        """``over_shutter`` is read at value_times(); ``visible`` is what visibility says then, ``shown`` float64[K, 2]
        where its instances are visible (None: always)."""

def switch_times01(shown: F64 | None) -> list[float]:
    """Times inside the shutter at which instances appear or disappear."""

def light_times01(motion: MotionSource, held: bool) -> list[float]:
    """Where the transform of lights that move together is evaluated, for lines between."""

def placed_light(
    kind: str, light: SampledLight, motion: MotionSource, index: int, times01: Sequence[float], frame01: float
) -> dict[str, Any]:
    """The keywords of Translator.add_light of one of the motion's lights, but for name and kind. ``times01`` are
    light_times01()."""
