"""The options of `msbvh record` that say when there are samples enough, and what is done about the noise that is left."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import click
from click.core import ParameterSource

from .._core import MOST_SAMPLES_OF_NOISE
from ..output.denoise import is_installed
from ..render.sampling import MOST_SLICES_OF_NOISE, SLICES_ARE_EVEN
from .option_types import positive
from .options import MAX_SPP, Decorator

LARGEST_NOISE = 1.0

NOISE: Sequence[Decorator] = (
    click.option(
        "--noise",
        type=click.FloatRange(0.0, LARGEST_NOISE, min_open=True),
        callback=positive,
        metavar="TARGET",
        help="Sample each pixel until its estimated error is about this fraction of its value: 0.05 suits previews, 0.01"
        f" finals. --spp is then the maximum per pixel ({MOST_SAMPLES_OF_NOISE} unless given). Alpha's absolute error is held to"
        " it too. Slightly biased, since a pixel stops on the samples it has seen; docs/design/noise.md gives figures.",
    ),
    click.option(
        "--min-spp",
        type=click.IntRange(1, MAX_SPP),
        default=32,
        show_default=True,
        help="With --noise: samples per pixel before its noise is judged; a power of two, at least 32 (other numbers are"
        " rounded up). More catch small bright details that 32 miss.",
    ),
    click.option(
        "--time-limit",
        type=click.FloatRange(0.0, min_open=True),
        callback=positive,
        metavar="SECONDS",
        help="Stop sampling a frame after this many seconds, counted from when reading it starts. Never fewer than 16"
        f" samples, never more than --spp ({MOST_SAMPLES_OF_NOISE} unless given); all pixels get the same number (without"
        " --noise). The file says how many, and --spp with that number renders the same picture. Costs about 64 bytes a"
        " pixel; denoising comes on top.",
    ),
    click.option(
        "--clamp-indirect",
        type=click.FloatRange(0.0, 1e6, min_open=True),
        callback=positive,
        metavar="RADIANCE",
        help="Clamp the indirect light of each sample to this radiance, before exposure, against fireflies. Biased: loses"
        " light. Default: off.",
    ),
    click.option(
        "--denoise",
        is_flag=True,
        help="Also write a denoised picture (Intel Open Image Denoise, guided by albedo and normal): layer 'denoised' of .exr"
        " files, beside the raw colour; .png, .jpg and .tif show it instead of the raw one. Needs pip install"
        " 'msbvh[denoise]' and a few seconds a frame, on all processors.",
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
    if (options["noise"] is not None or options["time_limit"] is not None) and "spp" not in given:
        options["spp"] = MOST_SAMPLES_OF_NOISE
    if "min_spp" in given and options["min_spp"] > options["spp"]:
        raise click.UsageError(f"--min-spp: found {options['min_spp']}, expected at most --spp, {options['spp']}")
    for name in ("noise", "time_limit"):
        if options[name] is not None:
            _check_alone(f"--{name.replace('_', '-')}", options)
    if options["denoise"] and not is_installed():
        raise click.UsageError("--denoise: the package pyoidn is not installed: pip install 'msbvh[denoise]'")


def _check_alone(option: str, options: dict[str, Any]) -> None:
    for other in ("target_flip", "time_budget"):
        if options[other] is not None:
            raise click.UsageError(
                f"{option} and --{other.replace('_', '-')} exclude each other: both decide the samples"
            )
    slices = int(options["shutter_slices"] or 0)
    if slices > MOST_SLICES_OF_NOISE:
        raise click.UsageError(f"--shutter-slices {slices} excludes {option}: {SLICES_ARE_EVEN}")
