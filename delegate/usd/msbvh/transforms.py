"""Transforms over the shutter, evaluated by USD itself and as densely as linear interpolation needs.

Matrices are float64[4, 4] in USD's row-vector convention: p' = p M, so the inner map stands left in a
product.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from pxr import Usd, UsdGeom

from .times import Shutter, TimeGrid, xform_bends


class Motion:
    """The matrices of `count` things that move together over the shutter."""

    def __init__(
        self,
        grid: TimeGrid,
        count: int,
        still: bool,
        evaluate: Callable[[float], np.ndarray],
        bends01: tuple[float, ...] = (),
        evaluate_some: Callable[[float, np.ndarray], np.ndarray] | None = None,
        carriers: Callable[[int], list[UsdGeom.Xformable]] | None = None,
    ) -> None:
        """`evaluate(time01)` gives float64[count, 4, 4]; `evaluate_some(time01, indices)` those of some things,
        where that is cheaper. `still`: it is the same at any time. `bends01`: times inside the shutter at which
        the motion may change its course (or, on a held stage, its place). `carriers(index)`: the prims whose ops
        move a thing, the innermost first, for messages."""
        self.count = count
        self.still = still
        self.bends01 = bends01
        self._grid = grid
        self._evaluate = evaluate
        self._evaluate_some = evaluate_some
        self._carriers = carriers
        self._known: dict[float, np.ndarray] = {}

    def some(self, time01: float, indices: np.ndarray) -> np.ndarray:
        """float64[M, 4, 4] of M things at a time; not kept."""
        if self._evaluate_some is None or time01 in self._known:
            return self.at_time(time01)[indices]
        return self._evaluate_some(time01, indices)

    def at_time(self, time01: float) -> np.ndarray:
        """float64[count, 4, 4]; evaluated once."""
        key = 0.0 if self.still else time01
        if key not in self._known:
            self._known[key] = self._evaluate(key)
        return self._known[key]

    @property
    def shutter(self) -> Shutter:
        """Of the things."""
        return self._grid.shutter

    def carriers(self, index: int) -> list[UsdGeom.Xformable]:
        """The prims whose ops move a thing, the innermost first; [] where nobody said."""
        return self._carriers(index) if self._carriers else []

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

    def __init__(self, shutter: Shutter, authored: Iterable[float] = (), held: bool = False) -> None:
        """`authored` are the time codes at which any transform has a sample."""
        self.shutter = shutter
        self.held = held
        self._authored = sorted(authored)
        self._caches: dict[float | None, UsdGeom.XformCache] = {}
        self._grids: dict[Shutter, TimeGrid] = {}

    def grid(self, shutter: Shutter) -> TimeGrid:
        """The times at which a prim with this shutter of its own (Shutter.scaled) is evaluated."""
        if shutter not in self._grids:
            self._grids[shutter] = TimeGrid(shutter, self._authored, self.held)
        return self._grids[shutter]

    def cache(self, time01: float, shutter: Shutter | None = None) -> UsdGeom.XformCache:
        """The cache of a time; a closed shutter has one, the frame's."""
        code = (shutter or self.shutter).time_code(time01)
        key = None if code.IsDefault() else code.GetValue()
        if key not in self._caches:
            self._caches[key] = UsdGeom.XformCache(code)
        return self._caches[key]

    def matrices(
        self, time01: float, prims: Iterable[Usd.Prim], root: Usd.Prim | None, shutter: Shutter
    ) -> np.ndarray:
        """matrix() of several prims: float64[N, 4, 4]."""
        if root is not None:
            return np.array([self.matrix(time01, prim, root, shutter) for prim in prims])
        to_world = self.cache(time01, shutter).GetLocalToWorldTransform
        return np.array([np.array(to_world(prim)) for prim in prims])

    def matrix(
        self, time01: float, prim: Usd.Prim, root: Usd.Prim | None, shutter: Shutter | None = None
    ) -> np.ndarray:
        """root_from_prim without the root's own transform, float64[4, 4]; root None: world_from_prim.

        A prim that is not below the root (a skeleton may lie anywhere) is seen from where the root is.
        """
        cache = self.cache(time01, shutter)
        if root is None:
            return np.array(cache.GetLocalToWorldTransform(prim))
        if not prim.GetPath().HasPrefix(root.GetPath()):
            root_from_world = cache.GetLocalToWorldTransform(root).GetInverse()
            return np.array(cache.GetLocalToWorldTransform(prim) * root_from_world)
        return np.array(cache.ComputeRelativeTransform(prim, root)[0])

    def motion(
        self,
        prims: list[Usd.Prim],
        root: Usd.Prim | None,
        varying: bool,
        shutter: Shutter | None = None,
        bends: Iterable[float] = (),
    ) -> Motion:
        """How prims move in the space of `root`. `varying`: some transform between may change over time, its
        course at the time codes `bends`. `shutter`: of the prims, where it is not the camera's."""
        own = shutter or self.shutter

        def evaluate(time01: float) -> np.ndarray:
            return self.matrices(time01, prims, root, own)

        def evaluate_some(time01: float, indices: np.ndarray) -> np.ndarray:
            return self.matrices(time01, [prims[index] for index in indices.tolist()], root, own)

        def carriers(index: int) -> list[UsdGeom.Xformable]:
            return list(xformables(prims[index], root))

        still = not (varying and own.moving)
        bends01 = () if still else tuple(sorted({own.time01(time) for time in bends}))
        return Motion(self.grid(own), len(prims), still, evaluate, bends01, evaluate_some, carriers)


