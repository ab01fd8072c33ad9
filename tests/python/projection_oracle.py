"""Coverage of a blurred frame by projecting triangles at many times: slow, plain, and no ray in it.

Conventions are the renderer's: the top row first, a box filter over the pixel, time uniform over the open
shutter, the clipping range along the camera's axis. An image of another shape than the camera's aperture
keeps the horizontal aperture (the conform policy adjustApertureHeight).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pxr import Gf, Usd, UsdGeom
from stage_truth import Polygons, StageTruth

GOLDEN = (0.7548776662466927, 0.5698402909980532)
"""R2, the plastic number's low-discrepancy sequence (Roberts 2018): shifts the sub-pixels at each time."""


@dataclass(frozen=True)
class Sampling:
    """How densely time and pixels are sampled; the oracle's error falls with their product."""

    times: int = 256
    subpixels: int = 4
    """Along each side of a pixel."""
    subdivisions: int = 0
    """Steps by which subdivided cages are refined; 0: they are drawn as polygons."""
    round: bool = False
    """Whether curves and points are drawn."""


def coverage(
    stage: Usd.Stage,
    frame: float,
    camera: str,
    size: tuple[int, int],
    sampling: Sampling = Sampling(),
    purposes: tuple[str, ...] = ("proxy",),
) -> np.ndarray:
    """The share of time and pixel that anything covers: float64[height, width] in [0, 1].

    `size` is width and height. A shutter that is closed or reversed shows the frame alone.
    """
    opening, closing = shutter_of(stage, frame, camera)
    truth = StageTruth(stage, frame, (opening, closing), purposes, sampling.subdivisions)
    total = np.zeros((size[1], size[0]))

    def eye_of(time: float) -> np.ndarray | None:
        return np.array(truth.camera(camera, time).transform)[3, :3] if sampling.round else None

    # A closed shutter needs the times for its sub-pixels alone.
    polygons = truth.polygons(frame, eye_of(frame)) if opening == closing else None
    for i in range(sampling.times):
        time = frame + opening + (i + 0.5) / sampling.times * (closing - opening)
        shift = np.modf(0.5 + (i + 1) * np.array(GOLDEN))[0]
        view = _View(truth.camera(camera, time), size, sampling.subpixels, shift)
        seen = truth.polygons(time, eye_of(time)) if polygons is None else polygons
        total += view.covered(triangles(seen))
    return total / sampling.times


def shutter_of(stage: Usd.Stage, frame: float, camera: str) -> tuple[float, float]:
    """Opening and closing relative to the frame; (0, 0) where the shutter is closed or reversed."""
    prim = UsdGeom.Camera.Get(stage, camera)
    opening, closing = (a.Get(frame) for a in (prim.GetShutterOpenAttr(), prim.GetShutterCloseAttr()))
    return (opening, closing) if closing > opening else (0.0, 0.0)


def triangles(polygons: Sequence[Polygons]) -> np.ndarray:
    """Fans of all polygons in the world: float64[N, 3, 3]."""
    parts = [np.zeros((0, 3, 3))]
    for drawn in polygons:
        corners = fan(drawn.counts, drawn.indices)
        parts.append(drawn.world_points()[:, corners].reshape(-1, 3, 3))
    return np.concatenate(parts)


def fan(counts: np.ndarray, indices: np.ndarray) -> np.ndarray:
    """Triangles of polygons around the first vertex of each: int[T, 3] of point indices."""
    counts = np.asarray(counts, int)
    each = np.maximum(counts - 2, 0)
    first = np.repeat(np.cumsum(counts) - counts, each)
    number = np.arange(each.sum()) - np.repeat(np.cumsum(each) - each, each)
    return np.asarray(indices, int)[np.stack([first, first + number + 1, first + number + 2], axis=-1)]


