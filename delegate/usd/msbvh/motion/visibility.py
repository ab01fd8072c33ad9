"""Visibility over the shutter. Tokens are held: from a sample's time until the next one's."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from pxr import Usd, UsdGeom

from .. import _core
from ..stage.value_types import TOKEN
from ..stage.values import might_vary, value
from .times import Shutter


def changes_inside(visibility: Usd.Attribute, shutter: Shutter) -> bool:
    """Whether a visibility changes inside the shutter, for more than its last instant."""
    if not shutter.moving or not might_vary(visibility):
        return False
    return len({value(visibility, time, TOKEN) for time in steps(visibility, shutter)}) > 1


def visible_at_opening(visibility: Usd.Attribute, shutter: Shutter) -> bool:
    """Whether what does not change inside the shutter is visible. The frame may lie outside of it, or be its last
    instant, where something else may hold already."""
    time = Usd.TimeCode(shutter.interval.min) if shutter.moving else shutter.frame_code
    return value(visibility, time, TOKEN) != UsdGeom.Tokens.invisible


def steps(visibility: Usd.Attribute, shutter: Shutter) -> list[float]:
    """Time codes from which on a value holds, the opening's first."""
    inside = visibility.GetTimeSamplesInInterval(shutter.interval)
    opening, closing = shutter.interval.min, shutter.interval.max
    return sorted({opening, *(time for time in inside if time < closing)})


def visible_intervals(visibilities: Sequence[Usd.Attribute], shutter: Shutter) -> np.ndarray | None:
    """float64[K, 2]: the parts [begin, end) of the shutter, as time01, in which all of them are visible.

    None where nothing changes. The last one ends behind the closing where that is part of it.
    """
    changing = [visibility for visibility in visibilities if changes_inside(visibility, shutter)]
    if not changing:
        return None
    begins = sorted(set().union(*(steps(visibility, shutter) for visibility in changing)))
    shown = [
        all(value(visibility, begin, TOKEN) != UsdGeom.Tokens.invisible for visibility in changing) for begin in begins
    ]
    return intervals_between(begins, shutter)[shown]


def intervals_between(begins: Sequence[float], shutter: Shutter) -> np.ndarray:
    """float64[K, 2]: from each time code until the next, as time01. The last one ends behind the closing, which is
    part of it."""
    return _core.intervals_between([shutter.time01(begin) for begin in begins])


def common_intervals(a: np.ndarray | None, b: np.ndarray | None) -> np.ndarray | None:
    """Where both are visible; None is everywhere."""
    return _core.common_intervals(a, b)
