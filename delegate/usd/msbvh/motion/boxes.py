"""Boxes around things."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

_CORNERS = np.array(list(product((0, 1), repeat=3)))
"""Which end of a box each of its corners lies at, by axis."""


@dataclass(frozen=True)
class Box:
    """An axis-aligned box; lo > hi where empty."""

    lo: np.ndarray
    hi: np.ndarray

    @staticmethod
    def empty() -> Box:
        """The box of nothing."""
        return Box(np.full(3, np.inf), np.full(3, -np.inf))

    @staticmethod
    def around(points: np.ndarray) -> Box:
        """Of the finite points among float[N, 3]."""
        if not len(points):
            return Box.empty()
        box = Box(points.min(axis=0), points.max(axis=0))
        if np.isfinite(box.lo).all() and np.isfinite(box.hi).all():
            return box
        return Box.around(points[np.isfinite(points).all(axis=1)])

    def union(self, other: Box) -> Box:
        """Around both."""
        return Box(np.minimum(self.lo, other.lo), np.maximum(self.hi, other.hi))

    def grown(self, by: float) -> Box:
        """To all sides."""
        return Box(self.lo - by, self.hi + by)

    def ends(self) -> np.ndarray:
        """float64[2, 3]: lo and hi."""
        return np.array([self.lo, self.hi], np.float64)

    def corners(self) -> np.ndarray:
        """float64[8, 4]: as corners_of has them."""
        return corners_of([self])[0]


def corners_of(boxes: list[Box]) -> np.ndarray:
    """float64[N, 8, 4]: of each box its corners, homogeneous; the origin eight times for an empty box."""
    ends = np.array([(box.lo, box.hi) for box in boxes])
    ends[(ends[:, 0] > ends[:, 1]).any(axis=1)] = 0.0
    corners = np.ones((len(boxes), 8, 4))
    corners[..., :3] = ends[:, _CORNERS, (0, 1, 2)]
    return corners
