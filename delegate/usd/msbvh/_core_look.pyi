"""The part of _core that says what cameras' optics and lights' inputs mean, and what lights give over the shutter
(delegate/translate/look)."""

from collections.abc import Sequence
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from ._core_sample import MotionSource

F32 = NDArray[np.float32]
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

def exposure_scale(stops: float, time_seconds: float, iso: float, f_stop: float, responsivity: float) -> float:
    """What a camera multiplies light by (UsdGeomCamera's exposure attributes); not finite where they make no sense."""

def converted_colors(colors: F32, from_space: str, to_space: str) -> F32:
    """A copy of float32[N, 3] from one colour space of OpenColorIO's built-in config to another; raw and data: as they
    are; empty: linear Rec.709. Raises Error where one is none."""

LIGHT_NUMBERS: dict[str, float]
"""Inputs of lights that are numbers and may change inside the shutter, by their names behind ``inputs:``, with the values
of lights that have none: sizes (angle, radius, width, height, length), shaping, multipliers. Degrees and stage units."""

def light_emission(intensity: float, exposure: float, color: Rgb, temperature: Rgb) -> Rgb:
    """intensity * 2^exposure * color * the black body's colour."""

def light_normalization(kind: str, numbers: Sequence[float], world_from_light: F64) -> float:
    """What inputs:normalize divides by. ``numbers``: in the order of LIGHT_NUMBERS; the last ones may be left out."""

def is_similarity(matrix: F64) -> bool:
    """Whether float64[4, 4] scales lengths evenly and keeps angles; true of NaN, which others report."""

class LightPicture:
    """The image of a dome or a rect light, with what it takes to sample it."""

    @property
    def size(self) -> tuple[int, int]:
        """Width and height, of a smaller one where it was too large."""
    @property
    def mended(self) -> int:
        """Texels that were not finite: NaN counts as 0, infinity as 65504."""

def light_picture(name: str, map: str, texels: F32) -> LightPicture:
    """``texels`` float32[H, W, 3], linear, the uppermost row first. ``map``: rect, latlong, angular or mirroredBall.
    Raises Error where there are none."""

class IesProfile:
    """How the light of a luminaire is spread over directions."""

    @property
    def power(self) -> float:
        """The mean intensity over the directions that the file covers, the sphere or a half of it."""

def ies_profile(text: bytes) -> IesProfile:
    """Of an LM-63 file. Raises Error, which says what is wrong."""

class LightLook:
    """What of a light does not change over the shutter."""

    def __init__(self) -> None: ...
    def set_image(self, picture: LightPicture) -> None: ...
    def set_focus_tint(self, tint: Rgb) -> None: ...
    def set_ies(self, profile: IesProfile, angle_scale: float, normalize: bool) -> None: ...
    def set_shadow(self, enable: bool, color: Rgb, distance: float, falloff: float, falloff_gamma: float) -> None:
        """UsdLux's ShadowAPI."""
    def set_links(self, lit: Sequence[bool], shadowed: Sequence[bool]) -> None:
        """By light group: whether it illuminates it, and is shadowed by it; empty: all."""
    @property
    def has_image(self) -> bool: ...
    @property
    def has_ies(self) -> bool: ...
    @property
    def links(self) -> tuple[list[bool], list[bool]]: ...

class LightSamples:
    """A light's inputs at T times of the shutter."""

    def __init__(self, times01: F64, emission: F64, numbers: F64, normalize: Sequence[bool]) -> None:
        """float64[T], increasing; [T, 3], by light_emission(); [T, 10], in the order of LIGHT_NUMBERS; and as many
        flags."""

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
