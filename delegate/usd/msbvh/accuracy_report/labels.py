"""Places labels beside the points of a plot so that they hide neither each other nor points nor lines."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from matplotlib.transforms import Bbox

from .canvas import INK, MUTED, Canvas

Place: TypeAlias = tuple[float, float]
"""x and y, in data units."""

DISTANCES = (5.0, 12.0, 22.0, 36.0, 54.0)
"""Pixels between a point and its label, in the order of preference."""
DIRECTIONS = tuple(math.radians(degrees) for degrees in (45, 135, 315, 225, 90, 270, 0, 180, 20, 160, 340, 200))
LEADER = 12.0
"""Pixels from which a line leads from the label to its point."""
POINT_RADIUS = 4.0
LINE_RADIUS = 1.5
LINE_STEP = 5.0
"""Pixels between two places of a line that are kept clear."""
LEADER_STYLE = {"arrowstyle": "-", "color": MUTED, "linewidth": 0.7, "shrinkA": 1.0, "shrinkB": POINT_RADIUS}
LONGEST = 30
"""Characters."""


@dataclass(frozen=True)
class Label:
    """Text at a point, in data units."""

    x: float
    y: float
    text: str
    color: str = INK


def add_labels(canvas: Canvas, labels: Sequence[Label], lines: Iterable[Sequence[Place]] = ()) -> None:
    """Greedy, in the order given: each takes the first free place, or the one where it hides least. `lines` are kept
    clear of where that is possible."""
    axes = canvas.axes
    points = [_pixels(canvas, (label.x, label.y)) for label in labels]
    taken = [*(_around(point, POINT_RADIUS) for point in points), *_along(canvas, lines)]
    inside = np.array([axes.bbox.x0 + 2.0, axes.bbox.y0 + 2.0, canvas.size.width - 1.0, canvas.size.height - 1.0])
    for label, point in zip(labels, points, strict=True):
        text = label.text if len(label.text) <= LONGEST else f"{label.text[: LONGEST - 1]}…"
        box, distance = _best_place(point, _measured(canvas, text), np.array(taken), inside)
        taken.append(box)
        leader = {**LEADER_STYLE, "relpos": _nearest_corner(box, point)} if distance >= LEADER else None
        axes.annotate(
            text,
            (label.x, label.y),
            xytext=(box[0] - point[0], box[1] - point[1]),
            textcoords="offset points",
            color=label.color,
            annotation_clip=False,
            arrowprops=leader,
            gid=canvas.label(),
            zorder=6,
        )


def _pixels(canvas: Canvas, place: Place) -> Place:
    x, y = canvas.axes.transData.transform(place)
    return float(x), float(y)


def _around(point: Place, radius: float) -> np.ndarray:
    """A box as left, bottom, right, top."""
    x, y = point
    return np.array([x - radius, y - radius, x + radius, y + radius])


def _along(canvas: Canvas, lines: Iterable[Sequence[Place]]) -> Iterable[np.ndarray]:
    """Boxes that cover lines."""
    for line in lines:
        places = [_pixels(canvas, place) for place in line]
        for (x0, y0), (x1, y1) in itertools.pairwise(places):
            count = math.ceil(math.hypot(x1 - x0, y1 - y0) / LINE_STEP)
            for i in range(count + 1):
                at = i / max(1, count)
                yield _around((x0 + at * (x1 - x0), y0 + at * (y1 - y0)), LINE_RADIUS)


def _measured(canvas: Canvas, text: str) -> tuple[float, float]:
    """Width and height in pixels."""
    probe = canvas.axes.text(0.0, 0.0, text, transform=None)
    box: Bbox = probe.get_window_extent(canvas.measure)
    probe.remove()
    return box.width, box.height


def _best_place(
    point: Place, size: tuple[float, float], taken: np.ndarray, inside: np.ndarray
) -> tuple[np.ndarray, float]:
    """The first place where nothing is hidden, else that where least is; and its distance from the point."""
    candidates = [(_beside(point, size, distance, way), distance) for distance in DISTANCES for way in DIRECTIONS]
    costs = []
    for box, _ in candidates:
        outside = size[0] * size[1] - float(_overlaps(box, inside[None])[0])
        costs.append(float(_overlaps(box, taken).sum()) + 10.0 * outside)
        if costs[-1] < 1e-6:
            break
    return candidates[costs.index(min(costs))]


def _overlaps(box: np.ndarray, others: np.ndarray) -> np.ndarray:
    """The area that a box shares with each other."""
    sides = np.minimum(box[2:], others[:, 2:]) - np.maximum(box[:2], others[:, :2])
    return np.prod(np.maximum(sides, 0.0), axis=1)


def _beside(point: Place, size: tuple[float, float], distance: float, direction: float) -> np.ndarray:
    """A box whose nearest side or corner is at a distance from a point."""
    cosine, sine = math.cos(direction), math.sin(direction)
    reach = distance + POINT_RADIUS
    left = point[0] + reach * cosine - size[0] * (0.5 - 0.5 * _side(cosine))
    bottom = point[1] + reach * sine - size[1] * (0.5 - 0.5 * _side(sine))
    return np.array([left, bottom, left + size[0], bottom + size[1]])


def _side(component: float) -> float:
    return 0.0 if abs(component) < 0.4 else math.copysign(1.0, component)


def _nearest_corner(box: np.ndarray, point: Place) -> Place:
    """Of a box, in its own units, for a line that leads to the point."""
    x, y = np.clip((np.array(point) - box[:2]) / (box[2:] - box[:2]), 0.0, 1.0)
    return float(x), float(y)
