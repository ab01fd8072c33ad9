"""The report of `msbvh bench --frames` for people."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

MEGABYTE = 1 << 20

COLUMNS: Sequence[tuple[str, str, str]] = (
    ("scene", "scene", "{}"),
    ("look", "look", "{}"),
    ("threads", "thr", "{}"),
    ("side", "side", "{}"),
    ("read_s", "read s", "{:.2f}"),
    ("build_s", "build", "{:.2f}"),
    ("trace_s", "trace", "{:.2f}"),
    ("start_s", "start", "{:.2f}"),
    ("process_s", "process", "{:.2f}"),
    ("cpu_s", "CPU s", "{:.2f}"),
    ("memory_bytes", "MB", "{:.0f}"),
    ("relative_mse", "rel. MSE", "{:.2e}"),
    ("trace_ratio", "trace/ours", "{:.2f}"),
    ("process_ratio", "process/ours", "{:.2f}"),
    ("cpu_ratio", "CPU/ours", "{:.2f}"),
    ("trace_mse_ratio", "trace x MSE/ours", "{:.2f}"),
    ("process_mse_ratio", "process x MSE/ours", "{:.2f}"),
    ("mean_difference", "mean differs", "{:.1%}"),
    ("shape_difference", "shape differs", "{:.1%}"),
)
"""(key of a row, heading, format)."""


def table(report: dict[str, Any]) -> str:
    """Lines of equal columns under one about the machine, and a line for each comparison that is void."""
    rows = [[heading for _, heading, _ in COLUMNS], *(cells(row) for row in report["rows"])]
    widths = [max(len(row[i]) for row in rows) for i in range(len(COLUMNS))]
    lines = ["  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True)) for row in rows]
    return "\n".join([machine_line(report["machine"]), *lines, *voids(report["rows"])])


def cells(row: dict[str, Any]) -> list[str]:
    """A row's figures as text; `-` for what was not measured."""
    values = {**row, "memory_bytes": row["memory_bytes"] / MEGABYTE}
    return ["-" if values[key] is None else form.format(values[key]) for key, _, form in COLUMNS]


def voids(rows: Sequence[dict[str, Any]]) -> list[str]:
    """What cannot be compared, and why."""
    return [
        f"void: {row['scene']}, {row['look']}, {row['side']}: the converged pictures differ, by"
        f" {row['mean_difference']:.1%} in the mean and {row['shape_difference']:.1%} in squares; no ratio says anything"
        for row in rows
        if row["comparable"] is False and row["threads"] == rows[0]["threads"]
    ]


def machine_line(machine: dict[str, Any]) -> str:
    """What the figures depend on, in a line."""
    width, height = machine["resolution"]
    return (
        f"{', '.join(f'{name}: {software}' for name, software in machine['sides'].items())}; {machine['processor']},"
        f" {machine['cores']} cores, {machine['instruction_set']}; {width} x {height}, {machine['spp']} samples,"
        f" {machine['max_bounces']} bounces; converged at {machine['reference_spp']} samples; seed {machine['seed']},"
        f" median of {machine['repetitions']}"
    )
