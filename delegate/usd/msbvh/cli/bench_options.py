"""The options of `msbvh bench`: of rays, of whole frames, of stability, and which go together."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click

from .. import _core
from ..bench.frame_looks import LOOKS
from .option_types import Names, Numbers
from .options import MAX_PIXELS_ACROSS, MAX_SPP, Decorator

BENCH: Sequence[Decorator] = (
    click.option(
        "--scenes",
        type=Names(),
        default="*",
        show_default=True,
        metavar="GLOB[,...]",
        help="Measure only scenes whose names match: wheels, or wheels-9 for one number of keys. shared/*: public scenes in"
        " ../shared/scenes.",
    ),
    click.option(
        "--peer",
        type=click.Choice(("embree", "cycles")),
        help="Measure another renderer side by side. embree: rays; needs pip install embreex==4.4.*. cycles: with --frames;"
        " see --peer-env.",
    ),
    click.option("--quick", is_flag=True, help="Small scenes and few rays: less than 50 seconds on two cores."),
    click.option("--json", "as_json", is_flag=True, help="Print JSON, for scripts."),
    click.option(
        "--builder",
        "builders",
        multiple=True,
        type=click.Choice(tuple(_core.builders())),
        help="Measure only this builder; may be repeated. Default: msbvh and mbvh.",
    ),
    click.option(
        "--threads",
        type=Numbers(),
        metavar="N[,...]",
        help="Thread counts to measure with; 0: all cores. Default: 1,0; with --quick: 1.",
    ),
    click.option(
        "--seed",
        type=click.IntRange(0, 2**31 - 1),
        default=1,
        show_default=True,
        help="Random seed of scenes and rays.",
    ),
    click.option(
        "--repetitions",
        type=click.IntRange(1, 1000),
        help="Interleaved rounds. Default: 5; with --quick: 3.",
    ),
    click.option(
        "--triangles",
        type=click.IntRange(64, 100_000_000),
        help="Approximate triangle count of every procedural scene. Default: each scene's own, 10 thousand to 2 million.",
    ),
    click.option(
        "--out",
        type=click.Path(path_type=Path, file_okay=False),
        metavar="DIR",
        help="Write bench.json, or frames.json or stability.json, to this folder.",
    ),
)
"""What is measured, against whom, and how often."""

STABILITY: Sequence[Decorator] = (
    click.option(
        "--stability",
        is_flag=True,
        help="Count the rays that get out of closed moving shapes, or through tubes and spheres, instead of rays a second:"
        " ours, and with --peer embree Embree's. About 10 minutes on two cores; with --quick half a minute. --scenes:"
        " shapes, or ball-129 for one number of keys.",
    ),
)

FRAMES: Sequence[Decorator] = (
    click.option(
        "--frames",
        is_flag=True,
        help="Measure whole frames of five scenes instead of rays: time, memory and noise of each renderer. About 30"
        " minutes on two cores, with Cycles 2 hours. With --quick a minute, too short to judge speed by.",
    ),
    click.option(
        "--old",
        metavar="COMMAND",
        help="With --frames: measure another msbvh beside this one, such as '/opt/old/bin/msbvh'.",
    ),
    click.option(
        "--peer-env",
        "peer_folder",
        type=click.Path(path_type=Path),
        metavar="DIR",
        help="With --peer cycles: the Python environment that has bpy. Created if missing, which takes a GB. Default: in"
        " the user's cache.",
    ),
    click.option(
        "--resolution",
        nargs=2,
        type=click.IntRange(1, MAX_PIXELS_ACROSS),
        metavar="W H",
        help="With --frames: width and height in pixels. Default: 480 320; with --quick: 96 64.",
    ),
    click.option(
        "--spp",
        type=click.IntRange(1, MAX_SPP),
        help="With --frames: samples per pixel. Default: 128; with --quick: 16.",
    ),
    click.option(
        "--reference-spp",
        type=click.IntRange(0, MAX_SPP),
        help="With --frames: samples per pixel of the converged pictures that noise is measured against, which take most of"
        " the time; 0: no pictures, times only. Default: 2048; with --quick: 256.",
    ),
    click.option(
        "--max-bounces",
        type=click.IntRange(0, 64),
        help="With --frames: bounces of indirect light. Default: 2.",
    ),
    click.option(
        "--looks",
        type=Names(tuple(LOOKS)),
        metavar="NAME[,...]",
        help="With --frames: what surfaces are. displayColor: diffuse. metal: rough mirrors of that colour. textured: an image of"
        " the colour under a rough reflection. The latter two have a plain sky besides the sun. Default: displayColor.",
    ),
)

RAYS_ONLY = ("builders", "triangles")
RAYS_OR_FRAMES = ("threads", "repetitions")
FRAMES_ONLY = ("old", "peer_folder", "resolution", "spp", "reference_spp", "max_bounces", "looks")
FOREIGN = {"rays": FRAMES_ONLY, "frames": RAYS_ONLY, "stability": (*RAYS_ONLY, *RAYS_OR_FRAMES, *FRAMES_ONLY)}
"""What the other benchmarks take alone."""
OWN_DEFAULTS = ("max_bounces", "looks")
"""Left to FrameSettings where they are not given."""
NAMES = {"builders": "--builder", "peer_folder": "--peer-env"}
"""Of options whose parameter is called something else."""


def chosen_bench(options: dict[str, Any]) -> tuple[str, dict[str, Any]]:
    """Which of FOREIGN is asked for, and its options alone. Raises UsageError for those of another one."""
    frames, stability = options["frames"], options["stability"]
    if frames and stability:
        raise click.UsageError("--stability and --frames exclude each other")
    chosen = "frames" if frames else "stability" if stability else "rays"
    for name in FOREIGN[chosen]:
        if options[name] not in (None, ()):
            option = NAMES.get(name, f"--{name.replace('_', '-')}")
            raise click.UsageError(
                f"{option} needs --frames" if chosen == "rays" else f"{option} and --{chosen} exclude each other"
            )
    peer = options["peer"]
    if peer and (peer == "cycles") != frames:
        raise click.UsageError(
            f"--peer {peer}: found {'' if frames else 'no '}--frames; cycles goes with it, embree without"
        )
    if options["peer_folder"] and peer != "cycles":
        raise click.UsageError("--peer-env needs --peer cycles")
    left_out = {*FOREIGN[chosen], "frames", "stability"}
    kept = {name: value for name, value in options.items() if name not in left_out}
    return chosen, {name: value for name, value in kept.items() if value is not None or name not in OWN_DEFAULTS}
