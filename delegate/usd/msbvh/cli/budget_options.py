"""A blur budget, as options: an error or a time that a frame keeps."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import click

from ..render.budget import MOST_SAMPLES, Goals
from ..render.sample_sum import MERGES
from .options import Decorator


class Quantity(click.ParamType):
    """A positive number, with or without its unit: 0.25px, 40s."""

    name = "quantity"

    def __init__(self, unit: str, example: str, least: float = 0.0, most: float = math.inf) -> None:
        """Values are above `least` and up to `most`, or below it where it is infinite."""
        self._unit = unit
        self._example = example
        self._least = least
        self._most = most

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        text = str(value).strip()
        try:
            number = float(text.removesuffix(self._unit))
        except ValueError:
            number = -1.0
        if not self._least < number <= self._most or math.isinf(number):
            most = "" if math.isinf(self._most) else f" and at most {self._most:g}"
            self.fail(f"found '{value}', expected more than {self._least:g}{most}, such as {self._example}", param, ctx)
        return number


def _target_error(text: str) -> Decorator:
    return click.option("--target-error", type=Quantity("px", "0.25px"), metavar="PIXELS", help=text)


def _target_flip(text: str) -> Decorator:
    return click.option("--target-flip", type=Quantity("", "0.02", 1e-4, 1.0), metavar="FLIP", help=text)


def _time_budget(text: str) -> Decorator:
    return click.option("--time-budget", type=Quantity("s", "40s"), metavar="SECONDS", help=text)


_KEEP_ERROR = (
    "Pick the cheapest tracks, and the longest edges of surfaces, that keep each prim's motion and shape within so many pixels,"
    " such as 0.25px."
)
_KEEP_FLIP = (
    "Pick as many samples, {most} at most, as make the noise no larger by mean HDR-FLIP, such as 0.02. Motion, shape and path"
    " depth are not in it."
).format(most=f"{MOST_SAMPLES:,}")

GOALS: Sequence[Decorator] = (
    _target_error(_KEEP_ERROR),
    _target_flip(_KEEP_FLIP),
    _time_budget(
        "Take as many samples as fit into so many seconds a frame, from reading it to its file, such as 40s. Other settings stay."
    ),
)
"""Of `record`."""

REPORTED_GOALS: Sequence[Decorator] = (
    _target_error(_KEEP_ERROR),
    _target_flip(_KEEP_FLIP),
    _time_budget(
        "Pick, of all settings that were measured, those with the least error that render the frame in so many seconds, such as"
        " 40s, with as many samples as then fit."
    ),
)
"""Of `accuracy`."""


def check_mergeable(aovs: Sequence[str], goals: Goals) -> None:
    """Raises UsageError for AOVs of which ranges of samples make no whole, where goals decide how many samples there are."""
    whole = [name for name in aovs if MERGES[name] == "coverage"]
    if whole and goals.decide_samples:
        raise click.UsageError(
            f"--aov {whole[0]} excludes --target-flip and --time-budget: its parts do not add up; expected --spp"
        )


def goals_from(ctx: click.Context) -> Goals:
    """Of a command with these options. Raises UsageError where another option decides the same."""
    goals = Goals(ctx.params["target_error"], ctx.params["target_flip"], ctx.params["time_budget"])
    clashes = []
    if goals.error_px is not None:
        clashes += [("--target-error", name) for name in ("motion_tolerance", "segments", "edge_length", "complexity")]
    if goals.decide_samples:
        option = "--target-flip" if goals.flip is not None else "--time-budget"
        clashes += [(option, "spp")]
    for option, name in clashes:
        if ctx.get_parameter_source(name) is click.core.ParameterSource.COMMANDLINE:
            raise click.UsageError(f"{option} and --{name.replace('_', '-')} exclude each other: both decide the same")
    return goals
