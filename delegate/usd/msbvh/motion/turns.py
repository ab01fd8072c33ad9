"""How far a motion turns within the shutter, bounded by what is known of its ops: the rate at which it must be sampled.

A motion that is sampled at even times alone may be back where it was at each of them: a rotor that makes four whole
turns looks still at halves and quarters of the shutter. The ops say how far they turn, whatever the samples show.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from pxr import Usd, UsdGeom

from .._core import (
    MOST_REPEATS,
    MOST_TURNS_FOLLOWED,
    Turns,
    angle_turns,
    orientation_turns,
    uniform_turns,
    usable_periods01,
)
from ..base.errors import Diagnostics
from ..stage.values import might_vary, raw
from .times import Shutter, breakpoints_of, loop_length
from .xform_ops import may_vary, ordered_ops

_SPLINE_PARTS = 32
"""Into how many parts a spline is split between two knots: a cubic turns back twice at most."""
_ROTATIONS = frozenset(
    getattr(UsdGeom.XformOp, f"TypeRotate{axes}") for axes in ("X", "Y", "Z", "XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX")
)


NO_TURNS = Turns()


def report_too_fast(turns: Turns, path: str, diagnostics: Diagnostics) -> None:
    """Says so where a camera or a light turns faster than it is evaluated."""
    if turns.rate > MOST_TURNS_FOLLOWED:
        message = (
            f"turns {turns.rate:g} times within the shutter, expected at most {MOST_TURNS_FOLLOWED:g};"
            " not followed exactly"
        )
        diagnostics.warning(path, "xformOpOrder", message)


def total_turns(parts: Iterable[Turns]) -> Turns:
    """Of a product of motions."""
    result = NO_TURNS
    for part in parts:
        if part is not NO_TURNS:
            result = part if result is NO_TURNS else result + part
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
    loops = usable_periods01(_loop_periods(attribute, shutter))
    return Turns([0.0, 1.0], [0.0, 0.0], loops) if loops else NO_TURNS


def _times(attribute: Usd.Attribute, shutter: Shutter) -> np.ndarray:
    """Time codes of the shutter between which a value runs evenly enough to be bounded by its ends."""
    ends = np.unique([shutter.interval.min, *breakpoints_of(attribute, shutter), shutter.interval.max])
    if not attribute.HasSpline():
        return ends
    parts = np.arange(_SPLINE_PARTS) / _SPLINE_PARTS
    inner = (ends[:-1, None] + np.diff(ends)[:, None] * parts).ravel()
    return np.unique(np.append(inner, ends[-1]))


def _values(attribute: Usd.Attribute, times: np.ndarray) -> list[list[float]] | None:
    """One row a time, of as many numbers; None where a value is missing or is not finite, which others report."""
    found = [raw(attribute, time) for time in times.tolist()]
    if any(value is None for value in found):
        return None
    if found and hasattr(found[0], "GetReal"):
        found = [(*value.GetImaginary(), value.GetReal()) for value in found]
    try:
        values = np.array(found, np.float64).reshape(len(found), -1)
    except (TypeError, ValueError):
        return None
    return values.tolist() if np.isfinite(values).all() else None


def _of_angles(attribute: Usd.Attribute, shutter: Shutter) -> Turns:
    """Degrees about one axis or three."""
    if not attribute.HasSpline() and not attribute.GetTimeSamplesInInterval(shutter.interval):
        return _of_two_angles(attribute, shutter)
    loops = (shutter.close - shutter.open) / loop_length(attribute.GetSpline()) if attribute.HasSpline() else 0.0
    if loops > MOST_REPEATS:
        return uniform_turns(loops)  # More knots than are worth looking at; each loop may turn as far as it likes.
    times = _times(attribute, shutter)
    degrees = _values(attribute, times)
    if degrees is None or len(times) < 2:  # One time where the shutter's ends cannot be told apart.
        return NO_TURNS
    return _or_none(angle_turns(_clamped(times, shutter), degrees, _loop_periods(attribute, shutter)))


def _of_two_angles(attribute: Usd.Attribute, shutter: Shutter) -> Turns:
    """Where nothing but the ends counts, as for most prims that turn."""
    first, last = raw(attribute, shutter.interval.min), raw(attribute, shutter.interval.max)
    try:
        rows = [[first], [last]] if isinstance(first, float) else [[*first], [*last]]
        return _or_none(angle_turns([0.0, 1.0], rows))
    except (TypeError, ValueError):
        return NO_TURNS


def _of_orientations(attribute: Usd.Attribute, shutter: Shutter) -> Turns:
    """Quaternions, interpolated along the shorter arc: half a turn between two samples at most."""
    times = _times(attribute, shutter)
    values = _values(attribute, times)
    if values is None or len(times) < 2 or len(values[0]) != 4:
        return NO_TURNS
    return _or_none(orientation_turns(_clamped(times, shutter), values))


def _or_none(turns: Turns) -> Turns:
    return NO_TURNS if turns.none else turns


def _clamped(times: np.ndarray, shutter: Shutter) -> list[float]:
    """As time01; the ends exactly 0 and 1."""
    times01 = [shutter.time01(time) for time in times.tolist()]
    return [0.0, *times01[1:-1], 1.0]


def _loop_periods(attribute: Usd.Attribute, shutter: Shutter) -> list[float]:
    return [loop_length(attribute.GetSpline()) / (shutter.close - shutter.open)] if attribute.HasSpline() else []
