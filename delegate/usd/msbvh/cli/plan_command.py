"""`msbvh plan`."""

from __future__ import annotations

import json
from typing import Any

import click

from .. import _core
from ..base.exit_codes import DONE
from ..base.progress import Progress
from ..base.reporter import Reporter
from ..plan_report.report import first_reasons, plain, plan_report
from ..plan_report.table import plan_text
from ..render.record import report
from ..scene.reader import ReadResult
from .frame_options import read_one_frame
from .options import MAX_SPP, ONE_FRAME, SCENE, with_options
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
    click.option(
        "--measure",
        is_flag=True,
        help="Render the frame, without writing it, look a thousand times a second at what its threads do, and print what each"
        " effect took.",
    ),
    click.option(
        "--spp",
        type=click.IntRange(1, MAX_SPP),
        default=4,
        show_default=True,
        help="Samples a pixel of that render. Ten thousand looks tell shares to half a percent; more take longer.",
    ),
)


@click.command("plan")
@with_options(SCENE, ONE_FRAME, OPTIONS)
def plan_command(
    scene: str, frame: str | None, as_json: bool, rays: int, measure: bool, spp: int, **options: Any
) -> int:
    """Print the effects that SCENE calls for, the prims that ask for each, its share of the scene's geometry, and a
    prediction of its share of the rays' work.

    Bytes are counted in what was read, before any tree is built. The prediction is of traversal, by a few of the frame's own
    rays; what a whole frame's rays say of it, and what each effect took of the render, is in --stats of `record --ray-costs`.
    --measure renders the frame for the latter.
    """
    reporter = Reporter()
    _, _, result = read_one_frame("plan", scene, frame, options, reporter)
    report(result.diagnostics, reporter)
    bounces = options["max_bounces"]
    costs, stages = _traced(result, rays, spp if measure else 0, bounces)
    found = plan_report(result.scene, costs, stages, max_bounces=bounces, left_out=result.left_out)
    if as_json:
        said = {"warnings": reporter.warnings, "errors": reporter.errors}
        print(json.dumps({"scene": scene, "plan": first_reasons(found), **plain(found), **said}, indent=2))
    else:
        print(plan_text(found))
    return DONE


def _traced(
    result: ReadResult, rays: int, spp: int, bounces: int
) -> tuple[_core.RayCosts | None, list[_core.StageSamples]]:
    """The costs of a sample of so many of the frame's rays, and what threads were found at in a render of `spp` samples a pixel;
    0: none. No costs where nothing is in the frame that rays could meet."""
    if not rays and not spp:
        return None, []
    camera = result.camera
    renderer = _core.Renderer(
        result.scene,
        width=camera.width,
        height=camera.height,
        spp=max(spp, 1),
        max_bounces=bounces,
        sample_stages=spp > 0,
    )
    costs = renderer.ray_costs(camera_samples=rays) if rays else None
    if spp:
        with Progress("msbvh: measuring") as progress:
            renderer.render(progress)
    return costs if costs and costs["prims"] else None, renderer.statistics["stages"]
