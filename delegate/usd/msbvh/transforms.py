"""Transforms over the shutter, evaluated by USD itself and as densely as linear interpolation needs.

Matrices are float64[4, 4] in USD's row-vector convention: p' = p M, so the inner map stands left in a
product.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np
from pxr import Usd, UsdGeom

from .times import COARSE_LEVEL, FINEST_LEVEL, Shutter, TimeGrid


class Motion:
    """The matrices of `count` things that move together over the shutter."""

    def __init__(
        self, grid: TimeGrid, count: int, still: bool, evaluate: Callable[[float], np.ndarray]
    ) -> None:
        """`evaluate(time01)` gives float64[count, 4, 4]. `still`: it is the same at any time."""
        self.count = count
        self.still = still
        self._grid = grid
        self._evaluate = evaluate
        self._known: dict[float, np.ndarray] = {}

    def at_time(self, time01: float) -> np.ndarray:
        """float64[count, 4, 4]; evaluated once."""
        key = 0.0 if self.still else time01
        if key not in self._known:
            self._known[key] = self._evaluate(key)
        return self._known[key]

    def times01(self, level: int) -> list[float]:
        """The times of a level of the grid; [0] where still."""
        return [0.0] if self.still else self._grid.times01(level)

    def at_level(self, level: int) -> np.ndarray:
        """float64[T, count, 4, 4] for the T times of times01(level)."""
        return np.array([self.at_time(time) for time in self.times01(level)])

    def inside(self, outer: Motion) -> Motion:
        """Each of these under each of `outer`: count = outer.count * self.count, the outer index first."""

        def evaluate(time01: float) -> np.ndarray:
            products = self.at_time(time01)[None, :] @ outer.at_time(time01)[:, None]
            return products.reshape(-1, 4, 4)

        return Motion(self._grid, outer.count * self.count, outer.still and self.still, evaluate)


class XformCaches:
    """One UsdGeom.XformCache a time, shared by all prims: ancestors are evaluated once a time, not once a
    prim."""

    def __init__(self, grid: TimeGrid) -> None:
        self.grid = grid
        self._caches: dict[float, UsdGeom.XformCache] = {}

    def cache(self, time01: float) -> UsdGeom.XformCache:
        """The cache of a time; a closed shutter has one, the frame's."""
        if time01 not in self._caches:
            self._caches[time01] = UsdGeom.XformCache(self.grid.shutter.time_code(time01))
        return self._caches[time01]

    def matrix(self, time01: float, prim: Usd.Prim, root: Usd.Prim | None) -> np.ndarray:
        """root_from_prim without the root's own transform, float64[4, 4]; root None: world_from_prim.

        A prim that is not below the root (a skeleton may lie anywhere) is seen from where the root is.
        """
        cache = self.cache(time01)
        if root is None:
            return np.array(cache.GetLocalToWorldTransform(prim))
        if not prim.GetPath().HasPrefix(root.GetPath()):
            root_from_world = cache.GetLocalToWorldTransform(root).GetInverse()
            return np.array(cache.GetLocalToWorldTransform(prim) * root_from_world)
        return np.array(cache.ComputeRelativeTransform(prim, root)[0])

    def motion(self, prims: list[Usd.Prim], root: Usd.Prim | None, varying: bool) -> Motion:
        """How prims move in the space of `root`. `varying`: some transform between may change over time."""

        def evaluate(time01: float) -> np.ndarray:
            return np.array([self.matrix(time01, prim, root) for prim in prims])

        return Motion(self.grid, len(prims), not (varying and self.grid.shutter.moving), evaluate)


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
        """float64[8, 4], homogeneous; the origin eight times for an empty box."""
        ends = np.array([self.lo, self.hi]) if (self.lo <= self.hi).all() else np.zeros((2, 3))
        corners = np.ones((8, 4))
        corners[:, :3] = ends[_CORNERS, (0, 1, 2)]
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

    def nearest(self, corners: np.ndarray) -> np.ndarray:
        """The smallest size of a pixel at the boxes around float64[T, N, 8, 3] world points: float64[N]."""
        if not self.perspective:
            return np.full(corners.shape[1], self.per_unit)
        lo, hi = corners.min(axis=(0, 2)), corners.max(axis=(0, 2))
        gap = np.maximum(np.maximum(lo - self.camera_box.hi, self.camera_box.lo - hi), 0.0)
        return self.per_unit * np.maximum(np.linalg.norm(gap, axis=-1), self.near)


def deviations(times01: list[float], corners: np.ndarray) -> np.ndarray:
    """How far each of N boxes strays from the straight line between the samples next to each: float64[N].

    `corners` is float64[T, N, 8, 3]. Since corners are linear in the matrices, this bounds every point of the
    box.
    """
    if len(times01) < 3:
        return np.zeros(corners.shape[1])
    times = np.asarray(times01)
    weight = ((times[1:-1] - times[:-2]) / (times[2:] - times[:-2]))[:, None, None, None]
    straight = (1.0 - weight) * corners[:-2] + weight * corners[2:]
    return np.linalg.norm(corners[1:-1] - straight, axis=-1).max(axis=(0, 2))


def dense_samples(
    motion: Motion, box: Box, pixel: PixelSize, tolerance_pixels: float
) -> Iterator[tuple[np.ndarray, list[float], np.ndarray]]:
    """Samples matrices over the shutter until linear interpolation by element follows them within the
    tolerance.

    Doubles the samples of those that need it, up to the finest grid. Yields int[M] indices among the motion's
    things, their T times and float64[T, M, 4, 4]; every index once. `box` is that of each thing, in its own
    space.
    """
    remaining = np.arange(motion.count)
    local = box.corners()
    for level in range(COARSE_LEVEL, FINEST_LEVEL + 1):
        times01 = motion.times01(level)
        matrices = motion.at_level(level)[:, remaining]
        moving = (matrices != matrices[:1]).any(axis=(0, 2, 3))
        if not moving.all():
            yield remaining[~moving], [0.0], matrices[:1, ~moving]
            remaining, matrices = remaining[moving], matrices[:, moving]
        if not len(remaining):
            return
        corners = local @ matrices[..., :3]
        # The deviation compares with every second sample; with all of them the error is a quarter of it.
        dense = deviations(times01, corners) <= tolerance_pixels * pixel.nearest(corners)
        if level == FINEST_LEVEL:
            dense[:] = True
        if dense.any():
            yield remaining[dense], times01, matrices[:, dense]
            remaining = remaining[~dense]
        if not len(remaining):
            return


def may_move(prim: Usd.Prim, root: Usd.Prim | None) -> bool:
    """Whether the transform of a prim in the space of `root` may change over time: for prims that no
    traversal has come by."""
    if root is not None and not prim.GetPath().HasPrefix(root.GetPath()):
        return may_move(prim, None) or may_move(root, None)
    while prim and not prim.IsPseudoRoot() and prim != root:
        xformable = UsdGeom.Xformable(prim)
        if xformable and xformable.TransformMightBeTimeVarying():
            return True
        if xformable and xformable.GetResetXformStack():
            return False
        prim = prim.GetParent()
    return False


def authored_xform_times(xformables: list[UsdGeom.Xformable], shutter: Shutter) -> set[float]:
    """The time codes within the shutter at which any of the prims has a transform authored."""
    if not shutter.moving:
        return set()
    return set().union(*(xformable.GetTimeSamplesInInterval(shutter.interval) for xformable in xformables))
