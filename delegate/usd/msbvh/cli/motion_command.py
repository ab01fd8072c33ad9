"""`msbvh motion`."""

from __future__ import annotations

import json
import sys
from typing import Any

import click

from ..base.errors import Diagnostics
from ..base.exit_codes import DONE, WRONG
from ..base.reporter import Reporter
from ..motion.samples import SampleLog
from ..motion_report.report import motion_report
from ..motion_report.table import beyond_text, motion_text
from ..render.record import report
from ..stage.opening import tf_messages
from .frame_options import read_one_frame
from .options import ONE_FRAME, SCENE, with_options


@click.command("motion")
@with_options(SCENE, ONE_FRAME)
@click.argument("prim", required=False)
@click.option("--verbose", "-v", is_flag=True, help="Rule and samples of every prim, the still ones too.")
def motion_command(
    scene: str, prim: str | None, frame: str | None, as_json: bool, verbose: bool, **options: Any
) -> int:
    """Print how the prims of SCENE move within the shutter: the samples found, the rule that decided, the
    track that follows them, its error in pixels and its bytes.

    PRIM limits the report to a prim and those below it, with the rule and the samples of each. Exit code 1 if
    a track misses --motion-tolerance, times --outside-tolerance for what is outside of the picture.
    """
    reporter, log = Reporter(), SampleLog()
    stage, time, result = read_one_frame("motion", scene, frame, options, reporter, log)
    with tf_messages(Diagnostics()):  # They have been said while the frame was read.
        found = motion_report(stage, time, result, log, result.settings.motion_tolerance, prim)
    if prim is None:
        report(result.diagnostics, reporter)
    if as_json:
        print(json.dumps({"scene": scene, **found.plain()}, indent=2, allow_nan=False))
    else:
        print(motion_text(found, prim, verbose))
    if found.beyond:
        sys.stdout.flush()
        Reporter.error(beyond_text(found, result.settings.segments, result.settings.interpolation))
    return WRONG if found.beyond else DONE
