"""`msbvh plan`."""

from __future__ import annotations

import json
from typing import Any

import click

from ..base.exit_codes import DONE
from ..base.reporter import Reporter
from ..plan_report.report import first_reasons, plain, plan_report
from ..plan_report.table import plan_text
from ..render.record import report
from .frame_options import read_one_frame
from .options import ONE_FRAME, SCENE, with_options


@click.command("plan")
@with_options(SCENE, ONE_FRAME)
def plan_command(scene: str, frame: str | None, as_json: bool, **options: Any) -> int:
    """Print the effects that SCENE calls for, the prims that ask for each, and its share of the scene's geometry.

    Bytes are counted in what was read, before any tree is built.
    """
    reporter = Reporter()
    _, _, result = read_one_frame("plan", scene, frame, options, reporter)
    report(result.diagnostics, reporter)
    found = plan_report(result.scene)
    if as_json:
        said = {"warnings": reporter.warnings, "errors": reporter.errors}
        print(json.dumps({"scene": scene, "plan": first_reasons(found), **plain(found), **said}, indent=2))
    else:
        print(plan_text(found))
    return DONE
