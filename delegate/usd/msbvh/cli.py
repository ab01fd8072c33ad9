"""The command line. usdrecord's names and rules where it has them; exit codes in main()."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import click

from . import _core
from .atomic import OutputError
from .color import MODES, ColorCorrection, ColorError
from .conform import POLICIES
from .errors import Diagnostics, SceneError
from .frames import FrameError, check_single_outputs, frame_jobs, parse_frame_specs
from .images import ImageSettings
from .reader import ReadSettings, read_frame
from .record import FrameJob, RecordSettings, RenderSettings, plan_entries, record, report, software
from .report import Reporter, one_line
from .stage import open_stage

DONE, WRONG, USAGE, DEGRADED, INTERRUPTED = 0, 1, 2, 3, 130
"""Exit codes: done; the scene or the settings are wrong; usage; rendered, but --strict and something was missing or
degraded; interrupted."""

RENDERER_NAMES = ("msbvh", "hdMsbvh", "HdMsbvhRendererPlugin")
PURPOSES = ("default", "render", "proxy", "guide")
MAX_PIXELS_ACROSS = 65535
MAX_SPP = 1 << 20


def main(arguments: Sequence[str]) -> int:
    """Runs a command; returns the exit code. Whatever goes wrong is one line on stderr, never a traceback."""
    try:
        return commands.main(args=list(arguments), prog_name="msbvh", standalone_mode=False) or DONE
    except click.exceptions.NoArgsIsHelpError as error:
        print(error.format_message(), file=sys.stderr)
        return USAGE
    except click.ClickException as error:
        Reporter.error(error.format_message())
        return error.exit_code
    except (SceneError, OutputError, _core.Error) as error:
        Reporter.error(str(error))
        return WRONG
    except (KeyboardInterrupt, click.Abort):
        Reporter.error("interrupted")
        return INTERRUPTED
    except MemoryError:
        Reporter.error("out of memory")
        return WRONG
    except Exception as error:  # A defect of ours, or of a library; MSBVH_TRACEBACK=1 shows where.
        if os.environ.get("MSBVH_TRACEBACK"):
            raise
        Reporter.error(f"internal error, please report it: {type(error).__name__}: {error}")
        return WRONG


class Names(click.ParamType):
    """Names separated by commas or blanks, as usdrecord takes them; with `choices`, only those."""

    name = "names"

    def __init__(self, choices: Sequence[str] = ()) -> None:
        self._choices = choices

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> tuple[str, ...]:
        names = tuple(value.replace(",", " ").split()) if isinstance(value, str) else tuple(value)
        for name in names:
            if self._choices and name not in self._choices:
                self.fail(f"found '{name}', expected any of: {', '.join(self._choices)}", param, ctx)
        return names


def _unsupported(hint: str) -> Callable[..., None]:
    """A callback for options of usdrecord that change the picture and that we cannot honour yet."""

    def refuse(ctx: click.Context, param: click.Parameter, value: Any) -> None:
        if value:
            raise click.UsageError(f"{param.opts[0]} is not supported yet{hint}", ctx)

    return refuse


def scene_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """The options that decide what is read from the stage; shared by all commands."""
    options = [
        click.argument("scene", type=click.Path(path_type=str)),
        click.option("--camera", "-cam", metavar="NAME|PATH",
                     help="Camera by prim name or path. Default: main_cam, else the first one, else one that frames all."),
        click.option("--defaultTime", "-d", "default_time", is_flag=True,
                     help="Read the stage at its default time instead of its start time; nothing moves then."),
        click.option("--imageWidth", "-w", "image_width", type=click.IntRange(1, MAX_PIXELS_ACROSS), default=960,
                     show_default=True, help="Pixels; the height follows from the camera's aspect ratio."),
        click.option("--resolution", nargs=2, type=click.IntRange(1, MAX_PIXELS_ACROSS), metavar="W H",
                     help="Pixels; overrides --imageWidth. --conform says what happens to the camera's aspect ratio."),
        click.option("--conform", type=click.Choice(POLICIES), default="expandAperture", show_default=True,
                     help="How the camera fits a --resolution of another shape (UsdRenderSettings' policies)."),
        click.option("--purposes", type=Names(PURPOSES), default="proxy", show_default=True, metavar="PURPOSE[,...]",
                     help="Purposes that are drawn beside default."),
        click.option("--mask", type=Names(), default="", metavar="PRIMPATH[,...]",
                     help="Populate only these prims, their ancestors and descendants."),
        click.option("--motion-tolerance", type=click.FloatRange(0.0, min_open=True), default=0.1, show_default=True,
                     help="Pixels that a track may stray from the stage's own motion. Less: more keys, more memory."),
        click.option("--disableCameraLight", "disable_camera_light", is_flag=True,
                     help="No light at the camera where the scene has no lights."),
        click.option("--complexity", "-c", type=click.Choice(("low", "medium", "high", "veryhigh")), default="low",
                     show_default=True, help="Accepted; subdivision surfaces are drawn as polygons at any value."),
        click.option("--sessionLayer", callback=_unsupported("; sublayer it from SCENE instead"), expose_value=False,
                     metavar="FILE", help="Not supported yet."),
        click.option("--renderSettingsPrimPath", "-rs", callback=_unsupported("; give --camera and --resolution"),
                     expose_value=False, metavar="PRIMPATH", help="Not supported yet."),
        click.option("--renderPassPrimPath", "-rp", callback=_unsupported("; give --camera and --resolution"),
                     expose_value=False, metavar="PRIMPATH", help="Not supported yet."),
        click.option("--enableDomeLightVisibility", is_flag=True, callback=_unsupported(""), expose_value=False,
                     help="Not supported yet: dome lights light, but are not seen."),
    ]  # fmt: skip
    for option in reversed(options):
        command = option(command)
    return command


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(message=software())
def commands() -> None:
    """Motion-blurred frames from USD on the CPU."""


@commands.command("record")
@scene_options
@click.argument("outputs", nargs=-1, required=True, metavar="OUT...")
@click.option("--frames", "-f", metavar="FRAMESPEC[,...]",
              help="START, START:END or START:ENDxSTRIDE. Ranges need a placeholder in OUT: ### or ###.##.")
@click.option("--colorCorrectionMode", "-color", "color_mode", type=click.Choice(MODES), default="sRGB",
              show_default=True, help="For PNG, JPEG, TIFF; EXR stays linear. sRGB does not tone-map.")
@click.option("--ocio-display", metavar="NAME", help="Of mode openColorIO; default: the built-in config's.")
@click.option("--ocio-view", metavar="NAME", help="Of mode openColorIO; default: the display's.")
@click.option("--exr-float", is_flag=True, help="EXR in 32-bit floats instead of half: twice the bytes.")
@click.option("--spp", type=click.IntRange(1, MAX_SPP), default=64, show_default=True,
              help="Samples a pixel: noise falls with the square root, time grows in proportion.")
@click.option("--seed", type=click.IntRange(0, 2**32 - 1), default=0, show_default=True,
              help="The same seed gives the same pixels, on any number of threads.")
@click.option("--max-bounces", type=click.IntRange(0, 64), default=2, show_default=True,
              help="Of indirect light; 0: direct light only.")
@click.option("--threads", type=click.IntRange(0, 4096), default=0, show_default=True, help="0: all.")
@click.option("--builder", type=click.Choice(("msbvh", "mbvh")), default="msbvh", show_default=True,
              help="mbvh: without spatial splits, the paper's baseline.")
@click.option("--stats", type=click.Path(path_type=Path), metavar="FILE.json",
              help="Write times, counts, memory, the effect plan and the warnings.")
@click.option("--strict", is_flag=True, help=f"Exit with {DEGRADED} if anything was missing or degraded.")
@click.option("--renderer", "-r", metavar="NAME", help="Accepted for usdrecord's sake; this is msbvh.")
@click.option("--disableGpu", is_flag=True, expose_value=False, help="Accepted; there is no GPU in use.")
def record_command(
    scene: str, outputs: tuple[str, ...], frames: str | None, stats: Path | None, strict: bool, renderer: str | None,
    **options: Any,
) -> int:
    """Render SCENE to OUT: .exr, .png, .jpg or .tif; several at once cost one rendering.

    Without --frames or --defaultTime the stage's start time is rendered.
    """  # fmt: skip
    _check_renderer(renderer)
    jobs = _record_jobs(outputs, frames, options["default_time"])
    settings = RecordSettings(
        read=_read_settings(options),
        render=RenderSettings(**{name: options[name] for name in ("spp", "seed", "max_bounces", "threads", "builder")}),
        image=ImageSettings(_color_correction(options), options["exr_float"]),
        mask=options["mask"],
        stats=stats,
    )
    reporter = Reporter()
    _warn_of_options(options, reporter)
    record(scene, jobs, settings, reporter)
    return DEGRADED if strict and reporter.warnings else DONE


@commands.command("plan")
@scene_options
@click.option("--frame", "-f", metavar="TIMECODE", help="Default: the stage's start time.")
@click.option("--json", "as_json", is_flag=True, help="For scripts.")
def plan_command(scene: str, frame: str | None, as_json: bool, **options: Any) -> int:
    """Print the effects that SCENE calls for, and the prims that are the reason."""
    frames = _parse(lambda: parse_frame_specs(frame))[0] if frame else []
    if len(frames) > 1 or (frames and options["default_time"]):
        raise click.UsageError("plan looks at one frame: --frame takes one time code, and not beside --defaultTime")
    reporter, diagnostics = Reporter(), Diagnostics()
    stage = open_stage(scene, diagnostics, options["mask"])
    report(diagnostics, reporter)
    start = None if options["default_time"] else stage.GetStartTimeCode()
    result = read_frame(stage, frames[0] if frames else start, _read_settings(options))
    report(result.diagnostics, reporter)
    renderer = _core.Renderer(result.scene, width=result.camera.width, height=result.camera.height)
    plan = plan_entries(renderer)
    if as_json:
        print(json.dumps({"scene": scene, "plan": plan, "warnings": reporter.warnings}, indent=2))
    else:
        for entry in plan:
            print(f"{entry['effect']:20} {entry['prim']}{': ' if entry['prim'] else ''}{entry['why']}")
    return DONE


def _parse(parser: Callable[[], Any]) -> Any:
    """What `parser` returns; its FrameError is the user's slip."""
    try:
        return parser()
    except FrameError as error:
        raise click.UsageError(one_line(str(error))) from None


def _record_jobs(
    outputs: tuple[str, ...], frames: str | None, default_time: bool
) -> Sequence[FrameJob] | Sequence[str]:
    if len(set(outputs)) < len(outputs):
        raise click.UsageError("an output file is named twice")
    if frames is not None and default_time:
        raise click.UsageError("--frames and --defaultTime exclude each other")
    if frames is not None:
        return _parse(lambda: frame_jobs(outputs, frames))
    _parse(lambda: check_single_outputs(outputs))
    return [(None, outputs)] if default_time else outputs


def _read_settings(options: dict[str, Any]) -> ReadSettings:
    width, height = options["resolution"] or (options["image_width"], None)
    return ReadSettings(
        camera=options["camera"],
        width=width,
        height=height,
        conform=options["conform"],
        purposes=options["purposes"],
        motion_tolerance=options["motion_tolerance"],
        disable_camera_light=options["disable_camera_light"],
    )


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


def _warn_of_options(options: dict[str, Any], reporter: Reporter) -> None:
    if options["complexity"] != "low":
        reporter.warning(f"--complexity {options['complexity']}: not supported yet; subdivision surfaces are polygons")
