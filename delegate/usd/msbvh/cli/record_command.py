"""`msbvh record`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click

from ..base.exit_codes import DEGRADED, DONE, WRONG
from ..base.reporter import Reporter
from ..farm.frames import check_single_outputs, frame_jobs
from ..look.color import ColorCorrection, ColorError
from ..output.images import ImageSettings
from ..render.record import record
from ..render.settings import FrameJob, RecordSettings, RenderSettings
from .budget_options import GOALS, check_mergeable, goals_from
from .film_options import FILM, film_of
from .frame_options import check_text, parse, read_settings, settings_choice
from .noise_options import NOISE, check_noise
from .options import OUTPUT, SCENE, with_options
from .render_options import RENDER
from .thread_note import note_threads

RENDER_NAMES = (
    "spp",
    "seed",
    "max_bounces",
    "refraction",
    "threads",
    "show_domes",
    "aovs",
    "builder",
    "layout",
    "refit",
    "sampler",
    "split_budget",
    "texture_memory_mb",
    "texture_rate",
    "min_spp",
    "rendering_space",
)
"""Options that are fields of RenderSettings."""
RENDERER_NAMES = ("msbvh", "hdMsbvh", "HdMsbvhRendererPlugin")


@click.command("record")
@with_options(SCENE, OUTPUT, RENDER, NOISE, FILM, GOALS)
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
    check_noise(ctx)
    options["spp"] = ctx.params["spp"]
    if options["shutter_slices"] and not any(Path(output).suffix.lower() == ".exr" for output in outputs):
        raise click.UsageError("--shutter-slices: only .exr files hold layers, and no OUT is one")
    check_mergeable(options["aovs"], goals)
    settings = RecordSettings(
        read=read_settings(options),
        render=_render_settings(options),
        image=ImageSettings(_color_correction(options), options["show_domes"], options["exr_float"]),
        mask=options["mask"],
        stats=stats,
        goals=goals,
        time_limit=options["time_limit"],
        denoise=options["denoise"],
        ray_costs=ray_costs,
        choice=settings_choice(ctx, options),
    )
    reporter = Reporter()
    note_threads([options["threads"]], reporter)
    run = record(scene, jobs, settings, reporter)
    if any(frame.budget and frame.budget["misses"] for frame in run.frames):
        return WRONG
    return DEGRADED if strict and reporter.degraded else DONE


def _render_settings(options: dict[str, Any]) -> RenderSettings:
    return RenderSettings(
        **{name: options[name] for name in RENDER_NAMES},
        noise=options["noise"] or 0.0,
        clamp_indirect=options["clamp_indirect"] or 0.0,
        film=film_of(options),
    )


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
    color = ColorCorrection(mode, display, view, options["rendering_space"])
    try:
        color.resolve()
    except ColorError as error:
        raise click.UsageError(str(error)) from None
    return color


def _check_renderer(name: str | None) -> None:
    if name is not None and name not in RENDERER_NAMES:
        raise click.UsageError(f"--renderer: found '{name}', but only msbvh renders here; leave the option out")
