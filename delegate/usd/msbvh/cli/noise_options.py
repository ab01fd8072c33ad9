"""The options of `msbvh record` that say when there are samples enough, and what is done about the noise that is left."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import click
from click.core import ParameterSource

from ..output.denoise import is_installed
from ..render.sampling import MOST_SLICES_OF_NOISE, SLICES_ARE_EVEN
from ..render_settings.asked import MOST_SPP_OF_NOISE
from .option_types import positive
from .options import MAX_SPP, Decorator

LARGEST_NOISE = 1.0

NOISE: Sequence[Decorator] = (
    click.option(
        "--noise",
        type=click.FloatRange(0.0, LARGEST_NOISE, min_open=True),
        callback=positive,
        metavar="TARGET",
        help="Take samples of each pixel until its error is about so large, as a share of its value: 0.05 is fine for a"
        " preview, 0.01 for a final. --spp is then the most that any pixel takes,"
        f" {MOST_SPP_OF_NOISE} where it is not given. Alpha's error is held to it too. Biased by stopping on what was seen;"
        " docs/design/noise.md says by how little.",
    ),
    click.option(
        "--min-spp",
        type=click.IntRange(1, MAX_SPP),
        default=32,
        show_default=True,
        help="With --noise: samples of each pixel before its noise is looked at, rounded up to a power of two from 32 on. More"
        " find small bright things that 32 miss.",
    ),
    click.option(
        "--time-limit",
        type=click.FloatRange(0.0, min_open=True),
        callback=positive,
        metavar="SECONDS",
        help="Take no more samples of a frame when so many seconds are over since it was begun to be read. At least 16 are"
        " taken, and all pixels have as many (without --noise); the file says how many, and --spp with that number renders"
        " the same picture. Costs memory, about 64 bytes a pixel.",
    ),
    click.option(
        "--clamp-indirect",
        type=click.FloatRange(0.0, 1e6, min_open=True),
        callback=positive,
        metavar="RADIANCE",
        help="Cut the indirect light of each sample off at this value, against single bright pixels. Biased: the picture loses"
        " light. Default: nothing is cut off.",
    ),
    click.option(
        "--denoise",
        is_flag=True,
        help="Also write the picture as Intel's Open Image Denoise leaves it, by albedo and normal: layer denoised of .exr"
        " files, beside the raw colour; .png, .jpg and .tif show it in place of the raw one. Needs the package pyoidn"
        " (pip install 'msbvh[denoise]') and a few seconds a frame.",
    ),
)
"""How noise ends."""


def check_noise(ctx: click.Context) -> None:
    """Raises UsageError where these options contradict others, or lack what they need. Sets how many samples there are at
    most."""
    options = ctx.params
    given = {name for name in options if ctx.get_parameter_source(name) is not ParameterSource.DEFAULT}
    if "min_spp" in given and "noise" not in given:
        raise click.UsageError("--min-spp: expected --noise, which decides how many samples there are beyond it")
    if options["noise"] is not None and "spp" not in given:
        options["spp"] = MOST_SPP_OF_NOISE
    if options["noise"] is not None and options["min_spp"] > options["spp"]:
        raise click.UsageError(f"--min-spp: found {options['min_spp']}, expected at most --spp, {options['spp']}")
    for name in ("noise", "time_limit"):
        if options[name] is not None:
            _check_alone(f"--{name.replace('_', '-')}", options)
    if options["denoise"] and not is_installed():
        raise click.UsageError("--denoise: found no package pyoidn; expected it: pip install 'msbvh[denoise]'")


def _check_alone(option: str, options: dict[str, Any]) -> None:
    for other in ("target_flip", "time_budget"):
        if options[other] is not None:
            raise click.UsageError(
                f"{option} and --{other.replace('_', '-')} exclude each other: both decide the samples"
            )
    slices = int(options["shutter_slices"] or 0)
    if slices > MOST_SLICES_OF_NOISE:
        raise click.UsageError(f"--shutter-slices {slices} excludes {option}: {SLICES_ARE_EVEN}")
