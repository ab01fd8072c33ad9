"""The report's plots as SVG: the front, a knob, and the stages of a frame. Each is an empty text where nothing can be
drawn, and takes any figure: what is missing is left out, zeros stand below the logarithmic axis under a tick of their own."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from matplotlib.artist import Artist
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from .canvas import INK, MARKERS, MUTED, NARROW, PAPER, SERIES, SERIES_TEXT, Canvas, Size, style
from .figures import figure, median, number, options_text, seconds
from .labels import Label, Place, add_labels
from .log_scale import LogScale

Point = Mapping[str, Any]
"""A value of `points`."""
ERROR_LABELS = {
    "motion_px": "motion error, pixels",
    "shape_px": "shape error, pixels",
    "noise_relative_mse": "noise, relative MSE",
    "bias_relative_mse": "bias, relative MSE",
    "relative_mse": "picture error, relative MSE",
    "light_flip": "light that is left out, FLIP",
    "shape_flip": "shape alone, FLIP",
}
TRADED = {
    "motion": ("motion_px", "relative_mse"),
    "shape": ("shape_px", "shape_flip", "relative_mse"),
    "noise": ("noise_relative_mse", "relative_mse"),
    "light": ("light_flip", "bias_relative_mse", "relative_mse"),
}
"""Figures of a point that show what an axis trades, the best first: the first that any point has is drawn."""
STAGES = ("read", "sample", "build", "trace", "write")


@dataclass(frozen=True)
class Dot:
    """A point of the plane: seconds against an error."""

    x: float
    y: float
    point: Point
    value: str = ""


def frame_seconds(point: Point) -> float | None:
    """The median of a frame; None where it was not measured."""
    return median((point.get("seconds") or {}).get("frame"))


def front_plot(
    points: Mapping[str, Point], front: Sequence[str], named: Sequence[Mapping[str, Any]], size: Size
) -> str:
    """Seconds against the whole error of the picture: every point, the front, and the named settings."""
    xs, ys = _scales(list(points.values()), "relative_mse")
    if xs is None or ys is None:
        return ""
    dots = {key: dot for key, point in points.items() if (dot := _dot(point, "relative_mse", xs, ys))}
    on_front = sorted((dots[key] for key in front if key in dots), key=lambda dot: dot.x)
    marked = [(str(each.get("name", "")), dots[each["id"]]) for each in named if each.get("id") in dots]
    with style(size):
        canvas = _plane(size, xs, ys, ERROR_LABELS["relative_mse"])
        axes = canvas.axes
        for dot in dots.values():
            gid = canvas.title_of(_says(dot.point, "relative_mse"))
            axes.plot(dot.x, dot.y, "o", color=MUTED, markersize=5.0, alpha=0.55, markeredgewidth=0.0, gid=gid)
        if on_front:
            line = [dot.x for dot in on_front], [dot.y for dot in on_front]
            axes.plot(*line, color=SERIES[0], linewidth=2.0, drawstyle="steps-post", zorder=3)
        for dot in on_front:
            gid = canvas.title_of(_says(dot.point, "relative_mse"))
            axes.plot(dot.x, dot.y, "o", color=SERIES[0], markersize=6.0, markeredgewidth=0.0, zorder=4, gid=gid)
        for name, dot in marked:
            gid = canvas.title_of(f"{name}: {_says(dot.point, 'relative_mse')}")
            look: dict[str, Any] = {"markersize": 9.0, "markeredgecolor": PAPER, "markeredgewidth": 1.2}
            axes.plot(dot.x, dot.y, "D", color=SERIES[1], zorder=5, gid=gid, **look)
        add_labels(canvas, [Label(dot.x, dot.y, name) for name, dot in marked], [_steps(on_front)])
        return canvas.svg(f"front-{size.name}")


def _steps(dots: Sequence[Dot]) -> list[Place]:
    """The corners of the front's line: what a time buys, it buys until the next point."""
    corners = [(after.x, before.y) for before, after in itertools.pairwise(dots)]
    found = [(dot.x, dot.y) for dot in dots]
    return [place for pair in zip(found, [*corners, *found[-1:]], strict=True) for place in pair]


def error_of(axis: Mapping[str, Any], points: Sequence[Point]) -> str:
    """The figure that an axis's plot shows upwards; empty for an axis that trades no error."""
    keys = TRADED.get(str(axis.get("error")), ())
    return next((key for key in keys if any(number(point.get(key)) is not None for point in points)), "")


