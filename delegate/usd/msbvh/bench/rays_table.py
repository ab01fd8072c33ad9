"""The benchmark's report for people."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

COLUMNS: Sequence[tuple[str, str, str]] = (
    ("scene", "scene", "{}"),
    ("triangles", "triangles", "{}"),
    ("keys", "keys", "{}"),
    ("rays", "rays", "{}"),
    ("builder", "builder", "{}"),
    ("threads_used", "thr", "{}"),
    ("robust", "robust", "{:d}"),
    ("single_mrays", "one: Mrays/s", "{:.2f}"),
    ("mrays", "many: Mrays/s", "{:.2f}"),
    ("peer_mrays", "peer", "{:.2f}"),
    ("peer_mode", "in mode", "{}"),
    ("ratio", "ratio", "{:.2f}"),
    ("bytes_per_tri", "B/tri", "{:.0f}"),
    ("peer_bytes_per_tri", "peer", "{:.0f}"),
    ("build_s", "build s", "{:.2f}"),
    ("peer_build_s", "peer", "{:.2f}"),
    ("nodes_per_ray", "nodes", "{:.1f}"),
    ("tests_per_ray", "tests", "{:.1f}"),
    ("sah", "SAH", "{:.1f}"),
    ("duplication", "dup", "{:.2f}"),
    ("misses", "leaks", "{:.0f}"),
    ("peer_misses", "peer", "{:.0f}"),
    ("mismatches", "wrong", "{}"),
    ("peer_mismatches", "differ", "{:.0f}"),
)
"""(key of a row, heading, format)."""


def table(report: dict[str, Any]) -> str:
    """Lines of equal columns, under a line about the machine. Speeds are Mrays/s: ours one ray at a time and many at once,
    the peer in the best of its modes; the ratio is that of the last two."""
    rows = [[heading for _, heading, _ in COLUMNS], *([*map(str, cells(row))] for row in report["rows"])]
    widths = [max(len(row[i]) for row in rows) for i in range(len(COLUMNS))]
    lines = ["  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True)) for row in rows]
    return "\n".join([machine_line(report["machine"]), *lines])


def cells(row: dict[str, Any]) -> list[str]:
    """A row's figures as text; `-` for what was not measured."""
    return ["-" if row[key] in (None, "") else form.format(row[key]) for key, _, form in COLUMNS]


def machine_line(machine: dict[str, Any]) -> str:
    """What the figures depend on, in a line."""
    against = f" against {machine['peer']}" if machine["peer"] else ""
    return (
        f"msbvh {machine['msbvh']}{against}; {machine['processor']}, {machine['cores']} cores,"
        f" {machine['instruction_set']}; seed {machine['seed']}, median of {machine['repetitions']}"
    )
