"""`msbvh conform`."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import click

from ..base.exit_codes import DONE, WRONG
from ..base.progress import Progress
from ..conform.record import read_record
from ..conform.shutter import check_suite, shutter_text, with_shutter
from ..conform.suite import Rule, conform, find_suite, other_renderer, own_renderer, read_rules, table
from .options import CONFORM, with_options


@click.command("conform")
@with_options(CONFORM)
def conform_command(
    suite: Path | None,
    pattern: str,
    spp: int,
    as_json: bool,
    out: Path | None,
    command: str,
    timeout: float,
    shutter: tuple[float, float] | None,
) -> int:
    """Hold a renderer to the rules of USD's motion: one small scene each, its alpha against the coverage that
    usd-core's own evaluation has.

    Exit code 1 if a rule fails. The renderer is msbvh, or any other that --command runs. Errors may be what
    noise explains; those of msbvh itself also no larger than in the suite's recorded run.
    """
    text = shutter_text(shutter) if shutter else ""
    renderer = replace(other_renderer(command, timeout), shutter=text) if command else own_renderer(spp, text)
    folder = find_suite(suite)
    rules = read_rules(folder, pattern)
    if shutter is not None:
        check_suite(folder)

    # Under another shutter the answers, and so the errors, are others than those that were recorded.
    record = {} if command or shutter is not None else read_record(folder, spp)

    def prepare(rule: Rule, scratch: Path) -> Rule:
        if shutter is None:
            return rule
        return with_shutter(rule, folder, shutter, scratch, renderer.knows_shutter)

    with Progress("msbvh: conform") as progress:
        outcomes = list(conform(rules, renderer, spp, out, progress, record, prepare))
    if as_json:
        plain = {"renderer": renderer.name, "rules": [outcome.plain() for outcome in outcomes]}
        print(json.dumps(plain, indent=2))
    else:
        print(table(outcomes))
    return DONE if all(outcome.passed for outcome in outcomes) else WRONG
