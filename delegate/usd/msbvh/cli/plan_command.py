"""`msbvh plan`."""

from __future__ import annotations

import json
from typing import Any

import click

from .. import _core
from ..base.exit_codes import DONE
from ..base.reporter import Reporter
from ..plan_report.report import first_reasons, plain, plan_report
from ..plan_report.table import plan_text
from ..render.record import report
from ..scene.reader import ReadResult
from .frame_options import read_one_frame
from .options import ONE_FRAME, SCENE, with_options
from .render_options import MAX_BOUNCES

OPTIONS = (
    MAX_BOUNCES,
    click.option(
        "--rays",
        type=click.IntRange(0, 1_000_000),
        default=2000,
        show_default=True,
        help="Camera rays that the prediction is made by, with all that follow from them. The trees are built for it: seconds on"
        " large scenes. 0: neither.",
    ),
)


@click.command("plan")
@with_options(SCENE, ONE_FRAME, OPTIONS)
def plan_command(scene: str, frame: str | None, as_json: bool, rays: int, **options: Any) -> int:
    """Print the effects that SCENE calls for, the prims that ask for each, its share of the scene's geometry, and a
    prediction of its share of the rays' work.

    Bytes are counted in what was read, before any tree is built. The prediction is of traversal, by a few of the frame's own
    rays; what a whole frame's rays say of it is in --stats of `record --ray-costs`.
    """
    reporter = Reporter()
    _, _, result = read_one_frame("plan", scene, frame, options, reporter)
    report(result.diagnostics, reporter)
    bounces = options["max_bounces"]
    costs = _costs(result, rays, bounces) if rays else None
    found = plan_report(
        result.scene, costs, max_bounces=bounces, left_out=result.left_out, coarser=result.coarser_tracks
    )
    if as_json:
        said = {"warnings": reporter.warnings, "errors": reporter.errors}
        print(json.dumps({"scene": scene, "plan": first_reasons(found), **plain(found), **said}, indent=2))
    else:
        print(plan_text(found))
    return DONE


def _costs(result: ReadResult, rays: int, bounces: int) -> _core.RayCosts | None:
    """None where nothing is in the frame that rays could meet."""
    camera = result.camera
    renderer = _core.Renderer(result.scene, width=camera.width, height=camera.height, spp=1, max_bounces=bounces)
    costs = renderer.ray_costs(camera_samples=rays)
    return costs if costs["prims"] else None
