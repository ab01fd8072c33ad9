"""`msbvh reshutter`."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import click

from .._core import SHUTTER_CURVES
from ..base.atomic import OutputClash
from ..base.exit_codes import DONE, WRONG
from ..base.reporter import Reporter
from ..look.color import ColorCorrection
from ..output.images import ImageReadError, ImageSettings, Layers, check_image_path, write_image
from ..output.reshutter import read_slices
from ..render.shutter_curve import Curve, area
from .option_types import ShutterCurve, ShutterRange


@click.command("reshutter")
@click.argument("picture", metavar="IN", type=click.Path(path_type=Path))
@click.argument("output", metavar="OUT", type=click.Path(path_type=Path))
@click.option(
    "--shutter",
    type=ShutterRange(),
    metavar="OPEN:CLOSE",
    help="Shutter interval in frames, relative to the picture's: a part of the one that was rendered. Default: all of it. A"
    " slice that it cuts counts by the part that is in it.",
)
@click.option(
    "--curve",
    type=ShutterCurve(),
    default="box",
    show_default=True,
    metavar="NAME|FILE",
    help=f"How that shutter opens and closes: {', '.join(SHUTTER_CURVES)}, or a file, as of record --shutter-curve.",
)
@click.option("--exr-float", is_flag=True, help="Write 32-bit float EXR files instead of half.")
def reshutter_command(
    picture: Path, output: Path, shutter: tuple[float, float] | None, curve: Curve, exr_float: bool
) -> int:
    """Make of IN, an .exr file of `msbvh record --shutter-slices N`, the picture OUT of a shorter shutter, or of one that
    opens and closes in another way, without rendering. Other AOVs of IN are of the whole shutter, and are left out.
    """
    if check_image_path(output) == picture.resolve():
        raise OutputClash(f"'{output}' is the picture that is read, whose slices would be lost; expected another file")
    try:
        found = read_slices(picture)
        pixels, taken = found.with_shutter(shutter, lambda a, b: area(curve, a, b))
    except ImageReadError as error:
        Reporter.error(str(error))
        return WRONG
    layers = Layers(pixels, origin=found.origin, display=found.display)
    settings = ImageSettings(ColorCorrection(rendering_space=found.rendering_space), False, exr_float)
    write_image(output, layers, replace(found.metadata, shutter=taken), settings)
    return DONE
