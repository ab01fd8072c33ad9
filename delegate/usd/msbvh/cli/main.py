"""The command line. usdrecord's names and rules where it has them; exit codes in main()."""

from __future__ import annotations

import json
import os
import sys
import traceback
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import click

from .. import _core
from ..base import signals
from ..base.atomic import OutputError, check_folder, check_writable, write_whole
from ..base.errors import Diagnostics, SceneError
from ..base.exit_codes import DEFECT, DEGRADED, DONE, USAGE, WRONG, table_text
from ..base.progress import Progress
from ..base.reporter import Reporter
from ..bench.frames import FrameSettings
from ..bench.frames import run as run_frames
from ..bench.frames_table import table as frames_table
from ..bench.rays import BenchSettings
from ..bench.rays import run as run_bench
from ..bench.rays_table import table as bench_table
from ..conform.record import read_record
from ..conform.shutter import check_suite, shutter_text, with_shutter
from ..conform.suite import Rule, conform, find_suite, other_renderer, own_renderer, read_rules, table
from ..farm.frames import check_single_outputs, frame_jobs
from ..look.color import ColorCorrection, ColorError
from ..motion.samples import SampleLog
from ..motion_report.report import motion_report
from ..motion_report.table import beyond_text, motion_text
from ..output.images import ImageSettings
from ..output.outputs import OutputClash
from ..render.record import (
    FrameJob,
    RecordSettings,
    RenderSettings,
    record,
    report,
    software,
)
from ..stage.opening import tf_messages
from .accuracy_command import accuracy_command
from .bench_options import BENCH, FRAMES, frame_options
from .budget_options import GOALS, goals_from
from .frame_options import check_text, parse, read_one_frame, read_settings
from .options import CONFORM, ONE_FRAME, OUTPUT, SCENE, with_options
from .plan_command import plan_command
from .render_options import RENDER
from .verify_command import verify_command

RENDER_NAMES = (
    "spp",
    "seed",
    "max_bounces",
    "threads",
    "show_domes",
    "aovs",
    "builder",
    "layout",
    "refit",
    "sampler",
    "split_budget",
)
"""Options that are fields of RenderSettings."""
RENDERER_NAMES = ("msbvh", "hdMsbvh", "HdMsbvhRendererPlugin")


def main(arguments: Sequence[str]) -> int:
    """Runs a command; returns the exit code (exit_codes.py). Whatever goes wrong is one line on stderr, never a
    traceback."""
    try:
        return commands.main(list(arguments), "msbvh", standalone_mode=False, obj=tuple(arguments)) or DONE
    except click.exceptions.NoArgsIsHelpError as error:
        print(error.format_message(), file=sys.stderr)
        return USAGE
    except click.ClickException as error:
        Reporter.error(error.format_message())
        return error.exit_code
    except OutputClash as error:
        Reporter.error(str(error))
        return USAGE
    except (SceneError, OutputError, _core.Error) as error:
        Reporter.error(str(error))
        return WRONG
    except (KeyboardInterrupt, click.Abort):
        signals.announce()
        return signals.exit_code()
    except MemoryError:
        Reporter.error("out of memory")
        return WRONG
    except OSError as error:  # The machine's fault: no descriptors left, a file that cannot be read.
        Reporter.error(f"{error.filename}: {error.strerror}" if error.filename else str(error))
        return WRONG
    except Exception as error:
        return _defect(error)


def _defect(error: Exception) -> int:
    """Of ours, or of a library."""
    if os.environ.get("MSBVH_TRACEBACK"):
        traceback.print_exception(error)
    Reporter.error(
        f"internal error: {type(error).__name__}: {error}. This is a defect of {software()}: please report it to the"
        " issue tracker of the hdMsbvh repository, with this command, its scene, and what it prints with"
        " MSBVH_TRACEBACK=1 in the environment"
    )
    return DEFECT


@click.group(context_settings={"help_option_names": ["-h", "--help"]}, epilog=table_text())
@click.version_option(software(), message="%(version)s")
def commands() -> None:
    """Motion-blurred frames from USD on the CPU."""