def axis_plot(axis: Mapping[str, Any], points: Mapping[str, Point], size: Size, prefix: str) -> str:
    """Seconds, with their spread, against the error that the axis trades; a line a series, labelled with the values.
    `prefix` makes ids unique in a page."""
    series = _series_of(axis, points)
    every = [point for one in series for _, point in one.steps]
    key = error_of(axis, every)
    if not key:
        return _times_plot(series, size, prefix)
    xs, ys = _scales(every, key)
    if xs is None or ys is None:
        return ""
    with style(size):
        canvas = _plane(size, xs, ys, ERROR_LABELS[key], series)
        labels: list[Label] = []
        lines: list[Sequence[Place]] = []
        for one in series:
            dots = [dot for value, point in one.steps if (dot := _dot(point, key, xs, ys, value))]
            lines += [[(dot.x, dot.y) for dot in dots], *(_draw_dot(canvas, one, dot, xs, key) for dot in dots)]
            canvas.axes.plot([dot.x for dot in dots], [dot.y for dot in dots], color=one.color, linewidth=1.6)
            labels += [Label(dot.x, dot.y, dot.value, one.text_color if len(series) > 1 else INK) for dot in dots]
        add_labels(canvas, labels, lines)
        return canvas.svg(prefix)


@dataclass(frozen=True)
class Series:
    """The points of a line, and its look."""

    name: str
    steps: Sequence[tuple[str, Point]]
    """The knob's value, and what was measured with it."""
    index: int

    @property
    def color(self) -> str:
        return SERIES[self.index % len(SERIES)]

    @property
    def text_color(self) -> str:
        return SERIES_TEXT[self.index % len(SERIES)]

    @property
    def marker(self) -> str:
        return MARKERS[self.index % len(MARKERS)]


def _series_of(axis: Mapping[str, Any], points: Mapping[str, Point]) -> list[Series]:
    return [
        Series(
            str(each.get("name") or ""),
            [(str(step.get("value", "")), points.get(step.get("id"), {})) for step in each.get("points") or ()],
            index,
        )
        for index, each in enumerate(axis.get("series") or ())
    ]


def _draw_dot(canvas: Canvas, series: Series, dot: Dot, xs: LogScale, key: str) -> list[Place]:
    """A marker, and a bar from the lowest time to the highest, whose ends are returned."""
    low, high = _range(dot.point, xs, dot.x)
    bar: dict[str, Any] = {"color": series.color, "linewidth": 1.2, "marker": "|", "markersize": 6.0, "zorder": 3}
    canvas.axes.plot([low, high], [dot.y, dot.y], **bar)
    look: dict[str, Any] = {
        "color": series.color,
        "markersize": 7.0,
        "markeredgecolor": PAPER,
        "markeredgewidth": 0.8,
        "zorder": 4,
    }
    gid = canvas.title_of(f"{dot.value}: {_says(dot.point, key)}")
    canvas.axes.plot(dot.x, dot.y, series.marker, gid=gid, **look)
    return [(low, dot.y), (high, dot.y)]


def _range(point: Point, xs: LogScale, middle: float) -> tuple[float, float]:
    """Lowest and highest time of a frame, as places on the axis."""
    ends = [xs.place(value) for value in _times(point)[1:3]]
    low, high = ends if len(ends) == 2 else (None, None)
    return min(low or middle, middle), max(high or middle, middle)


def _times_plot(series: Sequence[Series], size: Size, prefix: str) -> str:
    """For an axis that trades no error: a row a value."""
    values = list(dict.fromkeys(value for one in series for value, _ in one.steps))
    measured = [point for one in series for _, point in one.steps if frame_seconds(point) is not None]
    xs = LogScale.of(time for point in measured for time in _times(point))
    if xs is None:
        return ""
    step = 20.0 + 14.0 * len(series)
    top = 8.0 + _legend_height(size, series)
    size = replace(size, height=46.0 + top + step * len(values))
    with style(size):
        canvas = Canvas(size, 14.0 + _widest(size, map(_short, values)), 46.0, top)
        _label_x(canvas, xs)
        canvas.axes.set_yticks(range(len(values)), [_short(value) for value in values])
        canvas.axes.set_ylim(len(values) - 0.5, -0.5)
        for one in series:
            shift = (one.index + 0.5) / len(series) - 0.5
            for value, point in one.steps:
                if (x := xs.place(frame_seconds(point))) is not None:
                    dot = Dot(x, values.index(value) + 0.6 * shift, point, value)
                    _draw_dot(canvas, one, dot, xs, "")
        _add_legend(canvas, series)
        return canvas.svg(prefix)


