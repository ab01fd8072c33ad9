"""Rays a second and bytes of compact trees over full ones, interleaved in one run: docs/design/compact.md.

    .venv/bin/python bench/layouts.py [--triangles N] [--repetitions R] [--scene NAME]... [--segments S]... [--bench FILE]

Ratios are compact over full, each of its fastest round, of many rays at once on one thread: on a machine that others use
the fastest round is the one that was disturbed least. Bytes are a triangle's: what the tree holds,
and with the meshes' own tracks that its leaves read, which scenes hold in either layout. Prints a Markdown table.
"""

from __future__ import annotations

import json
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import click

SCENES = ("hairball", "cloth", "debris", "room", "wheels", "crowd")
SEGMENTS = ("0", "1", "8")
RAYS = ("primary", "shadow", "random")
BENCH = Path(__file__).parents[1] / "build/release/bench/msbvh_bench"

Row = dict[str, Any]


def held_bytes(row: Row) -> float:
    """A triangle's, of the tree alone."""
    return float(row["bytes_per_tri"]) - float(row["vertex_bytes_per_tri"])


def table_row(scene: str, rows: list[Row]) -> str:
    """Of a scene at a number of keys: rows of both layouts for each kind of ray."""
    of = {(row["layout"], row["rays"]): row for row in rows}
    full, compact = of["full", "primary"], of["compact", "primary"]
    cells = [scene, str(full["keys"])]
    cells += [f"{of['compact', kind]['mrays_high'] / of['full', kind]['mrays_high']:.2f}" for kind in RAYS]
    cells += [f"{held_bytes(full):.0f}", f"{held_bytes(compact):.0f}", f"{held_bytes(compact) / held_bytes(full):.2f}"]
    return " | ".join([*cells, f"{compact['bytes_per_tri'] / full['bytes_per_tri']:.2f}"])


def measured(bench: Path, triangles: int, repetitions: int, scene: str, segments: str) -> Iterator[Row]:
    """The bench's rows; every kind of ray, both layouts. Raises CalledProcessError."""
    arguments = [bench, scene, str(triangles), segments, "1", "all", str(repetitions), "msbvh/both"]
    run = subprocess.run(arguments, check=True, capture_output=True, text=True)
    for line in run.stdout.splitlines():
        if line.startswith("{"):
            yield json.loads(line)


@click.command(help=(__doc__ or "").split("\n\n", maxsplit=1)[0])
@click.option("--triangles", type=click.IntRange(1), default=50000, show_default=True, help="Of each scene, about.")
@click.option("--repetitions", type=click.IntRange(1), default=15, show_default=True, help="Rounds of either layout.")
@click.option("--scene", "scenes", multiple=True, default=SCENES, help="Class of msbvh_bench. May be given again.")
@click.option("--segments", "segments", multiple=True, default=SEGMENTS, help="0: still. May be given again.")
@click.option("--bench", type=click.Path(exists=True, path_type=Path), default=BENCH, help="msbvh_bench.")
def main(triangles: int, repetitions: int, scenes: tuple[str, ...], segments: tuple[str, ...], bench: Path) -> None:
    print("| scene | keys | primary | shadow | random | full B | compact B | held | with tracks |")
    print("|---" * 9 + "|")
    for scene in scenes:
        for count in segments:
            rows = list(measured(bench, triangles, repetitions, scene, count))
            if wrong := sum(row["mismatches"] for row in rows):
                raise click.ClickException(f"{scene}: {wrong} answers are not the oracle's")
            print(f"| {table_row(scene, rows)} |", flush=True)


if __name__ == "__main__":
    main()