@commands.command("record")
@with_options(SCENE, OUTPUT, RENDER, GOALS)
@click.pass_context
def record_command(
    ctx: click.Context,
    scene: str,
    outputs: tuple[str, ...],
    frames: str | None,
    stats: Path | None,
    ray_costs: bool,
    strict: bool,
    renderer: str | None,
    **options: Any,
) -> int:
    """Render SCENE to OUT: .exr, .png, .jpg or .tif; several at once cost one rendering.

    Without --frames or --defaultTime the stage's start time is rendered. A file appears under its final name
    complete or not at all. An OUT that is a symbolic link is written through: the file that it points to is replaced.
    Exit code 1 also if a --target or the --time-budget was missed by more than 10 %; the picture is written all the same.
    """
    _check_renderer(renderer)
    check_text(scene, options)
    if options["aovs"] and not any(Path(output).suffix.lower() == ".exr" for output in outputs):
        raise click.UsageError("--aov: only .exr files hold AOVs, and no OUT is one")
    if ray_costs and stats is None:
        raise click.UsageError("--ray-costs: found no --stats FILE.json to write them to")
    jobs = _record_jobs(outputs, frames, options["default_time"])
    goals = goals_from(ctx)
    settings = RecordSettings(
        read=read_settings(options),
        render=RenderSettings(**{name: options[name] for name in RENDER_NAMES}),
        image=ImageSettings(_color_correction(options), options["show_domes"], options["exr_float"]),
        mask=options["mask"],
        stats=stats,
        goals=goals,
        ray_costs=ray_costs,
    )
    reporter = Reporter()
    _note_threads([options["threads"]], reporter)
    run = record(scene, jobs, settings, reporter)
    if any(frame.budget and frame.budget["misses"] for frame in run.frames):
        return WRONG
    return DEGRADED if strict and reporter.degraded else DONE


@commands.command("motion")
@with_options(SCENE, ONE_FRAME)
@click.argument("prim", required=False)
@click.option("--verbose", "-v", is_flag=True, help="Rule and samples of every prim, the still ones too.")
def motion_command(
    scene: str, prim: str | None, frame: str | None, as_json: bool, verbose: bool, **options: Any
) -> int:
    """Print how the prims of SCENE move within the shutter: the samples found, the rule that decided, the
    track that follows them, its error in pixels and its bytes.

    PRIM limits the report to a prim and those below it, with the rule and the samples of each. Exit code 1 if
    a track misses --motion-tolerance.
    """
    reporter, log = Reporter(), SampleLog()
    stage, time, result = read_one_frame("motion", scene, frame, options, reporter, log)
    with tf_messages(Diagnostics()):  # They have been said while the frame was read.
        found = motion_report(stage, time, result, log, options["motion_tolerance"], prim)
    if prim is None:
        report(result.diagnostics, reporter)
    if as_json:
        print(json.dumps({"scene": scene, **found.plain()}, indent=2, allow_nan=False))
    else:
        print(motion_text(found, prim, verbose))
    if found.beyond:
        sys.stdout.flush()
        Reporter.error(beyond_text(found, options["segments"], options["interpolation"]))
    return WRONG if found.beyond else DONE