def stages_plot(named: Sequence[Mapping[str, Any]], points: Mapping[str, Point], size: Size) -> str:
    """A bar a named setting: seconds by the stages of a frame, one after the other."""
    every = [(str(each.get("name", "")), _stages(points.get(str(each.get("id")), {}))) for each in named]
    rows = [(name, stages) for name, stages in every if any(stages)]
    if not rows:
        return ""
    size = replace(size, height=84.0 + 50.0 * len(rows))
    longest = max(sum(stages) for _, stages in rows)
    with style(size):
        canvas = Canvas(size, 2.0, 46.0, top=30.0, right=58.0)
        axes = canvas.axes
        axes.set(xlabel="seconds", xlim=(0.0, longest * 1.01), ylim=(len(rows) - 0.4, -0.75), yticks=[])
        axes.grid(axis="y", visible=False)
        axes.locator_params(axis="x", nbins=5)
        for i, _ in enumerate(STAGES):
            starts = [sum(stages[:i]) for _, stages in rows]
            widths = [stages[i] for _, stages in rows]
            axes.barh(range(len(rows)), widths, 0.42, starts, color=SERIES[i], edgecolor=PAPER, linewidth=0.8)
        for row, (name, stages) in enumerate(rows):
            axes.annotate(name, (0.0, row - 0.27), (1, 0), textcoords="offset points", va="bottom", gid=canvas.label())
            total = sum(stages)
            axes.annotate(f"{seconds(total)} s", (total, row), (5, 0), textcoords="offset points", va="center")
        handles = [Patch(color=SERIES[i], label=stage) for i, stage in enumerate(STAGES)]
        _place_legend(canvas, handles, len(STAGES))
        return canvas.svg(f"stages-{size.name}")


def _stages(point: Point) -> list[float]:
    """Seconds of each stage; 0 where it is not known."""
    found = point.get("seconds") or {}
    return [max(0.0, median(found.get(stage)) or 0.0) for stage in STAGES]


def _times(point: Point) -> list[Any]:
    """Median, lowest and highest seconds of a frame, as far as they are known."""
    found = (point.get("seconds") or {}).get("frame")
    return list(found[:3]) if isinstance(found, (list, tuple)) else []


def _scales(points: Sequence[Point], key: str) -> tuple[LogScale | None, LogScale | None]:
    """Of times and of an error, over the points that have both."""
    both = [point for point in points if frame_seconds(point) is not None and number(point.get(key)) is not None]
    return LogScale.of(time for point in both for time in _times(point)), LogScale.of(point[key] for point in both)


def _dot(point: Point, key: str, xs: LogScale, ys: LogScale, value: str = "") -> Dot | None:
    x, y = xs.place(frame_seconds(point)), ys.place(point.get(key))
    return None if x is None or y is None else Dot(x, y, point, value)


def _says(point: Point, key: str) -> str:
    """What a pointer over a point tells."""
    error = f", {ERROR_LABELS[key]} {figure(point.get(key))}" if key else ""
    return f"{options_text(point.get('options'))}: {seconds(frame_seconds(point))} s{error}"


def _plane(size: Size, xs: LogScale, ys: LogScale, y_label: str, series: Sequence[Series] = ()) -> Canvas:
    """Axes of seconds and an error, both logarithmic; the error's name stands above its axis, the legend above that."""
    canvas = Canvas(size, 14.0 + _widest(size, ys.labels(8)), 46.0, top=30.0 + _legend_height(size, series))
    _label_x(canvas, xs)
    ys.apply(canvas.axes, "y", 8)
    canvas.axes.annotate(y_label, (2.0, canvas.axes.bbox.y1 + 10.0), xycoords="figure pixels", color=INK)
    _add_legend(canvas, series)
    return canvas


def _label_x(canvas: Canvas, xs: LogScale) -> None:
    xs.apply(canvas.axes, "x", 5 if canvas.size.width <= NARROW.width else 9)
    canvas.axes.set_xlabel("seconds a frame")


def _widest(size: Size, texts: Iterable[str]) -> float:
    """Pixels of the longest text, about."""
    return 0.62 * size.text * max(map(len, texts), default=0)


def _short(text: str) -> str:
    return text if len(text) <= 18 else f"{text[:17]}…"


def _legend_columns(size: Size, series: Sequence[Series]) -> int:
    """Entries that stand side by side."""
    width = _widest(size, (_short(one.name) for one in series)) + 3.5 * size.text
    return max(1, min(len(series), int(size.width / width)))


def _legend_height(size: Size, series: Sequence[Series]) -> float:
    """Pixels above a plot; none for one series, whose name the heading says."""
    if len(series) < 2:
        return 0.0
    return 6.0 + 1.6 * size.text * math.ceil(len(series) / _legend_columns(size, series))


def _add_legend(canvas: Canvas, series: Sequence[Series]) -> None:
    if len(series) < 2:
        return
    handles = [
        Line2D([], [], color=one.color, marker=one.marker, markeredgecolor=PAPER, label=_short(one.name) or " ")
        for one in series
    ]
    _place_legend(canvas, handles, _legend_columns(canvas.size, series))


def _place_legend(canvas: Canvas, handles: Sequence[Artist], columns: int) -> None:
    """In the drawing's upper left corner."""
    figure = canvas.axes.figure
    look: dict[str, Any] = {"frameon": False, "borderaxespad": 0.0, "borderpad": 0.1, "handlelength": 1.3}
    look |= {"columnspacing": 1.2, "handletextpad": 0.5, "bbox_transform": figure.transFigure}
    canvas.axes.legend(handles=handles, ncols=columns, loc="upper left", bbox_to_anchor=(0.0, 1.0), **look)
