"""The options of the commands, as tables. Names are usdrecord's where it has the option; the help says what
each costs."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import click

from . import _core
from .color import MODES
from .conform import POLICIES
from .option_types import Names, Numbers, PowerOfTwo, ShutterRange
from .reader import MAX_INSTANCES

PURPOSES = ("default", "render", "proxy", "guide")
MAX_PIXELS_ACROSS = 65535
MAX_SPP = 1 << 20
INTERPOLATIONS = ("auto", "linear", "quadratic", "cubic")


def _unsupported(hint: str) -> Callable[..., None]:
    """A callback for options of usdrecord that change the picture and that we cannot honour yet."""

    def refuse(ctx: click.Context, param: click.Parameter, value: Any) -> None:
        if value:
            raise click.UsageError(f"{param.opts[0]} is not supported yet{hint}", ctx)

    return refuse


def _finite(ctx: click.Context, param: click.Parameter, value: float) -> float:
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
    help="Open for this part of each frame, in frames relative to it, such as -0.25:0.25 or 0:0.5; 0:0 closes it."
    " Default: the camera's shutter:open and shutter:close, closed where nobody has authored them. Costs nothing"
    " by itself: what moves takes memory for its motion.",
)

SCENE: Sequence[Decorator] = (
    click.argument("scene", type=click.Path(path_type=str)),
    click.option(
        "--camera",
        "-cam",
        metavar="NAME|PATH",
        help="By prim name or path. Default: main_cam, else the first one, else one that frames all.",
    ),
    click.option(
        "--defaultTime",
        "-d",
        "default_time",
        is_flag=True,
        help="Read the stage at its default time instead of its start time; nothing moves then.",
    ),
    SHUTTER,
    click.option(
        "--imageWidth",
        "-w",
        "image_width",
        type=click.IntRange(1, MAX_PIXELS_ACROSS),
        default=960,
        show_default=True,
        help="Pixels; the height follows from the camera's aspect ratio.",
    ),
    click.option(
        "--resolution",
        nargs=2,
        type=click.IntRange(1, MAX_PIXELS_ACROSS),
        metavar="W H",
        help="Pixels; overrides --imageWidth. --conform says what happens to the camera's aspect ratio.",
    ),
    click.option(
        "--conform",
        type=click.Choice(POLICIES),
        default="expandAperture",
        show_default=True,
        help="How the camera fits a --resolution of another shape (UsdRenderSettings' policies).",
    ),
    click.option(
        "--purposes",
        type=Names(PURPOSES),
        default="proxy",
        show_default=True,
        metavar="PURPOSE[,...]",
        help="Purposes that are drawn beside default.",
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
        callback=_finite,
        default=0.1,
        show_default=True,
        help="Pixels that a track may stray from the stage's own motion. Less: more keys, more memory.",
    ),
    click.option(
        "--interpolation",
        type=click.Choice(INTERPOLATIONS),
        default="auto",
        show_default=True,
        help="Of meshes and instances between keys. linear: the quickest rays, but arcs take many segments."
        " quadratic, cubic: 2 or 3 times the bytes a segment and slower rays, but arcs take few."
        " auto: for each prim what takes the fewest bytes.",
    ),
    click.option(
        "--segments",
        type=PowerOfTwo(),
        default=None,
        metavar="N",
        help="Exactly these for meshes and instances that move: a power of two, 1 to 128. Memory grows in"
        " proportion; too few miss --motion-tolerance, with a warning. Default: as few as it takes.",
    ),
    click.option(
        "--max-instances",
        type=click.IntRange(1),
        default=MAX_INSTANCES,
        show_default=True,
        metavar="N",
        help="More are refused before they are read; nested ones are multiplied out. Each takes about 1 kB.",
    ),
    click.option(
        "--disableCameraLight",
        "disable_camera_light",
        is_flag=True,
        help="No light at the camera where the scene has no lights.",
    ),
    click.option(
        "--complexity",
        "-c",
        type=click.Choice(("low", "medium", "high", "veryhigh")),
        default="low",
        show_default=True,
        help="How fine spheres, cones and the like are: within 0.1, 0.05, 0.025 or 0.0125 pixels of the true shape."
        " Each step takes twice the triangles. Subdivision surfaces are polygons at any value.",
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
        callback=_unsupported("; give --camera and --resolution"),
        expose_value=False,
        metavar="PRIMPATH",
        help="Not supported yet.",
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

ONE_FRAME: Sequence[Decorator] = (
    click.option("--frame", "-f", metavar="TIMECODE", help="Default: the stage's start time."),
    click.option("--json", "as_json", is_flag=True, help="For scripts."),
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
        help="For PNG, JPEG, TIFF; EXR stays linear. sRGB does not tone-map.",
    ),
    click.option(
        "--ocio-display", metavar="NAME", help="Of mode openColorIO; default: the built-in config's."
    ),
    click.option("--ocio-view", metavar="NAME", help="Of mode openColorIO; default: the display's."),
    click.option(
        "--aov",
        "aovs",
        type=Names(_core.aov_names()),
        default=(),
        metavar="NAME[,...]",
        help=f"Beside colour, as 32-bit channels of .exr files: any of {', '.join(_core.aov_names())}. Normals and albedo are"
        " means, depths and ids those of a pixel's nearest sample; where nothing is, ids are -1, depth 1, the rest 0.",
    ),
    click.option("--exr-float", is_flag=True, help="EXR in 32-bit floats instead of half: twice the bytes."),
    click.option(
        "--stats",
        type=click.Path(path_type=Path),
        metavar="FILE.json",
        help="Write times, counts, memory, the effect plan and the warnings.",
    ),
    click.option("--strict", is_flag=True, help="Exit with 3 if anything was missing or degraded."),
)
"""Which files are written, and how."""

RENDER: Sequence[Decorator] = (
    click.option(
        "--spp",
        type=click.IntRange(1, MAX_SPP),
        default=64,
        show_default=True,
        help="Samples a pixel: noise falls with the square root, time grows in proportion.",
    ),
    click.option(
        "--seed",
        type=click.IntRange(0, 2**32 - 1),
        default=0,
        show_default=True,
        help="The same seed gives the same pixels, on any number of threads.",
    ),
    click.option(
        "--max-bounces",
        type=click.IntRange(0, 64),
        default=2,
        show_default=True,
        help="Of indirect light; 0: direct light only.",
    ),
    click.option(
        "--enableDomeLightVisibility",
        "show_domes",
        is_flag=True,
        help="Dome lights are seen behind the scene; alpha is coverage all the same.",
    ),
    click.option("--threads", type=click.IntRange(0, 4096), default=0, show_default=True, help="0: all."),
    click.option(
        "--builder",
        type=click.Choice(tuple(_core.builders())),
        default="msbvh",
        show_default=True,
        help="For comparison: mbvh has no spatial splits (the paper's baseline), swept has still boxes (slow rays),"
        " timesplit a tree for each motion segment (bytes and build grow with them).",
    ),
    click.option(
        "--refit",
        type=click.Choice(("auto", "always", "never")),
        default="auto",
        show_default=True,
        help="Over frames: auto keeps the trees of what stands still and refits those of what moves, until rays"
        " have become dearer by a fifth; always: however dear. Both hold the last frame beside the next. never:"
        " builds each anew, for the quickest rays and the least memory. The picture is the same.",
    ),
    click.option("--renderer", "-r", metavar="NAME", help="Accepted for usdrecord's sake; this is msbvh."),
    click.option("--disableGpu", is_flag=True, expose_value=False, help="Accepted; there is no GPU in use."),
)
"""How the renderer works."""

CONFORM: Sequence[Decorator] = (
    click.option(
        "--suite",
        type=click.Path(path_type=Path),
        metavar="DIR",
        help="A folder with rules.json. Default: testenv/motion of the checkout.",
    ),
    click.option(
        "--rules",
        "pattern",
        default="*",
        show_default=True,
        metavar="GLOB[,...]",
        help="Only rules of these names.",
    ),
    click.option(
        "--spp",
        type=click.IntRange(1, MAX_SPP),
        default=256,
        show_default=True,
        help="Samples a pixel that msbvh takes and the allowed error is for. Fewer: quicker, and blinder.",
    ),
    click.option("--json", "as_json", is_flag=True, help="For scripts."),
    click.option("--out", type=click.Path(path_type=Path), metavar="DIR", help="Keeps images and logs."),
    click.option(
        "--command",
        default="",
        metavar="COMMAND",
        help="Another renderer, such as 'usdrecord --renderer X'. usdrecord's options, scene and image"
        " follow, unless it names {scene} {out} {frame} {frames} {width} {height} {camera} {shutter} itself.",
    ),
    click.option(
        "--shutter",
        type=ShutterRange(),
        metavar="OPEN:CLOSE",
        help="Hold the rules' scenes under this shutter instead of their own. The suite's own evaluation makes the"
        " answers anew: seconds a rule. A renderer whose command has no {shutter} gets scenes whose cameras have it.",
    ),
    click.option(
        "--timeout",
        type=click.FloatRange(0.0, min_open=True),
        callback=_finite,
        default=120.0,
        show_default=True,
        metavar="SECONDS",
        help="How long another renderer may take for a rule.",
    ),
)
"""What the suite is, and which renderer is held to it."""

BENCH: Sequence[Decorator] = (
    click.option(
        "--scenes",
        type=Names(),
        default="*",
        show_default=True,
        metavar="GLOB[,...]",
        help="Only scenes of these names: wheels, or wheels-9 for one number of keys. shared/*: public scenes"
        " in ../shared/scenes.",
    ),
    click.option(
        "--peer",
        type=click.Choice(("embree", "cycles")),
        help="Measure it side by side. Embree comes from the wheel embreex: pip install embreex==4.4.*. Cycles, for"
        " --frames: see --peer-env.",
    ),
    click.option("--quick", is_flag=True, help="Small scenes and few rays: under 50 seconds on two cores."),
    click.option("--json", "as_json", is_flag=True, help="For scripts."),
    click.option(
        "--builder",
        "builders",
        multiple=True,
        type=click.Choice(tuple(_core.builders())),
        help="Only this one; may be repeated. Default: msbvh and mbvh.",
    ),
    click.option(
        "--threads",
        type=Numbers(),
        metavar="N[,...]",
        help="Numbers of threads to measure with, 0: all. Default: 1,0; of a quick run 1.",
    ),
    click.option("--seed", type=click.IntRange(0, 2**31 - 1), default=1, show_default=True, help="Of scenes and rays."),
    click.option(
        "--repetitions",
        type=click.IntRange(1, 1000),
        help="Rounds, in which each side has its turn. Default: 5; of a quick run 3.",
    ),
    click.option(
        "--triangles",
        type=click.IntRange(64, 100_000_000),
        help="About so many in every procedural scene. Default: each one's own, 10 thousand to 2 million.",
    ),
    click.option("--out", type=click.Path(path_type=Path, file_okay=False), metavar="DIR", help="For bench.json."),
)
"""What is measured, against whom, and how often."""
