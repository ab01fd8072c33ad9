"""From a command's options to the frame that it looks at."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import click
from click.core import ParameterSource
from pxr import Usd

from ..base.errors import Diagnostics
from ..base.reporter import Reporter, one_line
from ..farm.frames import FrameError, parse_frame_specs
from ..motion.samples import SampleLog
from ..render.record import reading_progress, report
from ..render_settings.asked import SettingsChoice, applied_to_reading, asked_of
from ..scene.reader import ReadResult, ReadSettings, read_frame
from ..stage.opening import open_stage
from ..stage.rendering_space import LINEAR_REC709
from ..stage.stage_metadata import start_time


def read_one_frame(
    command: str,
    scene: str,
    frame: str | None,
    options: dict[str, Any],
    reporter: Reporter,
    log: SampleLog | None = None,
) -> tuple[Usd.Stage, float | None, ReadResult]:
    """The stage, the frame and what was read of it; the start time where none is given. What the reader has to
    say is left to the caller."""
    check_text(scene, options)
    frames = parse(lambda: parse_frame_specs(frame))[0] if frame else []
    if len(frames) > 1 or (frames and options["default_time"]):
        raise click.UsageError(
            f"{command} looks at one frame: --frame takes one time code, and not beside --defaultTime"
        )
    settings = replace(read_settings(options), max_bounces=options.get("max_bounces"))
    diagnostics = Diagnostics()
    stage = open_stage(scene, diagnostics, options["mask"])
    start = None if options["default_time"] else start_time(stage)
    time = frames[0] if frames else start
    choice = settings_choice(click.get_current_context(), options)
    asked = asked_of(stage, choice, time, diagnostics)
    if asked is not None:
        settings = applied_to_reading(asked, settings, choice.given, diagnostics)
        own = asked.spec.own
        if "refraction" in options and "refraction" not in choice.given and own.refraction is not None:
            options["refraction"] = own.refraction
    report(diagnostics, reporter)
    with reading_progress(time) as progress:
        result = read_frame(stage, time, settings, progress=progress, found=log)
    return stage, time, result


def settings_choice(ctx: click.Context, options: dict[str, Any]) -> SettingsChoice:
    """Which render settings prim counts, and the options that the user gave."""
    given = (name for name in ctx.params if ctx.get_parameter_source(name) is not ParameterSource.DEFAULT)
    return SettingsChoice(options["render_settings"], frozenset(given))


def parse(parser: Callable[[], Any]) -> Any:
    """What `parser` returns; its FrameError is the user's slip."""
    try:
        return parser()
    except FrameError as error:
        raise click.UsageError(one_line(str(error))) from None


def read_settings(options: dict[str, Any]) -> ReadSettings:
    if options["shutter"] is not None and options["default_time"]:
        raise click.UsageError("--shutter and --defaultTime exclude each other: nothing moves at the default time")
    width, height = options["resolution"] or (options["image_width"], None)
    return ReadSettings(
        camera=options["camera"],
        width=width,
        height=height,
        conform=options["conform"],
        purposes=options["purposes"],
        shutter=options["shutter"],
        motion_tolerance=options["motion_tolerance"],
        outside_tolerance=options["outside_tolerance"],
        interpolation=options["interpolation"],
        segments=options["segments"] or 0,
        max_instances=options["max_instances"],
        disable_camera_light=options["disable_camera_light"],
        exposure=not options["disable_exposure"],
        rendering_space=options.get("rendering_space", LINEAR_REC709),
        complexity=options["complexity"],
        edge_length=options["edge_length"],
        displacement=options["displacement"],
        curves=options["curves"],
        keep_faces="elementId" in options.get("aovs", ()),
        keep_st="st" in options.get("aovs", ()),
    )


def check_text(scene: str, options: dict[str, Any]) -> None:
    """Output files may have any name, but USD takes text."""
    for text in (scene, options["camera"] or "", options["render_settings"] or "", *options["mask"]):
        try:
            text.encode()
        except UnicodeEncodeError:
            shown = text.encode("utf-8", "backslashreplace").decode()
            raise click.UsageError(f"found '{shown}', expected a name in UTF-8") from None
