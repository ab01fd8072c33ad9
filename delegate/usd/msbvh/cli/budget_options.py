"""A blur budget, as options: an error or a time that a frame keeps."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import click

from ..render.budget import Goals
from .options import Decorator


class Quantity(click.ParamType):
    """A positive number, with or without its unit: 0.25px, 40s."""

    name = "quantity"

    def __init__(self, unit: str, example: str) -> None:
        self._unit = unit
        self._example = example

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        text = str(value).strip()
        try:
            number = float(text.removesuffix(self._unit))
        except ValueError:
            number = -1.0
        if not 0.0 < number < float("inf"):
            self.fail(f"found '{value}', expected more than 0, such as {self._example}", param, ctx)
        return number


GOALS: Sequence[Decorator] = (
    click.option(
        "--target-error",
        type=Quantity("px", "0.25px"),
        metavar="PIXELS",
        help="Pick the cheapest settings that keep each prim's motion and shape within so many pixels, such as 0.25px.",
    ),
    click.option(
        "--target-flip",
        type=Quantity("", "0.02"),
        metavar="FLIP",
        help="Pick as many samples as make the picture's mean HDR-FLIP error no larger, such as 0.02.",
    ),
    click.option(
        "--time-budget",
        type=Quantity("s", "40s"),
        metavar="SECONDS",
        help="Pick the settings with the least error that render the frame in so many seconds, such as 40s.",
    ),
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
