"""`msbvh verify`."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import click

from .. import _core
from ..base.exit_codes import DONE, WRONG
from ..base.progress import Progress
from ..base.reporter import Reporter
from ..render.record import report
from ..scene.reader import ReadResult, read_frame
from ..verify.checks import Verdict, VerifySettings, verify
from ..verify.hard_shells import FRAME, SHUTTER, hard_shells
from ..verify.table import summary_text, verdict_text
from .frame_options import read_one_frame, read_settings
from .options import ONE_FRAME, READING, with_options

OPTIONS = (
    click.option(
        "--rays",
        type=click.IntRange(1, 1_000_000_000),
        default=100_000,
        show_default=True,
        help="Rays of each probe and instruction set. Time grows with them, but for the oracle, which judges as many as"
        " a fixed number of tests allows.",
    ),
    click.option(
        "--seed", type=click.IntRange(0, 2**31 - 1), default=1, show_default=True, help="Random seed of the rays."
    ),
    click.option(
        "--builder",
        type=click.Choice(tuple(_core.builders())),
        default="msbvh",
        show_default=True,
        help="Whose trees are looked at.",
    ),
)


@click.command("verify")
@click.argument("scene", required=False, type=click.Path(path_type=str))
@with_options(READING, ONE_FRAME, OPTIONS)
def verify_command(
    scene: str | None, frame: str | None, as_json: bool, rays: int, seed: int, builder: Any, **options: Any
) -> int:
    """Look for defects in the trees of SCENE: whether boxes enclose what they hold at every key, whether rays at edges,
    at vertices, along faces and from surfaces find what the oracle finds, by every instruction set of this machine, one
    by one and many at once, and whether rays that start inside closed meshes get out.

    Without SCENE: closed shells in hard motion, such as whole turns, a million units away, or turned inside out. Exit
    code 1 if something is wrong.
    """
    settings = VerifySettings(rays, seed, builder)
    verdicts: list[Verdict] = []
    for name, result in _frames(scene, frame, options):
        with Progress(f"msbvh: verify: {name}") as progress:
            verdicts.append(verify(name, result, settings, progress))
        if not as_json:
            print(verdict_text(verdicts[-1]), flush=True)
    if as_json:
        print(json.dumps([verdict.plain() for verdict in verdicts], indent=2))
    else:
        print(summary_text(verdicts))
    return DONE if all(verdict.holds for verdict in verdicts) else WRONG


def _frames(scene: str | None, frame: str | None, options: dict[str, Any]) -> Iterator[tuple[str, ReadResult]]:
    """What is looked at, one after the other, by name."""
    reporter = Reporter()
    if scene is not None:
        _, _, result = read_one_frame("verify", scene, frame, options, reporter)
        report(result.diagnostics, reporter)
        yield scene, result
        return
    settings = read_settings({**options, "shutter": options["shutter"] or SHUTTER})
    for name, stage in hard_shells().items():
        result = read_frame(stage, FRAME, settings)
        report(result.diagnostics, reporter)
        yield name, result
