"""The stability bench's report for people."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from .stability import per_million

FIGURES: Sequence[tuple[str, str, str]] = (
    ("leaks", "leaks/M", "rays"),
    ("peer_leaks", "peer", "rays"),
    ("wrong", "wrong/M", "judged"),
    ("peer_wrong", "peer", "judged"),
)
"""(key of a row, heading, the rays that it is a share of)."""


def table(report: dict[str, Any]) -> str:
    """A line a row, under a line about the machine, and a last one that sums up."""
    machine, rows = report["machine"], report["rows"]
    names = ("shape", "motion", "keys", "degree", "position", "scale", "rays")
    lines = [[*names, *(heading for _, heading, _ in FIGURES)]]
    lines += [[*(_text(row[name]) for name in names), *_figures([row])] for row in rows]
    total = sum(row["rays"] for row in rows)
    lines.append([f"all {len(rows)}", "", "", "", "", "", str(total), *_figures(rows)])
    widths = [max(len(line[i]) for line in lines) for i in range(len(lines[0]))]
    against = f" against {machine['peer']}" if machine["peer"] else ""
    head = (
        f"msbvh {machine['msbvh']}{against}; {machine['processor']}, {machine['instruction_set']}; seed {machine['seed']};"
        " rays of a million that get out of a closed shape or through a tube or sphere, and that differ from double"
        " precision beyond the bound"
    )
    return "\n".join([head, *("  ".join(map(str.rjust, line, widths)) for line in lines)])


def _figures(rows: Sequence[dict[str, Any]]) -> list[str]:
    shares = [per_million(rows, figure, of) for figure, _, of in FIGURES]
    return ["-" if share is None else f"{share:.0f}" for share in shares]


def _text(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)
