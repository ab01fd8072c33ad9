"""`msbvh accuracy`."""

from __future__ import annotations

import fnmatch
import json
import shlex
from dataclasses import replace
from pathlib import Path
from typing import Any

import click

from ..accuracy.all_knobs import ALL
from ..accuracy.options import Options, Value
from ..accuracy.run import AccuracySettings, run_accuracy
from ..accuracy.scenes import SCENES
from ..accuracy.tables import write_tables
from ..accuracy_report.report import check_libraries, write_report
from ..base.atomic import check_folder, write_whole
from ..base.exit_codes import DONE, WRONG
from ..base.progress import Progress
from ..base.reporter import Reporter
from ..farm.frames import parse_frame_specs
from ..render.budget import Goals
from ..render.record import report
from .budget_options import REPORTED_GOALS
from .frame_options import check_text, parse, read_settings
from .option_types import Names
from .options import MAX_SPP, READING, with_options
from .render_options import THREADS

DEFAULT_WIDTH = 480
QUICK_DETAIL = 0.1
"""Of built-in scenes."""
NO_AXIS = "none"
KNOBS = (
    "motion-tolerance", "outside-tolerance", "interpolation", "segments", "edge-length", "complexity", "displacement", "curves",
)  # fmt: skip
"""Options of SCENE that a report turns; what the user gives is where the others are held."""

OPTIONS = (
    click.option("--frame", "-f", metavar="TIMECODE", help="Time code to look at. Default: the stage's start time."),
    click.option(
        "--out",
        type=click.Path(path_type=Path),
        required=True,
        metavar="DIR",
        help="Folder of the report: report.html, accuracy.json, points.csv, prims.csv and pictures/. What was measured is kept in"
        " points/, so that the same command goes on after an interruption; delete that when the report is done.",
    ),
    click.option(
        "--spp",
        type=click.IntRange(1, MAX_SPP),
        default=16,
        show_default=True,
        help="Samples per pixel, where they are held.",
    ),
    click.option(
        "--max-bounces", type=click.IntRange(0, 64), default=2, show_default=True, help="Bounces, where they are held."
    ),
    click.option(
        "--axes",
        "globs",
        type=Names(),
        default="*",
        show_default=True,
        metavar="GLOB[,...]",
        help="Turn only these knobs, by their options: spp, motion-tolerance, 'edge*' ... none: named settings and goals alone.",
    ),
    click.option(
        "--rounds",
        type=click.IntRange(2, 100),
        default=3,
        show_default=True,
        help="How often each point is rendered, by another seed each time. More: smaller spreads of times and errors.",
    ),
    click.option("--quick", is_flag=True, help="Few positions of each knob and two rounds, for a first look."),
    click.option(
        "--seed",
        type=click.IntRange(0, 2**31 - 2_000_000),
        default=1,
        show_default=True,
        help="Seed of the first round.",
    ),
    THREADS,
)


