"""A stage's own numbers, checked: a layer may hold anything where a rate is expected."""

from __future__ import annotations

import math

from pxr import Usd

from .errors import Diagnostics
from .values import diagnostics

USUAL_RATE = 24.0
"""USD's fallback."""
LARGEST_RATE = 1e6
"""Beyond any camera; and what image formats keep as a fraction of 32 bits."""


def time_codes_per_second(stage: Usd.Stage) -> float:
    """Above 0; USD's fallback, with a warning, where the stage says nothing of sense."""
    return _rate(stage.GetTimeCodesPerSecond(), "timeCodesPerSecond", diagnostics())


def frames_per_second(stage: Usd.Stage, report: Diagnostics) -> float:
    """The same of what image files are told."""
    return _rate(stage.GetFramesPerSecond(), "framesPerSecond", report)


def _rate(found: float, name: str, report: Diagnostics) -> float:
    if 1.0 / LARGEST_RATE <= found <= LARGEST_RATE:
        return found
    expected = f"expected a number from {1.0 / LARGEST_RATE:g} to {LARGEST_RATE:g}"
    report.warning("", name, f"found {found:g}, {expected}; took {USUAL_RATE:g}")
    return USUAL_RATE


def finite_time(stage: Usd.Stage) -> float:
    """The stage's start time; 0 where that is no number."""
    start = stage.GetStartTimeCode()
    return start if math.isfinite(start) else 0.0