def may_move(prim: Usd.Prim, root: Usd.Prim | None) -> bool:
    """Whether the transform of a prim in the space of `root` may change over time. For prims that no traversal
    has come by."""
    if root is not None and not prim.GetPath().HasPrefix(root.GetPath()):
        return may_move(prim, None) or may_move(root, None)
    return any(xformable.TransformMightBeTimeVarying() for xformable in xformables(prim, root))


def bends_of(prim: Usd.Prim, root: Usd.Prim | None, shutter: Shutter) -> set[float]:
    """The time codes inside the shutter at which the transform of a prim in the space of `root` may change its
    course."""
    if root is not None and not prim.GetPath().HasPrefix(root.GetPath()):
        return bends_of(prim, None, shutter) | bends_of(root, None, shutter)
    if not shutter.moving:
        return set()
    return set().union(*(xform_bends(xformable, shutter) for xformable in xformables(prim, root)))


def xformables(prim: Usd.Prim, root: Usd.Prim | None) -> Iterator[UsdGeom.Xformable]:
    """The prim and its ancestors below `root` (of a prim elsewhere: all), as far as they carry it."""
    while prim and not prim.IsPseudoRoot() and prim != root:
        xformable = UsdGeom.Xformable(prim)
        if xformable:
            yield xformable
            if xformable.GetResetXformStack():
                return
        prim = prim.GetParent()


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


SAMPLING_SHARE = 0.1
"""Of the tolerance: by how much straight lines between samples may stray from the stage. The rest is the
track's."""
FINEST_SPLIT = 12
"""The most often that a stretch between bends is halved: 4096 samples follow ten turns of a wheel that fills the
image to a hundredth of a pixel."""
LARGEST_SAMPLES = 2**23
"""Matrices that are held at once, a gigabyte; beyond it sampling ends where it stands, and says so by its error."""
LARGEST = 2.0**60
"""The largest element of a usable matrix: kMaxCoordinate (core/geometry), so that products do not overflow."""
JUMP01 = 6e-8
"""Bends within this of each other are a jump (kTimeResolution in delegate/translate/time_layout.h)."""
SAME_TIME01 = 1e-12
"""Times that are nearer are one: the translator's kSameTime."""
_PROBE = 0.381966
"""Of a stretch: off the even places, so that no whole number of turns looks straight."""


@dataclass(frozen=True)
class TransformSamples:
    """Some of a motion's things over the shutter, as the translator takes them."""

    indices: np.ndarray
    """int[M] among the motion's things."""
    times01: np.ndarray
    """float64[T]."""
    matrices: np.ndarray
    """float64[T, M, 4, 4]."""
    bends01: np.ndarray
    """float64[B]: where the motion may change its course."""
    held: bool = False
    error_pixels: float = 0.0
    """By which the straight lines between the samples may stray from the stage."""
    usable: bool = True
    """False for those things of which a matrix is not finite or too large; nothing can be drawn there."""


PixelSizes = Callable[[np.ndarray], np.ndarray]
"""The smallest size of a pixel at boxes of float64[T, N, 8, 3] corners: float64[N]."""


def transform_samples(
    motion: Motion, boxes: list[Box], pixel_sizes: PixelSizes, tolerance_pixels: float, held: bool = False
) -> Iterator[TransformSamples]:
    """Samples matrices over the shutter until straight lines between them follow the stage within a share of the
    tolerance.

    Halves the stretches between bends, for those things that need it. Every index comes once. `boxes` are those
    of the things, each in its own space; one: of each.
    """
    everything = np.arange(motion.count)
    bends = np.array(motion.bends01)
    if motion.still:
        yield from _by_use(TransformSamples(everything, np.zeros(1), motion.at_time(0.0)[None], bends))
        return
    if held:
        times01 = np.array([0.0, *(time for time in motion.bends01 if time > 0.0)])
        # In the middle of what holds: a time that is rounded might lie before its own sample.
        middles = (times01 + np.append(times01[1:], 1.0)) / 2
        yield from _by_use(
            TransformSamples(everything, times01, _evaluated(motion, middles, everything), bends, True)
        )
        return
    local = np.array([box.corners() for box in boxes])
    yield from _smooth_samples(motion, local, pixel_sizes, tolerance_pixels, bends)


def _by_use(samples: TransformSamples) -> Iterator[TransformSamples]:
    """The usable things and the others apart; the one object where all are alike."""
    good = (np.abs(samples.matrices) <= LARGEST).all(axis=(0, 2, 3))
    if good.all():
        yield samples
        return
    for usable, chosen in ((True, good), (False, ~good)):
        if chosen.any():
            yield replace(
                samples,
                indices=samples.indices[chosen],
                matrices=samples.matrices[:, chosen],
                usable=usable,
            )


