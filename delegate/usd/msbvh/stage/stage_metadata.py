"""A stage's own numbers, checked: a layer may hold anything where a rate is expected."""

from __future__ import annotations

import math

from pxr import Usd

from ..base.errors import Diagnostics, SceneError
from .values import diagnostics

USUAL_RATE = 24.0
"""USD's fallback."""
LARGEST_RATE = 1e6
"""Beyond any camera; and what image formats keep as a fraction of 32 bits."""


def time_codes_per_second(stage: Usd.Stage) -> float:
    """Above 0; USD's fallback, with a warning, where the stage says nothing of sense."""
    found = stage.GetTimeCodesPerSecond()
    if 1.0 / LARGEST_RATE <= found <= LARGEST_RATE:
        return found
    return _rate(found, "timeCodesPerSecond", diagnostics())


def frames_per_second(stage: Usd.Stage, report: Diagnostics) -> float:
    """The same for the frame rate in image files."""
    return _rate(stage.GetFramesPerSecond(), "framesPerSecond", report)


def _rate(found: float, name: str, report: Diagnostics) -> float:
    if 1.0 / LARGEST_RATE <= found <= LARGEST_RATE:
        return found
    expected = f"expected a number from {1.0 / LARGEST_RATE:g} to {LARGEST_RATE:g}"
    report.warning("", name, f"found {found:g}, {expected}; took {USUAL_RATE:g}")
    return USUAL_RATE


def start_time(stage: Usd.Stage) -> float:
    """The frame that is read where none is asked for. Raises SceneError for a start time that is no number."""
    start = stage.GetStartTimeCode()
    if not math.isfinite(start):
        raise SceneError(f"startTimeCode: found {start:g}, expected a finite number; --frames says another")
    return start
