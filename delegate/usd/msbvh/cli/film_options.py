"""The options of `msbvh record` that say how samples are spread over pixels and the shutter, with what each costs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import click

from .. import _core
from ..render.film import Film
from .option_types import ShutterCurve
from .options import Decorator, finite


def _width(ctx: click.Context, param: click.Parameter, value: float | None) -> float | None:
    return None if value is None else finite(ctx, param, value)


def _check_slices(slices: int, options: dict[str, Any]) -> None:
    """Raises UsageError for what cannot be kept in parts that have as many samples each."""
    if options["spp"] % slices:
        raise click.UsageError(
            f"--shutter-slices {slices}: found --spp {options['spp']}, expected a multiple of {slices}"
        )
    if options["sampler"] != "sobol":
        raise click.UsageError("--shutter-slices: expected --sampler sobol, which puts as many samples in each")
    if options["rolling_shutter"] > 0.0:
        raise click.UsageError("--shutter-slices and --rolling-shutter exclude each other")
    if options["target_flip"] is not None or options["time_budget"] is not None:
        raise click.UsageError("--shutter-slices excludes --target-flip and --time-budget: expected --spp")


SLICE_COUNTS = tuple(str(2**k) for k in range(1, _core.MOST_SHUTTER_SLICES.bit_length()))
MANY = ", ".join(SLICE_COUNTS)

FILM: Sequence[Decorator] = (
    click.option(
        "--pixel-filter",
        type=click.Choice(_core.PIXEL_FILTERS),
        default="box",
        show_default=True,
        help="How much of the light around a pixel's centre counts for it. Samples are drawn from the filter, so that all count"
        " alike; wider ones are smoother, at the same cost.",
    ),
    click.option(
        "--filter-width",
        type=click.FloatRange(0.0, _core.MOST_FILTER_WIDTH, min_open=True),
        callback=_width,
        metavar="PIXELS",
        help="Width of the pixel filter. Default: box 1, triangle 2, gaussian 2, blackman-harris 3.",
    ),
    click.option(
        "--shutter-curve",
        type=ShutterCurve(),
        default="box",
        show_default=True,
        metavar="NAME|FILE",
        help=f"How the shutter opens and closes: {', '.join(_core.SHUTTER_CURVES)}, or a file of rows 'time01 weight' (or JSON,"
        " [[time01, weight], ...]), linear between them, 0 to 1 being the open shutter. Times are drawn from it, at no cost.",
    ),
    click.option(
        "--rolling-shutter",
        type=click.FloatRange(0.0, 1.0),
        callback=finite,
        default=0.0,
        show_default=True,
        metavar="DURATION",
        help="Expose rows one after another, from the top: the lowest begins later than the uppermost by this share of the"
        " shutter, and each is exposed for the rest of it. 1: each row sees one moment.",
    ),
    click.option(
        "--shutter-slices",
        type=click.Choice(SLICE_COUNTS),
        metavar="N",
        help=f"Keep N equal parts of the shutter as layers of the .exr files, 32-bit floats, for `msbvh reshutter`: {MANY}."
        " --spp must be a multiple of N. --shutter-curve then weights the parts, and samples stay where they are. Costs the"
        " memory and the bytes of N pictures.",
    ),
)
"""How samples are spread."""


def film_of(options: dict[str, Any]) -> Film:
    slices = int(options["shutter_slices"] or 0)
    if slices:
        _check_slices(slices, options)
    return Film(
        shutter_slices=slices,
        pixel_filter=options["pixel_filter"],
        filter_width=options["filter_width"],
        shutter_curve=options["shutter_curve"],
        rolling_shutter=options["rolling_shutter"],
    )
