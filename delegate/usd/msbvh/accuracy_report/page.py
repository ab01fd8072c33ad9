"""The page of a report: report.html.j2, filled with the data, the plots and the pictures."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from jinja2 import ChainableUndefined, Environment, FileSystemLoader

from . import figures
from .canvas import NARROW, WIDE, Size
from .figures import number
from .log_scale import drawable
from .pictures import pictures
from .plots import axis_plot, error_of, frame_seconds, front_plot, stages_plot

HERE = Path(__file__).parent
MOST_PRIMS = 500
"""Rows of a table that a reader can use and a browser sorts at once."""
TRADES = {
    "motion": "motion error",
    "shape": "shape error",
    "noise": "noise",
    "light": "light that is left out",
}
"""The errors that axes trade for time; others trade none."""


def page(data: Mapping[str, Any], folder: Path) -> str:
    """The whole text of report.html."""
    points = {str(key): point or {} for key, point in (data.get("points") or {}).items()}
    front = [str(key) for key in data.get("front") or ()]
    named = data.get("named") or ()
    comparable = {key: points[key] for key in data.get("comparable") or points if key in points}
    prims = _most_wrong(data.get("prims") or ())
    found = pictures(data, folder)
    missing = [f"{path}: no PNG file was found there" for path in found.missing]
    return (
        _environment()
        .get_template("report.html.j2")
        .render(
            data=data,
            points=points,
            axes=[_axis(i, axis, points) for i, axis in enumerate(data.get("axes") or ())],
            front=front,
            named_kinds=_kinds(points.get(each.get("id"), {}) for each in named),
            front_plots=_both(lambda size: front_plot(comparable, front, named, size)),
            stages_plots=_both(lambda size: stages_plot(named, points, size)),
            prims=prims,
            prim_count=len(data.get("prims") or ()),
            choices=found.choices,
            picture_data=[vars(choice) for choice in found.choices],
            warnings=[*(data.get("warnings") or ()), *missing],
            css=_text("report.css"),
            script=_text("report.js"),
        )
    )


def _environment() -> Environment:
    """Whatever the data lacks is an en dash, never an error."""
    loader = FileSystemLoader(HERE)
    environment = Environment(
        loader=loader, autoescape=True, undefined=ChainableUndefined, trim_blocks=True, lstrip_blocks=True
    )
    shown: Sequence[Callable[..., object]] = (
        figures.figure,
        figures.plain,
        figures.seconds,
        figures.megabytes,
        figures.count,
        figures.share,
        figures.change,
        figures.spread,
        figures.median,
        figures.options_text,
        sort_value,
    )
    environment.filters.update({each.__name__: each for each in shown})
    return environment


def sort_value(value: object) -> str:
    """What report.js sorts a cell by; empty: missing, and last in either direction."""
    if isinstance(value, str):
        return value
    found = number(value)
    return "" if found is None else repr(found)


def _text(name: str) -> str:
    return (HERE / name).read_text(encoding="utf-8")


def _both(draw: Callable[[Size], str]) -> list[str]:
    """A plot for a wide page and one for a phone, of which report.css shows one; none where there is nothing to draw."""
    return [text for size in (WIDE, NARROW) if (text := draw(size))]


def _axis(index: int, axis: Mapping[str, Any], points: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    """An axis as the page shows it."""
    anchor = f"axis-{index + 1}"
    steps = [each for series in axis.get("series") or () for each in series.get("points") or ()]
    every = [points.get(each.get("id"), {}) for each in steps]
    error = error_of(axis, every)
    drawn = [point for point in every if drawable(frame_seconds(point)) is not None]
    if error:
        drawn = [point for point in drawn if drawable(point.get(error)) is not None]
    return {
        **axis,
        "anchor": anchor,
        "trades": TRADES.get(str(axis.get("error")), ""),
        "kinds": [kind for kind in _kinds(every) if kind == axis.get("error")],
        "count": len(every),
        "undrawn": len(every) - len(drawn),
        "plots": _both(lambda size: axis_plot(axis, points, size, f"{anchor}-{size.name}")),
    }


def _kinds(points: Iterable[Mapping[str, Any]]) -> list[str]:
    """Of error, that any of the points has by itself."""
    return list(dict.fromkeys(kind for point in points for kind in point.get("kinds") or ()))


def _most_wrong(prims: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """All prims in their order, or the MOST_PRIMS that are furthest off in pixels."""
    if len(prims) <= MOST_PRIMS:
        return list(prims)

    def error(prim: Mapping[str, Any]) -> float:
        moved = 0.0 if prim.get("outside") else number(prim.get("error_px")) or 0.0
        return max(moved, number(prim.get("shape_px")) or 0.0)

    return sorted(prims, key=error, reverse=True)[:MOST_PRIMS]
