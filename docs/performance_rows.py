"""Rows of a report of `msbvh bench --json`, as the page and its plot group them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

Row = dict[str, Any]
KINDS = ("primary", "shadow", "random")
"""Of rays."""


def group(rows: Iterable[Row]) -> dict[tuple[Any, ...], dict[str, Row]]:
    """(scene, triangles, keys, degree) -> kind of ray -> row."""
    found: dict[tuple[Any, ...], dict[str, Row]] = {}
    for row in rows:
        found.setdefault((row["scene"], row["triangles"], row["keys"], row["degree"]), {})[row["rays"]] = row
    return found


def one(found: dict[str, Row]) -> Row:
    return next(iter(found.values()))
