"""The options of the commands, as tables. Names are usdrecord's where it has the option; the help says what
each costs."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import click

from .. import _core
from .._core import ASPECT_POLICIES
from ..look.color import MODES
from ..scene.reader import MAX_INSTANCES
from .option_types import AovNames, Names, PowerOfTwo, ShutterRange

PURPOSES = ("default", "render", "proxy", "guide")
MAX_PIXELS_ACROSS = 65535
MAX_SPP = 1 << 20
DISPLACEMENTS = ("auto", "patches", "tessellate", "none")
CURVES = ("ribbon", "tube")
INTERPOLATIONS = ("auto", "linear", "quadratic", "cubic")


def _unsupported(hint: str) -> Callable[..., None]:
    """A callback for options of usdrecord that change the picture and that we cannot honour yet."""

    def refuse(ctx: click.Context, param: click.Parameter, value: Any) -> None:
        if value:
            raise click.UsageError(f"{param.opts[0]} is not supported yet{hint}", ctx)

    return refuse


def finite(ctx: click.Context, param: click.Parameter, value: float) -> float:
    """Ranges let nan pass, because it compares as neither too small nor too large."""
    if not math.isfinite(value):
        raise click.BadParameter(f"found {value}, expected a finite number", ctx, param)
    return value


Decorator = Callable[..., Any]


def with_options(*tables: Sequence[Decorator]) -> Decorator:
    """Gives a command the options of the tables, in their order."""

    def decorate(command: Decorator) -> Decorator:
        for option in reversed([option for table in tables for option in table]):
            command = option(command)
        return command

    return decorate


SHUTTER = click.option(
    "--shutter",
    type=ShutterRange(),
    metavar="OPEN:CLOSE",
    help="Shutter interval in frames, relative to the current one, such as -0.25:0.25 or 0:0.5; 0:0 closes it."
    " Default: the camera's shutter:open and shutter:close; without them the shutter is closed. Costs nothing by"
    " itself: only prims that move take memory for their motion.",
)

READING: Sequence[Decorator] = (
    click.option(
        "--camera",
        "-cam",
        metavar="NAME|PATH",
        help="Camera prim, by name or path. Default: main_cam, else the first camera, else one that frames everything.",
    ),
    click.option(
        "--defaultTime",
        "-d",
        "default_time",
        is_flag=True,
        help="Render at the stage's default time instead of its start time. Nothing moves there.",
    ),
    SHUTTER,
    click.option(
        "--imageWidth",
        "-w",
        "image_width",
        type=click.IntRange(1, MAX_PIXELS_ACROSS),
        default=960,
        show_default=True,
        help="Width in pixels. The height follows from the camera's aspect ratio.",
    ),
    click.option(
        "--resolution",
        nargs=2,
        type=click.IntRange(1, MAX_PIXELS_ACROSS),
        metavar="W H",
        help="Width and height in pixels; overrides --imageWidth. See --conform for how the camera fits.",
    ),
    click.option(
        "--conform",
        type=click.Choice(ASPECT_POLICIES),
        default="expandAperture",
        show_default=True,
        help="How the camera fits a --resolution with another aspect ratio (UsdRenderSettings' aspectRatioConformPolicy).",
    ),
    click.option(
        "--purposes",
        type=Names(PURPOSES),
        default="proxy",
        show_default=True,
        metavar="PURPOSE[,...]",
        help="Purposes to draw in addition to default.",
    ),
    click.option(
        "--mask",
        type=Names(),
        default="",
        metavar="PRIMPATH[,...]",
        help="Populate only these prims, their ancestors and descendants.",
    ),
    click.option(
        "--motion-tolerance",
        type=click.FloatRange(0.0, min_open=True),
        callback=finite,
        default=0.1,
        show_default=True,
        help="How far, in pixels, motion may deviate from the stage's. Smaller values take more keys and memory.",
    ),
    click.option(
        "--outside-tolerance",
        type=click.FloatRange(1.0),
        callback=finite,
        default=8.0,
        show_default=True,
        metavar="TIMES",
        help="How many times --motion-tolerance the motion of what is outside of the picture throughout the shutter may deviate,"
        " which shadows and bounces alone show. Smaller values take more keys and memory; 1: no more than the rest.",
    ),
    click.option(
        "--interpolation",
        type=click.Choice(INTERPOLATIONS),
        default="auto",
        show_default=True,
        help="How meshes and instances move between keys. linear: fastest rays, but arcs take many segments."
        " quadratic, cubic: slower rays and 2 or 3 times the bytes per segment, but arcs take few segments."
        " auto: whichever takes the fewest bytes, prim by prim.",
    ),
    click.option(
        "--segments",
        type=PowerOfTwo(),
        default=None,
        metavar="N",
        help="Motion segments of every moving mesh and instance: a power of two, 1 to 128. Memory grows in proportion."
        " Where these are too few for --motion-tolerance, a warning says so. Default: as few as the tolerance allows.",
    ),
    click.option(
        "--max-instances",
        type=click.IntRange(1),
        default=MAX_INSTANCES,
        show_default=True,
        metavar="N",
        help="Refuse scenes with more instances than this, before reading them; nested instances multiply. Each takes about"
        " 1 kB.",
    ),
    click.option(
        "--disableCameraLight",
        "disable_camera_light",
        is_flag=True,
        help="Do not add a light at the camera to scenes without lights.",
    ),
    click.option(
        "--disableExposureCompensation",
        "disable_exposure",
        is_flag=True,
        help="Ignore the camera's exposure attributes, which multiply the picture's colours.",
    ),
    click.option(
        "--complexity",
        "-c",
        type=click.Choice(("low", "medium", "high", "veryhigh")),
        default="high",
        show_default=True,
        help="How finely surfaces are cut. Subdivision surfaces: low draws their cages, medium, high and veryhigh the limit"
        " surface with edges of 4, 1 or 0.5 pixels. Spheres, cones and the like: to within 0.4, 0.2, 0.1 or 0.05 pixels.",
    ),
    click.option(
        "--edge-length",
        type=click.FloatRange(0.0),
        metavar="PIXELS",
        help="About how long edges of a subdivided surface are, in place of --complexity's; half of it takes four times the"
        " triangles. 0: cages are drawn as polygons.",
    ),
    click.option(
        "--curves",
        type=click.Choice(CURVES),
        default="ribbon",
        show_default=True,
        help="What BasisCurves are drawn as. ribbon: flat, across their normals where these are authored, else turned to each"
        " ray. tube: round, with round ends, for close-ups.",
    ),
    click.option(
        "--displacement",
        type=click.Choice(DISPLACEMENTS),
        default="auto",
        show_default=True,
        help="What subdivided surfaces become that UsdPreviewSurface's displacement moves along their normals, always with the"
        " same picture. patches: grids of points in the tree, for a fifth of the bytes of triangles. tessellate: triangles,"
        " whose rays are faster. auto: triangles up to about 256 MB a frame, then patches. none: they are not displaced.",
    ),
    click.option(
        "--sessionLayer",
        callback=_unsupported("; sublayer it from SCENE instead"),
        expose_value=False,
        metavar="FILE",
        help="Not supported yet.",
    ),
    click.option(
        "--renderSettingsPrimPath",
        "-rs",
        "render_settings",
        metavar="PRIMPATH",
        help="RenderSettings prim to follow; empty: none. Default: what the stage's metadata renderSettingsPrimPath names."
        " Its camera and resolution win over --camera and --imageWidth, as with usdrecord; other options win over it.",
    ),
    click.option(
        "--renderPassPrimPath",
        "-rp",
        callback=_unsupported("; give --camera and --resolution"),
        expose_value=False,
        metavar="PRIMPATH",
        help="Not supported yet.",
    ),
)
"""What is read from the stage; shared by all commands."""

SCENE: Sequence[Decorator] = (click.argument("scene", type=click.Path(path_type=str)), *READING)
"""The same with the stage itself."""

ONE_FRAME: Sequence[Decorator] = (
    click.option("--frame", "-f", metavar="TIMECODE", help="Time code to look at. Default: the stage's start time."),
    click.option("--json", "as_json", is_flag=True, help="Print JSON, for scripts."),
)
"""Of the commands that look at a frame and render none."""

OUTPUT: Sequence[Decorator] = (
    click.argument("outputs", nargs=-1, required=True, metavar="OUT..."),
    click.option(
        "--frames",
        "-f",
        metavar="FRAMESPEC[,...]",
        help="START, START:END or START:ENDxSTRIDE. Ranges need a placeholder in OUT: ### or ###.##.",
    ),
    click.option(
        "--colorCorrectionMode",
        "-color",
        "color_mode",
        type=click.Choice(MODES),
        default="sRGB",
        show_default=True,
        help="Color correction of PNG, JPEG and TIFF files; EXR stays linear. sRGB does not tone-map.",
    ),
    click.option(
        "--ocio-display",
        metavar="NAME",
        help="Display, for --colorCorrectionMode openColorIO. Default: that of the config.",
    ),
    click.option(
        "--ocio-view", metavar="NAME", help="View, for --colorCorrectionMode openColorIO. Default: that of the display."
    ),
    click.option(
        "--aov",
        "aovs",
        type=AovNames(),
        default=(),
        metavar="NAME[,...]",
        help=f"AOVs to write as 32-bit channels of the same .exr files: {', '.join(_core.aov_names())}; all: each but seconds,"
        " which differs from run to run. docs/design/aovs.md says what each means. Background: ids -1, depth 1, the rest 0.",
    ),
    click.option("--exr-float", is_flag=True, help="Write 32-bit float EXR files instead of half: twice the bytes."),
    click.option(
        "--stats",
        type=click.Path(path_type=Path),
        metavar="FILE.json",
        help="Write timings, counts, memory, the effect plan and all warnings to this file.",
    ),
    click.option(
        "--ray-costs",
        is_flag=True,
        help="Trace a sample of the frame's rays again and count what they meet, for --stats: nodes, tests, and which prims"
        " they are spent on. Takes tenths of a second. Also samples what the render's threads do, by stage and by effect.",
    ),
    click.option("--strict", is_flag=True, help="Exit with code 3 if anything was missing or degraded."),
)
"""Which files are written, and how."""

CONFORM: Sequence[Decorator] = (
    click.option(
        "--suite",
        type=click.Path(path_type=Path),
        metavar="DIR",
        help="Folder with a rules.json. Default: testenv/motion of the checkout.",
    ),
    click.option(
        "--rules",
        "pattern",
        default="*",
        show_default=True,
        metavar="GLOB[,...]",
        help="Run only rules whose names match.",
    ),
    click.option(
        "--spp",
        type=click.IntRange(1, MAX_SPP),
        default=256,
        show_default=True,
        help="Samples per pixel; the allowed error follows from it. Fewer is faster but less sensitive.",
    ),
    click.option("--json", "as_json", is_flag=True, help="Print JSON, for scripts."),
    click.option("--out", type=click.Path(path_type=Path), metavar="DIR", help="Keep images and logs in this folder."),
    click.option(
        "--command",
        default="",
        metavar="COMMAND",
        help="Test another renderer, such as 'usdrecord --renderer X'. usdrecord's options, the scene and the image are"
        " appended, unless the command has placeholders: {scene} {out} {frame} {frames} {width} {height} {camera}"
        " {shutter}.",
    ),
    click.option(
        "--shutter",
        type=ShutterRange(),
        metavar="OPEN:CLOSE",
        help="Render the rules' scenes with this shutter instead of their own. Their answers are evaluated anew, which takes"
        " seconds per rule. If the command has no {shutter}, the scenes' cameras are given it.",
    ),
    click.option(
        "--timeout",
        type=click.FloatRange(0.0, min_open=True),
        callback=finite,
        default=120.0,
        show_default=True,
        metavar="SECONDS",
        help="Time limit of another renderer, per rule.",
    ),
)
"""What the suite is, and which renderer is held to it."""