@commands.command("conform")
@with_options(CONFORM)
def conform_command(
    suite: Path | None,
    pattern: str,
    spp: int,
    as_json: bool,
    out: Path | None,
    command: str,
    timeout: float,
    shutter: tuple[float, float] | None,
) -> int:
    """Hold a renderer to the rules of USD's motion: one small scene each, its alpha against the coverage that
    usd-core's own evaluation has.

    Exit code 1 if a rule fails. The renderer is msbvh, or any other that --command runs. Errors may be what
    noise explains; those of msbvh itself also no larger than in the suite's recorded run.
    """
    text = shutter_text(shutter) if shutter else ""
    renderer = replace(other_renderer(command, timeout), shutter=text) if command else own_renderer(spp, text)
    folder = find_suite(suite)
    rules = read_rules(folder, pattern)
    if shutter is not None:
        check_suite(folder)

    # Under another shutter the answers, and so the errors, are others than those that were recorded.
    record = {} if command or shutter is not None else read_record(folder, spp)

    def prepare(rule: Rule, scratch: Path) -> Rule:
        if shutter is None:
            return rule
        return with_shutter(rule, folder, shutter, scratch, renderer.knows_shutter)

    with Progress("msbvh: conform") as progress:
        outcomes = list(conform(rules, renderer, spp, out, progress, record, prepare))
    if as_json:
        plain = {"renderer": renderer.name, "rules": [outcome.plain() for outcome in outcomes]}
        print(json.dumps(plain, indent=2))
    else:
        print(table(outcomes))
    return DONE if all(outcome.passed for outcome in outcomes) else WRONG


@commands.command("bench")
@with_options(BENCH, FRAMES)
def bench_command(as_json: bool, out: Path | None, **options: Any) -> int:
    """Measure rays a second, build times and bytes on seeded scenes, with a peer side by side in the same run.

    Exit code 1 if our answers differ from the oracle's, if many rays at once differ from one at a time, or if a closed
    scene leaks. With --frames: whole frames of five scenes, each renderer in processes of its own; exit code 1 if another
    one's picture differs, so that times cannot be compared.
    """
    reporter = Reporter()
    frames, options = frame_options(options)
    _note_threads(options["threads"] or (), reporter)
    name = "frames.json" if frames else "bench.json"
    if out is not None:
        check_folder(out)
        check_writable(out / name)
    with Progress("msbvh: bench") as progress:
        if frames:
            result = run_frames(FrameSettings(**options), out, progress, reporter.note)
        else:
            result = run_bench(BenchSettings(**options), progress, reporter.note)
    if out is not None:
        write_whole(out / name, f"{json.dumps(result, indent=1)}\n".encode())
    print(json.dumps(result) if as_json else (frames_table if frames else bench_table)(result))
    return WRONG if any(_wrong_row(row) for row in result["rows"]) else DONE


def _wrong_row(row: dict[str, Any]) -> bool:
    """Of a benchmark: whether an answer is wrong."""
    if "comparable" in row:
        return row["comparable"] is False
    return bool(row["mismatches"] or row["mode_mismatches"] or row["misses"])


commands.add_command(accuracy_command)
commands.add_command(plan_command)
commands.add_command(verify_command)


def _record_jobs(
    outputs: tuple[str, ...], frames: str | None, default_time: bool
) -> Sequence[FrameJob] | Sequence[str]:
    if len(set(outputs)) < len(outputs):
        raise click.UsageError("an output file is named twice")
    if frames is not None and default_time:
        raise click.UsageError("--frames and --defaultTime exclude each other")
    if frames is not None:
        return parse(lambda: frame_jobs(outputs, frames))
    parse(lambda: check_single_outputs(outputs))
    return [(None, outputs)] if default_time else outputs


def _color_correction(options: dict[str, Any]) -> ColorCorrection:
    mode, display, view = options["color_mode"], options["ocio_display"], options["ocio_view"]
    if (display or view) and mode != "openColorIO":
        raise click.UsageError("--ocio-display and --ocio-view need --colorCorrectionMode openColorIO")
    color = ColorCorrection(mode, display, view)
    try:
        color.resolve()
    except ColorError as error:
        raise click.UsageError(str(error)) from None
    return color


def _check_renderer(name: str | None) -> None:
    if name is not None and name not in RENDERER_NAMES:
        raise click.UsageError(f"--renderer: found '{name}', but only msbvh renders here; leave the option out")


def _note_threads(counts: Sequence[int], reporter: Reporter) -> None:
    most = len(os.sched_getaffinity(0))
    for count in counts:
        if count > most:
            reporter.note(f"--threads {count}: this process may use {most} at once, and no more are started")
