"""`msbvh bench`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import click

from ..base.atomic import check_folder, check_writable, write_whole
from ..base.exit_codes import DONE, WRONG
from ..base.progress import Progress
from ..base.reporter import Reporter
from ..bench.frames import FrameSettings
from ..bench.frames import run as run_frames
from ..bench.frames_table import table as frames_table
from ..bench.rays import BenchSettings
from ..bench.rays import run as run_bench
from ..bench.rays_table import table as bench_table
from ..bench.stability import StabilitySettings
from ..bench.stability import run as run_stability
from ..bench.stability_table import table as stability_table
from .bench_options import BENCH, FRAMES, STABILITY, chosen_bench
from .options import with_options
from .thread_note import note_threads

TABLES = {"rays": bench_table, "frames": frames_table, "stability": stability_table}


@click.command("bench")
@with_options(BENCH, STABILITY, FRAMES)
def bench_command(as_json: bool, out: Path | None, **options: Any) -> int:
    """Measure rays a second, build times and bytes on seeded scenes, with a peer side by side in the same run.

    Exit code 1 if our answers differ from the oracle's, if many rays at once differ from one at a time, or if a closed
    scene leaks. With --frames: whole frames of five scenes, each renderer in processes of its own; exit code 1 if another
    one's picture differs, so that times cannot be compared. With --stability: rays from inside of closed moving shapes,
    and into tubes and spheres; exit code 1 if one of ours is lost or differs from the oracle beyond its bound.
    """
    reporter = Reporter()
    chosen, options = chosen_bench(options)
    note_threads(options.get("threads") or (), reporter)
    name = f"{'bench' if chosen == 'rays' else chosen}.json"
    if out is not None:
        check_folder(out)
        check_writable(out / name)
    with Progress("msbvh: bench") as progress:
        if chosen == "frames":
            result = run_frames(FrameSettings(**options), out, progress, reporter.note)
        elif chosen == "stability":
            result = run_stability(StabilitySettings(**options), progress, reporter.note)
        else:
            result = run_bench(BenchSettings(**options), progress, reporter.note)
    if out is not None:
        write_whole(out / name, f"{json.dumps(result, indent=1)}\n".encode())
    print(json.dumps(result) if as_json else TABLES[chosen](result))
    return WRONG if any(wrong_row(row) for row in result["rows"]) else DONE


def wrong_row(row: dict[str, Any]) -> bool:
    """Of a benchmark: whether an answer is wrong."""
    if "comparable" in row:
        return row["comparable"] is False
    if "leaks" in row:
        return bool(row["leaks"] or row["wrong"])
    return bool(row["mismatches"] or row["mode_mismatches"] or row["misses"])
