"""Values of options that click has no type for."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import click

from .._core import FINEST_LEVEL, aov_names
from ..render.shutter_curve import Curve, CurveError, shutter_curve

SEGMENT_COUNTS = tuple(2**k for k in range(FINEST_LEVEL + 1))


def positive(ctx: click.Context, param: click.Parameter, value: float | None) -> float | None:
    """Ranges let nan and infinity pass; None: the option is not given."""
    if value is not None and not math.isfinite(value):
        raise click.BadParameter(f"found {value}, expected a finite number above 0", ctx, param)
    return value


class Names(click.ParamType):
    """Names separated by commas or blanks, as usdrecord takes them; with `choices`, only those."""

    name = "names"

    def __init__(self, choices: Sequence[str] = ()) -> None:
        self._choices = choices

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> tuple[str, ...]:
        names = tuple(value.replace(",", " ").split()) if isinstance(value, str) else tuple(value)
        for name in names:
            if self._choices and name not in self._choices:
                self.fail(f"found '{name}', expected any of: {', '.join(self._choices)}", param, ctx)
        return names


ALL_AOVS = "all"
UNREPEATED = ("seconds",)
"""AOVs that differ from run to run."""


class AovNames(Names):
    """Of AOVs; `all`: those that any run has alike."""

    def __init__(self) -> None:
        super().__init__((*aov_names(), ALL_AOVS))

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> tuple[str, ...]:
        names = super().convert(value, param, ctx)
        every = [name for name in aov_names() if name not in UNREPEATED]
        return tuple(dict.fromkeys(each for name in names for each in (every if name == ALL_AOVS else [name])))


class Numbers(click.ParamType):
    """Whole numbers from 0 on, separated by commas or blanks."""

    name = "numbers"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> tuple[int, ...]:
        numbers = tuple(value.replace(",", " ").split()) if isinstance(value, str) else tuple(value)
        for number in numbers:
            digits = str(number)
            if not digits.isdecimal() or len(digits) > 4 or int(digits) > 4096:
                self.fail(f"found '{number}', expected numbers of threads such as 1,0", param, ctx)
        if not numbers:
            self.fail("found no number, expected numbers of threads such as 1,0", param, ctx)
        return tuple(map(int, numbers))


class PowerOfTwo(click.ParamType):
    """A power of two up to the most segments that a track has."""

    name = "integer"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> int:
        try:
            number = int(value)
        except ValueError:
            number = -1
        if number not in SEGMENT_COUNTS:
            counts = ", ".join(map(str, SEGMENT_COUNTS))
            self.fail(f"found '{value}', expected a power of two: one of {counts}", param, ctx)
        return number


class ShutterRange(click.ParamType):
    """Opening and closing in frames relative to the frame, with a colon between them."""

    name = "shutter"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> tuple[float, float]:
        example = "such as -0.25:0.25"
        try:
            opening, closing = map(float, value.split(":")) if isinstance(value, str) else value
        except ValueError:
            self.fail(f"found '{value}', expected OPEN:CLOSE in frames relative to the frame, {example}", param, ctx)
        if closing < opening:
            self.fail(f"found '{value}', expected OPEN:CLOSE with CLOSE at or after OPEN, {example}", param, ctx)
        return opening, closing


class ShutterCurve(click.ParamType):
    """A curve by its name, or a file of one."""

    name = "curve"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Curve:
        if not isinstance(value, str):
            return tuple(value)
        try:
            return shutter_curve(value)
        except CurveError as error:
            self.fail(str(error), param, ctx)
