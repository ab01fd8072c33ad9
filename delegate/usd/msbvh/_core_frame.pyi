"""The part of _core that holds rules of a frame which front-ends share (delegate/translate/frame)."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ._core import Diagnostic
from ._core_look import Optics

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]

ABSURD_SHUTTER_FRAMES: float
"""A shutter that is open for longer is taken as authored, with a warning: one exporter writes the length of the shot."""

def checked_shutter(
    open_frames: float, close_frames: float, camera: str, hint: str
) -> tuple[tuple[float, float], list[Diagnostic]]:
    """Opening and closing relative to the frame; both 0 where they make no sense. ``hint``: how to open a closed one."""

def check_optics(path: str, optics: Optics, near_clip: float, far_clip: float) -> None:
    """Raises Error that names the camera, its attribute, what was found and what is expected."""

def checked_planes(path: str, planes: F64) -> tuple[F32, list[Diagnostic]]:
    """float32[P, 4]: clipping planes in camera space with unit normals, of float64[K, 4]. What is no plane is left out
    with a warning."""

def course_breakpoints01(breakpoints01: Sequence[float], held: bool) -> list[float]:
    """Of a camera, increasing: with the instants before them where it is held, since it jumps there."""

def lenses_of(path: str, at_frame: Optics, over: list[Optics]) -> tuple[F32, list[Diagnostic]]:
    """float32[T, 2]: radius and focus distance of each, by what UsdGeomCamera says of depth of field."""

def intervals_between(begins01: list[float]) -> F64:
    """float64[K, 2]: from each time until the next; the last one ends behind the closing."""

MOST_STRETCHES: int
"""Parts of the shutter that one thing is drawn in, at most: each is a mesh, or a set of instances, of its own."""

def held_stretches(begins01: list[float], kinds: list[int]) -> list[tuple[int, F64 | None]]:
    """Where values that may change at ``begins01`` are the same: the place of the time where they are met first, and
    float64[K, 2], the parts of the shutter, None for all of it. ``kinds``: one a time, equal where the values are that
    hold from there on. Empty for more than MOST_STRETCHES."""

def knots_within(authored01: list[float], shown: F64) -> list[float]:
    """The times between which values are linear in parts of the shutter: their beginnings, an instant before each end,
    and what is authored inside."""

def checked_scale(
    path: str, attribute: str, found: float, inherited: float, least: float
) -> tuple[float, list[Diagnostic]]:
    """A scale of UsdGeomMotionAPI that is a finite number of at least ``least``; else the inherited one, with a
    warning."""

def common_intervals(a: F64 | None, b: F64 | None) -> F64 | None:
    """float64[K, 2]: where both are visible; None is everywhere."""
