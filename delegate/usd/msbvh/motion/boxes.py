"""Boxes around things, and how large a pixel is at them."""

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


@dataclass(frozen=True)
class PixelSize:
    """How large a pixel is in the world, seen from a camera that may move."""

    camera_box: Box
    """Around the eye over the shutter."""
    perspective: bool
    per_unit: float
    """World units a pixel: at unit distance (perspective) or anywhere."""
    near: float
    """No distance counts as less: what lies nearer is not seen."""

    def __call__(self, corners: np.ndarray) -> np.ndarray:
        """As nearest()."""
        return self.nearest(corners)

    def at_spheres(self, centres: np.ndarray, outer: np.ndarray, inner: np.ndarray) -> np.ndarray:
        """The smallest size of a pixel at surfaces, seen from outside or inside, that lie between spheres of
        float64[T, N] radii at float64[T, N, 3] centres: float64[N]."""
        if not self.perspective:
            return np.full(centres.shape[1], self.per_unit)
        to_nearest = np.maximum(np.maximum(centres - self.camera_box.hi, self.camera_box.lo - centres), 0.0)
        to_farthest = np.maximum(np.abs(centres - self.camera_box.lo), np.abs(centres - self.camera_box.hi))
        outside = np.linalg.norm(to_nearest, axis=-1) - outer
        inside = inner - np.linalg.norm(to_farthest, axis=-1)
        return self.per_unit * np.maximum(np.maximum(outside, inside), self.near).min(axis=0)

    def nearest(self, corners: np.ndarray) -> np.ndarray:
        """The smallest size of a pixel at the boxes around float64[T, N, 8, 3] world points: float64[N]."""
        if not self.perspective:
            return np.full(corners.shape[1], self.per_unit)
        lo, hi = corners.min(axis=(0, 2)), corners.max(axis=(0, 2))
        gap = np.maximum(np.maximum(lo - self.camera_box.hi, self.camera_box.lo - hi), 0.0)
        return self.per_unit * np.maximum(np.linalg.norm(gap, axis=-1), self.near)


@dataclass(frozen=True)
class UniformPixelSize:
    """A pixel that is as large everywhere."""

    size: float

    def __call__(self, corners: np.ndarray) -> np.ndarray:
        """At float64[T, N, 8, 3] corners: float64[N]."""
        return np.full(corners.shape[1], self.size)

    def at_spheres(self, centres: np.ndarray, outer: np.ndarray, inner: np.ndarray) -> np.ndarray:
        """As PixelSize has it."""
        return np.full(centres.shape[1], self.size)


Pixels = PixelSize | UniformPixelSize
"""The size of a pixel wherever something is."""