@click.command("accuracy", context_settings={"default_map": {"image_width": DEFAULT_WIDTH}})
@click.argument("scene", required=False, type=click.Path(path_type=str))
@with_options(READING, OPTIONS, REPORTED_GOALS)
@click.pass_context
def accuracy_command(ctx: click.Context, scene: str | None, frame: str | None, out: Path, **options: Any) -> int:
    """Measure what each step of accuracy costs on SCENE, and write a report: motion, shape and noise apart, in pixels and in
    the picture, beside seconds and bytes; the settings that no others beat; and, prim by prim, what a cheaper and a
    finer track would bring.

    Every point is rendered in a process of its own. Without SCENE: five built-in ones, each in a folder of its own. Exit
    code 1 if a --target or the --time-budget cannot be kept.
    """
    check_text(scene or "", options)
    check_libraries()
    frames = parse(lambda: parse_frame_specs(frame))[0] if frame else []
    if len(frames) > 1 or (frames and options["default_time"]):
        raise click.UsageError("accuracy looks at one frame: --frame takes one time code, and not beside --defaultTime")
    _check_axes(options["globs"])
    if "#" in str(out):
        raise click.UsageError(f"--out: found '{out}', expected a name without '#', which stands for frame numbers")
    if options["render_settings"]:
        raise click.UsageError(
            "--renderSettingsPrimPath: accuracy turns settings itself; give --camera and --resolution"
        )
    check_folder(out)
    settings = AccuracySettings(
        scene=scene or "",
        read=read_settings(options),
        base=_base(ctx, options),
        shared=tuple(_shared(ctx, options)),
        frame=frames[0] if frames else None,
        default_time=options["default_time"],
        mask=options["mask"],
        rounds=2 if options["quick"] else options["rounds"],
        few=options["quick"],
        globs=options["globs"],
        seed=options["seed"],
        threads=options["threads"],
        goals=Goals(options["target_error"], options["target_flip"], options["time_budget"]),
        command=shlex.join(["msbvh", *ctx.obj]),
    )
    reporter = Reporter()
    if scene is not None:
        return DONE if _reported(settings, out, reporter) else WRONG
    kept = []
    for name, built_in in SCENES.items():
        check_folder(out / name)
        built_in.write(out / name / "scene.usdc", QUICK_DETAIL if options["quick"] else 1.0)
        print(f"{name}: {built_in.says}")
        kept.append(_reported(replace(settings, scene=str(out / name / "scene.usdc")), out / name, reporter))
    return DONE if all(kept) else WRONG


def _reported(settings: AccuracySettings, out: Path, reporter: Reporter) -> bool:
    """Measures a scene and writes its report; whether all goals are kept."""
    with Progress(f"msbvh: accuracy: {Path(settings.scene).name}") as progress:
        data = run_accuracy(settings, out, progress, lambda found: report(found, reporter))
    write_whole(out / "accuracy.json", f"{json.dumps(data, indent=1, allow_nan=False)}\n".encode())
    write_tables(data, out)
    page = write_report(data, out)
    for sentence in data["findings"]:
        print(sentence)
    print(f"Report: {page}", flush=True)
    return all(target["holds"] for target in data["targets"])


def _check_axes(globs: tuple[str, ...]) -> None:
    """Those that match no knob are slips."""
    known = [knob.option for knob in ALL]
    for glob in globs:
        if glob != NO_AXIS and not fnmatch.filter(known, glob):
            raise click.UsageError(f"--axes: found '{glob}', expected any of: {', '.join(known)}, or {NO_AXIS}")


def _base(ctx: click.Context, options: dict[str, Any]) -> Options:
    """Where knobs are held: what is given, and what has a default that a knob turns."""
    found: dict[str, Value] = {"spp": options["spp"], "max-bounces": options["max_bounces"]}
    for name in KNOBS:
        key = name.replace("-", "_")
        given = ctx.get_parameter_source(key) is not click.core.ParameterSource.DEFAULT
        if options[key] is not None and (given or name in ("motion-tolerance", "complexity")):
            found[name] = options[key]
    return Options.of(found)


def _shared(ctx: click.Context, options: dict[str, Any]) -> list[str]:
    """What all points have, as arguments of `msbvh record`."""
    found: list[str] = []
    if options["camera"]:
        found += ["--camera", options["camera"]]
    if options["shutter"] is not None:
        found += ["--shutter", "{}:{}".format(*options["shutter"])]
    if options["mask"]:
        found += ["--mask", ",".join(options["mask"])]
    if options["disable_camera_light"]:
        found += ["--disableCameraLight"]
    if options["disable_exposure"]:
        found += ["--disableExposureCompensation"]
    for name in ("conform", "purposes", "max_instances"):
        if ctx.get_parameter_source(name) is not click.core.ParameterSource.DEFAULT:
            value = options[name]
            found += [f"--{name.replace('_', '-')}", ",".join(value) if isinstance(value, tuple) else str(value)]
    return found
