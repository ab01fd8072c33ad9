"""Shutter curves: by name, or from a file of times and weights."""

from __future__ import annotations

import itertools
import json
import math
from pathlib import Path
from typing import Any

from .._core import SHUTTER_CURVES

Curve = tuple[tuple[float, float], ...]
"""(time01, weight) of each knot, linear between them; two knots of one time are a step. None: open throughout."""

EXPECTED = (
    "expected a time from 0 to 1 and a weight from 0 on in each row, times that do not decrease, and some area below"
)


class CurveError(Exception):
    """A curve that makes no sense; str() is one line that says why."""


def shutter_curve(text: str) -> Curve:
    """Of one of SHUTTER_CURVES, or of a file's path. Raises CurveError."""
    if text in SHUTTER_CURVES:
        return SHUTTER_CURVES[text]
    path = Path(text)
    try:
        content = path.read_text("utf-8")
    except OSError as error:
        known = ", ".join(SHUTTER_CURVES)
        raise CurveError(f"found '{text}', expected {known} or a file; {error.strerror}") from None
    except UnicodeDecodeError:
        raise CurveError(f"'{text}': found no text, {EXPECTED}") from None
    return checked(tuple(_rows(content, text)), text)


def checked(curve: Curve, name: str) -> Curve:
    """Raises CurveError for what is no curve."""
    for i, (time, weight) in enumerate(curve):
        if not (0.0 <= time <= 1.0 and 0.0 <= weight < math.inf) or (i > 0 and time < curve[i - 1][0]):
            raise CurveError(f"'{name}': found {time:g} {weight:g} in row {i + 1}, {EXPECTED}")
    if len(curve) < 2 or area(curve) <= 0.0:
        raise CurveError(f"'{name}': found {len(curve)} rows with no area below them, {EXPECTED}")
    return curve


def area(curve: Curve, begin: float = 0.0, end: float = 1.0) -> float:
    """The integral of the weights between two times; of no knots, the time between them."""
    if not curve:
        return max(0.0, min(end, 1.0) - max(begin, 0.0))
    total = 0.0
    for (t0, w0), (t1, w1) in itertools.pairwise(curve):
        a, b = min(max(begin, t0), t1), min(max(end, t0), t1)
        if b > a:
            middle = ((a + b) / 2 - t0) / (t1 - t0)
            total += (b - a) * (w0 + (w1 - w0) * middle)
    return total


def _rows(content: str, name: str) -> list[tuple[float, float]]:
    """As JSON, [[time01, weight], ...], or as two columns; # begins a comment."""
    if content.lstrip().startswith("["):
        try:
            rows = json.loads(content)
        except ValueError as error:
            raise CurveError(f"'{name}': found what is no JSON ({error}), {EXPECTED}") from None
    else:
        lines = (line.split("#")[0].replace(",", " ").split() for line in content.splitlines())
        rows = [line for line in lines if line]
    return [_row(row, i, name) for i, row in enumerate(rows)]


def _row(row: Any, index: int, name: str) -> tuple[float, float]:
    fault = CurveError(f"'{name}': found {str(row)[:40]} in row {index + 1}, {EXPECTED}")
    if not isinstance(row, list) or len(row) != 2 or any(isinstance(x, bool) for x in row):
        raise fault
    try:
        return float(row[0]), float(row[1])
    except (TypeError, ValueError):
        raise fault from None
