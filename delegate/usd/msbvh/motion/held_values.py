"""Values over the shutter that are no motion. Integers and tokens hold until their next sample: what they select is
drawn in parts, each visible for as long as they last."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from pxr import Usd

from .._core import BEFORE_JUMP01, MOST_STRETCHES, held_stretches
from ..base.errors import Diagnostics
from ..stage.values import might_vary, raw
from .times import Shutter
from .visibility import steps

_SPLINE_PROBES = 9


@dataclass(frozen=True)
class Stretch:
    """Parts of the shutter over which some attributes keep their values."""

    code: Usd.TimeCode
    """Where to read them."""
    shown: np.ndarray | None = None
    """float64[K, 2]: [begin, end) in time01 of the prim's own shutter; None: all of it."""


def stretches(attributes: Sequence[Usd.Attribute], shutter: Shutter, diagnostics: Diagnostics) -> list[Stretch]:
    """Where the attributes together have which values, in the order of their first appearance. `shutter`: the prim's
    own. Too many are one, the frame's, with a warning.

    What does not change within the shutter is read at its opening: the frame may lie outside of it.
    """
    varying = [attribute for attribute in attributes if might_vary(attribute)]
    if not shutter.moving or not varying:
        return [Stretch(shutter.frame_code)]
    begins = sorted(set().union(*(steps(attribute, shutter) for attribute in varying)))
    found: list[list[Any]] = []
    kinds = []
    for begin in begins:
        values = [raw(attribute, begin) for attribute in varying]
        if values not in found:
            found.append(values)
        if len(found) > MOST_STRETCHES:
            _warn_of_many(varying, shutter, diagnostics)
            return [Stretch(shutter.frame_code)]
        kinds.append(found.index(values))
    parts = held_stretches([shutter.time01(begin) for begin in begins], kinds)
    return [Stretch(Usd.TimeCode(begins[first]), shown) for first, shown in parts]


def _warn_of_many(attributes: Sequence[Usd.Attribute], shutter: Shutter, diagnostics: Diagnostics) -> None:
    for attribute in attributes:
        if changes_within(attribute, shutter):
            message = f"found more values within the shutter, expected at most {MOST_STRETCHES}; held the frame's"
            diagnostics.warning(str(attribute.GetPrimPath()), attribute.GetName(), message)


def values_within(attribute: Usd.Attribute, shutter: Shutter) -> list[Any]:
    """The values at which an attribute of any type changes its course over the open shutter, the frame's alone where
    nothing moves. What begins at the closing is not seen."""
    if not shutter.moving or not might_vary(attribute):
        return [raw(attribute, shutter.frame_code)]
    opening, closing = shutter.interval.min, shutter.interval.max
    times = [time for time in attribute.GetTimeSamplesInInterval(shutter.interval) if opening < time < closing]
    if attribute.HasSpline():
        times = np.linspace(opening, closing, _SPLINE_PROBES)[:-1].tolist()
    codes = [Usd.TimeCode(opening), *map(Usd.TimeCode, times), shutter.time_code(1.0 - BEFORE_JUMP01)]
    return [raw(attribute, code) for code in codes]


def any_but(neutral: Any, attribute: Usd.Attribute, shutter: Shutter) -> bool:
    """Whether an attribute has another value than the neutral one anywhere in the shutter, or one of a type that is
    never neutral: False is no 0.0, and an empty string names no asset. Where it has none its default counts, which is
    neutral."""
    found = [value for value in values_within(attribute, shutter) if value is not None]
    alike = (int, float) if isinstance(neutral, float) else type(neutral)
    return any(
        value != neutral or not isinstance(value, alike) or isinstance(value, bool) is not isinstance(neutral, bool)
        for value in found
    )


def changes_within(attribute: Usd.Attribute, shutter: Shutter) -> bool:
    """Whether an attribute of any type has more than one value over the open shutter."""
    first, *others = values_within(attribute, shutter)
    return any(value != first for value in others)


def warn_of_change(attribute: Usd.Attribute, why: str, shutter: Shutter, diagnostics: Diagnostics) -> None:
    """Names what is read at the frame alone, where it changes within the shutter; `why` it is."""
    if attribute and changes_within(attribute, shutter):
        message = f"changes within the shutter; held the frame's value{why}"
        diagnostics.group(str(attribute.GetPrimPath()), attribute.GetName(), message)
