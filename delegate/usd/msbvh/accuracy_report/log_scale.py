"""Logarithmic axes for measured figures: any range, zeros among them, labels as plain text."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

from matplotlib.axes import Axes

from .figures import number, power_of_ten

LEAST_RATIO = 1.6
"""Of an axis's ends: figures that are all alike stay close together."""
MARGIN = 0.06
"""Of the axis's length, beyond the outermost figures."""


LEAST_SHARE = 1e-12
"""The smallest figure that has a place of its own beside the largest, as a share of it: axes of more decades say nothing."""
LARGEST = 1e100
"""Whatever is more is no measured figure, and not drawn."""


@dataclass(frozen=True)
class LogScale:
    """Where figures stand on an axis."""

    low: float
    high: float
    least: float
    """The smallest figure that has a place of its own."""
    zero: float | None
    """The place of 0, which no logarithm has: below all others. None: no figure is 0."""
    zero_label: str = "0"

    @staticmethod
    def of(values: Iterable[object]) -> LogScale | None:
        """None where no value can be drawn: those are numbers of at least 0."""
        found = [value for value in map(drawable, values) if value is not None]
        if not found:
            return None
        floor = LEAST_SHARE * max(found)
        least, high = min((value for value in found if value > floor), default=1.0), max(found) or 1.0
        widen = max(1.0, math.sqrt(LEAST_RATIO * least / high))
        low, high = least / widen, high * widen
        small = [value for value in found if value <= floor]
        zero = None
        if small:
            low = zero = low / (high / low) ** 0.15 / 1.5
        pad = (high / low) ** MARGIN
        return LogScale(low / pad, high * pad, least, zero, "≈0" if any(small) else "0")

    def place(self, value: object) -> float | None:
        """Where a figure is drawn; None: nowhere."""
        found = drawable(value)
        return self.zero if found is not None and found < self.least else found

    def ticks(self, most: int) -> list[float]:
        """At most `most` round numbers: powers of ten, more of their multiples where that gives fewer than three, and
        even steps where the axis is short."""
        low = self.low if self.zero is None else 0.9 * self.least
        first, last = math.floor(math.log10(low)), math.ceil(math.log10(self.high))
        multiples: Sequence[Sequence[float]] = ((1,), (1, 3), (1, 2, 5))
        for each in multiples:
            found = [m * 10.0**e for e in range(first, last + 1) for m in each if low <= m * 10.0**e <= self.high]
            if len(found) >= 3:
                return found[:: math.ceil(len(found) / most)]
        steps = [m * 10.0**e for e in range(first - 2, last + 1) for m in (1, 2, 5)]
        step = next(step for step in steps if (self.high - low) / step <= most)
        return [i * step for i in range(math.ceil(low / step), math.floor(self.high / step) + 1) if i > 0]

    def labels(self, most: int) -> list[str]:
        """Of the ticks, from that of 0, if any."""
        zero = [] if self.zero is None else [self.zero_label]
        return [*zero, *map(_label, self.ticks(most))]

    def apply(self, axes: Axes, which: Literal["x", "y"], most: int) -> None:
        """To one side of a plot; `most` ticks at most, besides that of 0."""
        (axes.set_xscale if which == "x" else axes.set_yscale)("log")
        (axes.set_xlim if which == "x" else axes.set_ylim)(self.low, self.high)
        axis = axes.xaxis if which == "x" else axes.yaxis
        zero = [] if self.zero is None else [self.zero]
        axis.set_ticks([*zero, *self.ticks(most)], self.labels(most))
        axis.set_ticks([], minor=True)


def drawable(value: object) -> float | None:
    """A figure that an axis has a place for."""
    found = number(value)
    return found if found is not None and 0.0 <= found <= LARGEST else None


def _label(tick: float) -> str:
    if 1e-4 < tick < 1e6:
        return f"{tick:,.10g}"
    mantissa, _, exponent = f"{tick:.2e}".partition("e")
    power = power_of_ten(int(exponent))
    return power if float(mantissa) == 1.0 else f"{float(mantissa):g}×{power}"
