"""How far a motion turns within the shutter, bounded by what is known of its ops: the rate at which it must be sampled.

A motion that is sampled at even times alone may be back where it was at each of them: a rotor that makes four whole
turns looks still at halves and quarters of the shutter. The ops say how far they turn, whatever the samples show.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from pxr import Usd, UsdGeom

from ..base.errors import Diagnostics
from ..stage.values import might_vary, raw
from .times import Shutter, breakpoints_of, loop_length
from .xform_ops import may_vary, ordered_ops

FEWEST_REPEATS, MOST_REPEATS = 2.0, 512.0
"""Motion that repeats so often in the shutter is kept as one period (is_period() in delegate/translate/time_layout.h)."""
_SPLINE_PARTS = 32
"""Into how many parts a spline is split between two knots: a cubic turns back twice at most."""
_SAME_RATE = 1e-9
"""Rates that differ by less, relative to the rate, are one: what sums of time codes round."""

_SAME_TIME01 = 1e-12
"""Times that are nearer are one: the translator's kSameTime."""

_ROTATIONS = frozenset(
    getattr(UsdGeom.XformOp, f"TypeRotate{axes}") for axes in ("X", "Y", "Z", "XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX")
)


@dataclass(frozen=True)
class Turns:
    """An upper bound on the whole turns that a motion has made since the shutter opened."""

    times01: np.ndarray
    """float64[T], increasing from 0 to 1."""
    total: np.ndarray
    """float64[T], from 0 on, not decreasing; linear between the times."""
    periods01: tuple[float, ...] = ()
    """Shares of the shutter after which the motion may repeat."""

    def __add__(self, other: Turns) -> Turns:
        """Of a product of both motions."""
        if self is NO_TURNS or other is NO_TURNS:
            return other if self is NO_TURNS else self
        times01 = np.union1d(self.times01, other.times01)
        total = self.at(times01) + other.at(times01)
        return Turns(times01, total, tuple(sorted({*self.periods01, *other.periods01})))

    def at(self, times01: np.ndarray) -> np.ndarray:
        """float64[N]: turns made by then."""
        return np.interp(times01, self.times01, self.total)

    def within(self, ends01: np.ndarray) -> np.ndarray:
        """float64[N - 1]: turns between neighbours of float64[N] increasing times, as if each stretch had throughout
        the largest rate that occurs in it: how fast it is to be sampled evenly."""
        if len(self.times01) == 2:
            return self.total[-1] * np.diff(ends01)
        times01 = np.union1d(self.times01, ends01)
        lengths = np.diff(times01)
        # Between times that differ by rounding alone there is no rate.
        rates = np.where(lengths > _SAME_TIME01, np.diff(self.at(times01)) / lengths, 0.0)
        stretch = np.clip(np.searchsorted(ends01, times01[:-1], side="right") - 1, 0, len(ends01) - 2)
        most = np.zeros(len(ends01) - 1)
        np.maximum.at(most, stretch, rates)
        return most * np.diff(ends01)

    @property
    def rate(self) -> float:
        """Turns a shutter at the fastest."""
        return float(self.within(np.array([0.0, 1.0]))[0])


NO_TURNS = Turns(np.array([0.0, 1.0]), np.zeros(2))


MOST_FOLLOWED = 2048.0
"""Turns of a camera or a light: as many as have eight evaluations each (MOST_EVEN_LEVEL)."""


def report_too_fast(turns: Turns, path: str, diagnostics: Diagnostics) -> None:
    """Says so where a camera or a light turns faster than it is evaluated."""
    if turns.rate > MOST_FOLLOWED:
        message = (
            f"turns {turns.rate:g} times within the shutter, expected at most {MOST_FOLLOWED:g}; not followed exactly"
        )
        diagnostics.warning(path, "xformOpOrder", message)


def uniform_turns(turns: float) -> Turns:
    """At a constant rate."""
    if not (math.isfinite(turns) and turns > 0.0):
        return NO_TURNS
    periods01 = (1.0 / turns,) if FEWEST_REPEATS <= turns <= MOST_REPEATS else ()
    return Turns(np.array([0.0, 1.0]), np.array([0.0, turns]), periods01)


def total_turns(parts: Iterable[Turns]) -> Turns:
    """Of a product of motions."""
    result = NO_TURNS
    for part in parts:
        result = result + part
    return result


def xform_turns(xformable: UsdGeom.Xformable, shutter: Shutter) -> Turns:
    """Of a prim's own ops over its shutter."""
    if not shutter.moving or not may_vary(xformable):
        return NO_TURNS
    return total_turns(_op_turns(op, shutter) for op in ordered_ops(xformable))


def _op_turns(op: UsdGeom.XformOp, shutter: Shutter) -> Turns:
    attribute, kind = op.GetAttr(), op.GetOpType()
    if kind == UsdGeom.XformOp.TypeOrient:
        return _of_orientations(attribute, shutter) if might_vary(attribute) else NO_TURNS
    if kind in _ROTATIONS:
        return _of_angles(attribute, shutter) if might_vary(attribute) else NO_TURNS
    loops = _loop_periods(attribute, shutter)
    return Turns(NO_TURNS.times01, NO_TURNS.total, loops) if loops else NO_TURNS


