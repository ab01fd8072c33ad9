"""The report's figures as CSV, for spreadsheets and scripts."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from ..base.atomic import write_whole
from ..output.stats import PHASES

POINT_COLUMNS = (
    "motion_px", "shape_px", "rmse", "relative_mse", "bias_relative_mse", "noise_relative_mse", "flip", "bias_flip",
    "peak_bytes", "tree_bytes", "motion_bytes", "triangles", "rays", "nodes_per_ray", "tests_per_ray", "runs",
    "failed", "command",
)  # fmt: skip


def write_tables(data: dict[str, Any], out: Path) -> None:
    """points.csv, a row a position of a knob, and prims.csv. Raises OutputError."""
    write_whole(out / "points.csv", _csv(_point_rows(data)))
    write_whole(out / "prims.csv", _csv(_prim_rows(data)))


def _point_rows(data: dict[str, Any]) -> Iterator[dict[str, Any]]:
    for axis in data["axes"]:
        for series in axis["series"]:
            for step in series["points"]:
                place = {"axis": axis["option"], "series": series["name"], "value": step["value"]}
                yield place | _point(data["points"][step["id"]])
    for group in ("named", "targets"):
        for entry in data[group]:
            if entry.get("id"):
                what = entry.get("name") or entry.get("asked")
                yield {"axis": group, "series": "", "value": what} | _point(data["points"][entry["id"]])
    for name in data["front"]:
        yield {"axis": "front", "series": "", "value": ""} | _point(data["points"][name])


def _point(point: dict[str, Any]) -> dict[str, Any]:
    row: dict[str, Any] = {}
    for phase in (*PHASES, "frame"):
        times = point.get("seconds", {}).get(phase) or [None] * 3
        row |= {f"{phase}_s": times[0], f"{phase}_low_s": times[1], f"{phase}_high_s": times[2]}
    for name in POINT_COLUMNS:
        row[name] = point.get(name)
    for kind in ("motion", "shape", "light"):
        found = point.get("kinds", {}).get(kind) or {}
        row |= {f"{kind}_{measure}": found.get(measure) for measure in ("rmse", "relative_mse", "flip")}
    return row


def _prim_rows(data: dict[str, Any]) -> Iterator[dict[str, Any]]:
    for prim in data["prims"]:
        row = {name: value for name, value in prim.items() if name not in ("cheaper", "finer")}
        for way in ("cheaper", "finer"):
            other = prim[way] or {}
            row |= {f"{way}_{name}": other.get(name) for name in ("track", "error_px", "bytes", "frame_share")}
        yield row


def _csv(rows: Iterator[dict[str, Any]]) -> bytes:
    text = io.StringIO()
    found = list(rows)
    if found:
        writer = csv.DictWriter(text, list(found[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(found)
    return text.getvalue().encode()