def _smooth_samples(
    motion: Motion, local: np.ndarray, pixel_sizes: PixelSizes, tolerance_pixels: float, bends: np.ndarray
) -> Iterator[TransformSamples]:
    """`local` is float64[N, 8, 4], or float64[1, 8, 4] for all."""
    limit = SAMPLING_SHARE * tolerance_pixels
    ends = _distinct_ends(bends)
    remaining = np.arange(motion.count)
    coarse = _evaluated(motion, ends, remaining)
    # No splitting would make a number of what is none.
    for samples in _by_use(TransformSamples(remaining, ends, coarse, bends)):
        if samples.usable:
            remaining, coarse = samples.indices, samples.matrices
            local = local if len(local) == 1 else local[remaining]
            continue
        yield samples
        if len(samples.indices) == motion.count:
            return
    lengths = np.diff(ends)
    stretches = lengths > JUMP01  # Across the others the motion jumps: nothing lies between.
    probes = ends[:-1] + _PROBE * lengths
    probed = _evaluated(motion, probes, remaining)
    for split in range(FINEST_SPLIT):
        times01 = _split(ends, split + 1)
        fine = _refined(motion, coarse, times01, remaining)
        corners = local @ fine[..., :3]
        size = pixel_sizes(corners)
        # Halving a chord quarters its distance from the curve.
        inside = np.append(np.repeat(stretches, 2 ** (split + 1)), True)
        bent = _bend(_split(ends, split), local @ coarse[..., :3], times01, corners, inside) / size
        beside = _bend(times01, corners, probes, local @ probed[..., :3], stretches) / size
        straight = np.maximum(bent, beside) <= limit
        good = straight if split == 0 else (bent <= 4.0 * limit) & (beside <= 4.0 * limit) & (split > 1)
        last = split + 1 == FINEST_SPLIT or 2 * fine.size > 16 * LARGEST_SAMPLES
        good = good | last
        kept_times, kept, error = (ends, coarse, bent) if split == 0 else (times01, fine, bent / 4.0)
        if good.any():
            found = float(error[good].max())
            yield TransformSamples(remaining[good], kept_times, kept[:, good], bends, False, found)
        if good.all():
            return
        remaining, coarse, probed = remaining[~good], fine[:, ~good], probed[:, ~good]
        local = local if len(local) == 1 else local[~good]


def _distinct_ends(bends: np.ndarray) -> np.ndarray:
    """0, 1 and the bends between. A bend at the shutter's end, or two at the same time, that differ by rounding
    alone would make a stretch of no length, which cannot be halved."""
    ends = [0.0]
    for time01 in sorted(bends.tolist()):
        if ends[-1] + SAME_TIME01 < time01 < 1.0 - SAME_TIME01:
            ends.append(time01)
    return np.array([*ends, 1.0])


def _evaluated(motion: Motion, times01: np.ndarray, indices: np.ndarray) -> np.ndarray:
    return np.array([motion.some(time01, indices) for time01 in times01.tolist()])


def _refined(motion: Motion, coarse: np.ndarray, times01: np.ndarray, indices: np.ndarray) -> np.ndarray:
    """The matrices at `times01`, every second of which `coarse` already has."""
    fine = np.empty((len(times01), *coarse.shape[1:]))
    fine[::2] = coarse
    fine[1::2] = _evaluated(motion, times01[1::2], indices)
    return fine


def _split(ends: np.ndarray, split: int) -> np.ndarray:
    """float64[T]: each stretch between two ends in 2^split equal parts."""
    parts = np.arange(2**split) / 2**split
    return np.append((ends[:-1, None] + parts * np.diff(ends)[:, None]).ravel(), ends[-1])


def _bend(
    times01: np.ndarray, corners: np.ndarray, probes: np.ndarray, probed: np.ndarray, counts: np.ndarray
) -> np.ndarray:
    """How far float64[P, N, 8, 3] corners at the probes stray from the straight lines between float64[T, N, 8, 3]
    ones: float64[N]. Since corners are linear in the matrices, this bounds every point of the box. `counts` is
    bool[P]: which probes matter."""
    after = np.clip(np.searchsorted(times01, probes, side="right"), 1, len(times01) - 1)
    begin, end = times01[after - 1], times01[after]
    weight = ((probes - begin) / (end - begin))[:, None, None, None]
    straight = (1.0 - weight) * corners[after - 1] + weight * corners[after]
    return np.linalg.norm((probed - straight)[counts], axis=-1).max(axis=(0, 2), initial=0.0)


def authored_xform_times(xformables: list[UsdGeom.Xformable], shutter: Shutter) -> set[float]:
    """The time codes within the shutter at which any of the prims has a transform authored."""
    if not shutter.moving:
        return set()
    return set().union(*(xform_bends(xformable, shutter) for xformable in xformables))