def _times(attribute: Usd.Attribute, shutter: Shutter) -> np.ndarray:
    """Time codes of the shutter between which a value runs evenly enough to be bounded by its ends."""
    ends = np.unique([shutter.interval.min, *breakpoints_of(attribute, shutter), shutter.interval.max])
    if not attribute.HasSpline():
        return ends
    parts = np.arange(_SPLINE_PARTS) / _SPLINE_PARTS
    inner = (ends[:-1, None] + np.diff(ends)[:, None] * parts).ravel()
    return np.unique(np.append(inner, ends[-1]))


def _values(attribute: Usd.Attribute, times: np.ndarray) -> np.ndarray | None:
    """float64[T, K]; None where a value is missing or is not finite, which others report."""
    found = [raw(attribute, time) for time in times.tolist()]
    if any(value is None for value in found):
        return None
    if found and hasattr(found[0], "GetReal"):
        found = [(value.GetReal(), *value.GetImaginary()) for value in found]
    try:
        values = np.array(found, np.float64).reshape(len(found), -1)
    except (TypeError, ValueError):
        return None
    return values if np.isfinite(values).all() else None


def _of_angles(attribute: Usd.Attribute, shutter: Shutter) -> Turns:
    """Degrees about one axis or three."""
    if not attribute.HasSpline() and not attribute.GetTimeSamplesInInterval(shutter.interval):
        return _of_two_angles(attribute, shutter)
    loops = (shutter.close - shutter.open) / loop_length(attribute.GetSpline()) if attribute.HasSpline() else 0.0
    if loops > MOST_REPEATS:
        return uniform_turns(loops)  # More knots than are worth looking at; each loop may turn as far as it likes.
    times = _times(attribute, shutter)
    degrees = _values(attribute, times)
    if degrees is None:
        return NO_TURNS
    times01 = _clamped(times, shutter)
    steps = np.diff(degrees, axis=0) / 360.0
    total = np.concatenate([[0.0], np.cumsum(np.abs(steps).sum(axis=1))])
    if total[-1] == 0.0:
        return NO_TURNS
    periods = {*_loop_periods(attribute, shutter)}
    rates = steps / np.diff(times01)[:, None]
    for rate, turned in zip(rates.T, np.abs(degrees[-1] - degrees[0]) / 360.0, strict=True):
        if FEWEST_REPEATS <= turned <= MOST_REPEATS and np.ptp(rate) <= _SAME_RATE * turned:
            periods.add(1.0 / turned)
    return Turns(times01, total, tuple(sorted(periods)))


def _of_two_angles(attribute: Usd.Attribute, shutter: Shutter) -> Turns:
    """Where nothing but the ends counts, as for most prims that turn."""
    first, last = raw(attribute, shutter.interval.min), raw(attribute, shutter.interval.max)
    try:
        steps = [last - first] if isinstance(first, float) else [b - a for a, b in zip(first, last, strict=True)]
        turned = [abs(step) / 360.0 for step in steps]
    except TypeError:
        return NO_TURNS
    if not 0.0 < sum(turned) < math.inf:
        return NO_TURNS
    periods01 = sorted(1.0 / turns for turns in turned if FEWEST_REPEATS <= turns <= MOST_REPEATS)
    return Turns(NO_TURNS.times01, np.array([0.0, sum(turned)]), tuple(periods01))


def _of_orientations(attribute: Usd.Attribute, shutter: Shutter) -> Turns:
    """Quaternions, interpolated along the shorter arc: half a turn between two samples at most."""
    times = _times(attribute, shutter)
    values = _values(attribute, times)
    if values is None:
        return NO_TURNS
    lengths = np.linalg.norm(values, axis=1, keepdims=True)
    unit = values / np.where(lengths > 0.0, lengths, 1.0)
    cosines = np.clip(np.abs((unit[1:] * unit[:-1]).sum(axis=1)), 0.0, 1.0)
    total = np.concatenate([[0.0], np.cumsum(np.arccos(cosines) / np.pi)])
    return Turns(_clamped(times, shutter), total) if total[-1] > 0.0 else NO_TURNS


def _clamped(times: np.ndarray, shutter: Shutter) -> np.ndarray:
    """As time01; the ends exactly 0 and 1."""
    times01 = np.array([shutter.time01(time) for time in times.tolist()])
    times01[0], times01[-1] = 0.0, 1.0
    return times01


def _loop_periods(attribute: Usd.Attribute, shutter: Shutter) -> tuple[float, ...]:
    if not attribute.HasSpline():
        return ()
    period01 = loop_length(attribute.GetSpline()) / (shutter.close - shutter.open)
    return (period01,) if 1.0 / MOST_REPEATS <= period01 <= 1.0 / FEWEST_REPEATS else ()
