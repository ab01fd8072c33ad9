"""`msbvh plan`."""

from __future__ import annotations

import json
from typing import Any

import click

from ..base.exit_codes import DONE
from ..base.progress import PATIENCE_SECONDS, Progress
from ..base.reporter import Reporter
from ..plan_report.pilot import Traced, traced
from ..plan_report.report import first_reasons, plain, plan_report
from ..plan_report.table import plan_text
from ..render.record import report
from ..scene.reader import ReadResult
from .frame_options import read_one_frame
from .options import MAX_SPP, ONE_FRAME, SCENE, with_options
from .render_options import MAX_BOUNCES, REFRACTION

OPTIONS = (
    MAX_BOUNCES,
    REFRACTION,
    click.option(
        "--rays",
        type=click.IntRange(0, 1_000_000),
        default=2000,
        show_default=True,
        help="Camera rays that the prediction is made by, with all that follow from them, beside a small render. The trees are"
        " built for it: seconds on large scenes. 0: none of these.",
    ),
    click.option(
        "--measure",
        is_flag=True,
        help="Render the frame, without writing it, look a thousand times a second at what its threads do, and print what each"
        " effect took. The trees are built again for it.",
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
    prediction of its share of the rays' work and of the render's time.

    Bytes are counted in what was read, before any tree is built. The rays' work is traversal, by a few of the frame's own
    rays; the time is that of a small render of about 260,000 camera samples, which tells it to a few percent. What a whole
    frame's rays say, and what each effect took of the render, is in --stats of `record --ray-costs`. --measure renders the frame
    for the latter.
    """
    reporter = Reporter()
    _, _, result = read_one_frame("plan", scene, frame, options, reporter)
    report(result.diagnostics, reporter)
    wanted = result.settings.max_bounces  # The option's, or that of render settings.
    bounces = options["max_bounces"] if wanted is None else wanted
    refraction = options["refraction"]  # Likewise.
    frame_rays = _traced(result, rays, spp if measure else 0, bounces, refraction)
    found = plan_report(
        result.scene,
        frame_rays,
        max_bounces=bounces,
        refraction=refraction,
        left_out=result.left_out,
        coarser=result.coarser_tracks,
    )
    if as_json:
        said = {"warnings": reporter.warnings, "errors": reporter.errors}
        print(json.dumps({"scene": scene, "plan": first_reasons(found), **plain(found), **said}, indent=2))
    else:
        print(plan_text(found))
    return DONE


def _traced(result: ReadResult, rays: int, spp: int, bounces: int, refraction: bool) -> Traced:
    size = result.camera.width, result.camera.height
    label, patience = ("measuring", 0.0) if spp else ("predicting", PATIENCE_SECONDS)
    with Progress(f"msbvh: {label}", delay_seconds=patience) as progress:
        return traced(
            result.scene, size, rays=rays, spp=spp, max_bounces=bounces, refraction=refraction, progress=progress
        )