class _View:
    """What one camera sees at one time, sampled once in every sub-pixel."""

    def __init__(self, camera: Gf.Camera, size: tuple[int, int], subpixels: int, shift: np.ndarray) -> None:
        """`shift` in [0, 1): where in its sub-pixel each sample stands, right and down."""
        self._camera, self._subpixels, self._shift = camera, subpixels, shift
        self._columns, self._rows = size[0] * subpixels, size[1] * subpixels

    def covered(self, world: np.ndarray) -> np.ndarray:
        """float64[height, width] from triangles float64[N, 3, 3]."""
        columns, rows, sub = self._columns, self._rows, self._subpixels
        row, begin, end = self._spans(self._projected(world))
        begin, end = (np.clip(np.ceil(x - self._shift[0]), 0, columns).astype(int) for x in (begin, end))
        # A span opens at its first sample and closes after its last; overlaps nest.
        edges = np.bincount(row * (columns + 1) + begin, minlength=rows * (columns + 1))
        edges -= np.bincount(row * (columns + 1) + end, minlength=rows * (columns + 1))
        inside = np.cumsum(edges.reshape(rows, columns + 1)[:, :-1], axis=1) > 0
        return inside.reshape(rows // sub, sub, columns // sub, sub).mean(axis=(1, 3))

    def _projected(self, world: np.ndarray) -> np.ndarray:
        """Triangles within the clipping range in sub-pixels, right and down: float64[M, 3, 2]."""
        # In double, and about the eye: a world far from its origin loses nothing.
        matrix = np.array(self._camera.transform)
        seen = (world - matrix[3, :3]) @ np.linalg.inv(matrix[:3, :3])
        clipping = self._camera.clippingRange
        seen = clipped(seen, -seen[..., 2] - clipping.min)
        seen = clipped(seen, seen[..., 2] + clipping.max)
        flat = seen[..., :2]
        if self._camera.projection == Gf.Camera.Perspective:
            flat = flat / -seen[..., 2:]
        window = self._camera.frustum.GetWindow()
        centre, width = np.array(window.GetMidpoint()), window.GetSize()[0]
        per_unit = self._columns / width
        return (flat - centre) * (per_unit, -per_unit) + (self._columns / 2, self._rows / 2)

    def _spans(self, flat: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Where rows of samples cross triangles: row int[S], from and to in sub-pixels float64[S] each."""
        low, high = flat[..., 1].min(axis=1, initial=np.inf), flat[..., 1].max(axis=1, initial=-np.inf)
        first = np.clip(np.ceil(low - self._shift[1]), 0, self._rows).astype(int)
        last = np.clip(np.ceil(high - self._shift[1]), 0, self._rows).astype(int)
        counts = last - first
        triangle = np.repeat(np.arange(len(flat)), counts)
        row = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts) + first[triangle]
        y = row + self._shift[1]
        begin, end = np.full(len(row), np.inf), np.full(len(row), -np.inf)
        for a, b in ((0, 1), (1, 2), (2, 0)):
            x = _crossing(flat[triangle, a], flat[triangle, b], y)
            begin, end = np.fmin(begin, x), np.fmax(end, x)
        return row, begin, np.maximum(begin, end)


def _crossing(a: np.ndarray, b: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Where edges a-b float64[S, 2] meet the lines y; nan where they do not.

    Both triangles at an edge compute the same, so that no gap opens between them.
    """
    swapped = (a[:, 1] > b[:, 1]) | ((a[:, 1] == b[:, 1]) & (a[:, 0] > b[:, 0]))
    low, high = np.where(swapped[:, None], b, a), np.where(swapped[:, None], a, b)
    meets = (low[:, 1] <= y) & (y < high[:, 1])
    with np.errstate(divide="ignore", invalid="ignore"):
        x = low[:, 0] + (high[:, 0] - low[:, 0]) * ((y - low[:, 1]) / (high[:, 1] - low[:, 1]))
    return np.where(meets, x, np.nan)


def clipped(corners: np.ndarray, inside: np.ndarray) -> np.ndarray:
    """The parts of triangles float64[N, 3, 3] where the linear function `inside` float64[N, 3] is above 0."""
    positive = inside > 0
    number = positive.sum(axis=1)
    parts = [corners[number == 3]]
    for count in (1, 2):
        chosen = number == count
        c, d, p = corners[chosen], inside[chosen], positive[chosen]
        # Turn the odd one out to the front.
        alone = np.argmax(p, axis=1) if count == 1 else np.argmin(p, axis=1)
        order = (alone[:, None] + np.arange(3)) % 3
        c, d = np.take_along_axis(c, order[..., None], axis=1), np.take_along_axis(d, order, axis=1)
        ab = c[:, 0] + (c[:, 1] - c[:, 0]) * (d[:, 0] / (d[:, 0] - d[:, 1]))[:, None]
        ac = c[:, 0] + (c[:, 2] - c[:, 0]) * (d[:, 0] / (d[:, 0] - d[:, 2]))[:, None]
        if count == 1:
            parts.append(np.stack([c[:, 0], ab, ac], axis=1))
        else:
            parts.extend([np.stack([ab, c[:, 1], c[:, 2]], axis=1), np.stack([ab, c[:, 2], ac], axis=1)])
    return np.concatenate(parts)
