"""The part of _core that holds rules of a frame which front-ends share (delegate/translate/frame)."""

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

def lenses_of(path: str, at_frame: Optics, over: list[Optics]) -> tuple[F32, list[Diagnostic]]:
    """float32[T, 2]: radius and focus distance of each, by what UsdGeomCamera says of depth of field."""

def intervals_between(begins01: list[float]) -> F64:
    """float64[K, 2]: from each time until the next; the last one ends behind the closing."""

def common_intervals(a: F64 | None, b: F64 | None) -> F64 | None:
    """float64[K, 2]: where both are visible; None is everywhere."""
