"""Transforms over the shutter, evaluated by USD itself and as densely as linear interpolation needs.

Matrices are float64[4, 4] in USD's row-vector convention: p' = p M, so the inner map stands left in a
product.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

import numpy as np
from pxr import Sdf, Usd, UsdGeom

from .._core import Density, MotionSamples, PixelSize, Turns, dense_times01, sample_motion
from .boxes import Box
from .times import Shutter, xform_breakpoints
from .turns import NO_TURNS, total_turns, xform_turns
from .xform_ops import may_vary, relative_transform, resets, world_transform, world_transforms


class Motion:
    """The matrices of `count` things that move together over the shutter."""

    def __init__(
        self,
        shutter: Shutter,
        count: int,
        still: bool,
        evaluate: Callable[[float], np.ndarray],
        breakpoints01: tuple[float, ...] = (),
        evaluate_some: Callable[[float, np.ndarray], np.ndarray] | None = None,
        carriers: Callable[[int], list[UsdGeom.Xformable]] | None = None,
        turns: Callable[[int], Turns] | None = None,
    ) -> None:
        """`evaluate(time01)` gives float64[count, 4, 4]; `evaluate_some(time01, indices)` those of some things,
        where that is cheaper. `still`: it is the same at any time. `breakpoints01`: times inside the shutter at which
        the motion may change its course (or, on a held stage, its place). `carriers(index)`: the prims whose ops
        move a thing, the innermost first, for messages. `turns(index)`: how far a thing turns at most; none where
        nobody says."""
        self.count = count
        self.still = still
        self.breakpoints01 = breakpoints01
        self._shutter = shutter
        self._evaluate = evaluate
        self._evaluate_some = evaluate_some
        self._carriers = carriers
        self._turns = turns
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
        return self._shutter

    def carriers(self, index: int) -> list[UsdGeom.Xformable]:
        """The prims whose ops move a thing, the innermost first; [] where nobody said."""
        return self._carriers(index) if self._carriers else []

    def turns(self, index: int) -> Turns:
        """How far a thing turns at most."""
        return NO_TURNS if self.still or self._turns is None else self._turns(index)

    def every_turns(self) -> list[Turns]:
        """Of each thing."""
        return [self.turns(index) for index in range(self.count)]

    def dense_times01(self, density: Density, held: bool = False) -> list[float]:
        """As many times as `density` asks for, and those at which the motion may change its course (`held`: its place);
        [0] where still."""
        if self.still:
            return [0.0]
        fastest = max((turns.rate for turns in self.every_turns()), default=0.0)
        return dense_times01(density, fastest, self.breakpoints01, held)

    def few_times01(self) -> list[float]:
        """A few times that show where things are."""
        return self.dense_times01(Density.GLANCE)

    def samples(
        self, boxes: list[Box], pixel_size: PixelSize, tolerance_pixels: float, held: bool = False
    ) -> list[MotionSamples]:
        """Matrices over the shutter, as dense as interpolation between them needs to follow the stage within a share of
        the tolerance. Every index comes once. `boxes` are those of the things, each in its own space; one: of each.
        """
        ends = np.array([box.ends() for box in boxes]).reshape(-1, 2, 3)
        return sample_motion(self, ends, pixel_size, tolerance_pixels, held)

    def evaluate(self, times01: list[float], which: np.ndarray) -> np.ndarray:
        """float64[T, M, 4, 4] of M things: what samples() asks for."""
        return np.array([self.some(time01, which) for time01 in times01]).reshape(-1, len(which), 4, 4)

    def at_times(self, times01: Iterable[float]) -> np.ndarray:
        """float64[T, count, 4, 4]."""
        return np.array([self.at_time(time01) for time01 in times01])

    def inside(self, outer: Motion) -> Motion:
        """Each of these under each of `outer`: count = outer.count * self.count, the outer index first."""

        def evaluate(time01: float) -> np.ndarray:
            products = self.at_time(time01)[None, :] @ outer.at_time(time01)[:, None]
            return products.reshape(-1, 4, 4)

        def turns(index: int) -> Turns:
            return self.turns(index % self.count) + outer.turns(index // self.count)

        breakpoints01 = tuple(sorted({*self.breakpoints01, *outer.breakpoints01}))
        still = outer.still and self.still
        return Motion(self._shutter, outer.count * self.count, still, evaluate, breakpoints01, turns=turns)


class XformCaches:
    """One UsdGeom.XformCache a time, shared by all prims: ancestors are evaluated once a time, not once a
    prim."""

    def __init__(self, shutter: Shutter) -> None:
        self.shutter = shutter
        self._caches: dict[float | None, UsdGeom.XformCache] = {}
        self._turns: dict[tuple[Sdf.Path, Shutter], Turns] = {}

    def cache(self, time01: float, shutter: Shutter | None = None) -> UsdGeom.XformCache:
        """The cache of a time; a closed shutter has one, the frame's."""
        code = (shutter or self.shutter).time_code(time01)
        key = None if code.IsDefault() else code.GetValue()
        if key not in self._caches:
            self._caches[key] = UsdGeom.XformCache(code)
        return self._caches[key]

    def matrices(self, time01: float, prims: Iterable[Usd.Prim], root: Usd.Prim | None, shutter: Shutter) -> np.ndarray:
        """matrix() of several prims: float64[N, 4, 4]."""
        if root is not None:
            return np.array([self.matrix(time01, prim, root, shutter) for prim in prims])
        cache = self.cache(time01, shutter)
        return world_transforms(cache, prims)

    def matrix(
        self, time01: float, prim: Usd.Prim, root: Usd.Prim | None, shutter: Shutter | None = None
    ) -> np.ndarray:
        """root_from_prim without the root's own transform, float64[4, 4]; root None: world_from_prim.

        A prim that is not below the root (a skeleton may lie anywhere) is seen from where the root is.
        """
        cache = self.cache(time01, shutter)
        if root is None:
            return np.array(world_transform(cache, prim))
        if not prim.GetPath().HasPrefix(root.GetPath()):
            root_from_world = world_transform(cache, root).GetInverse()
            return np.array(world_transform(cache, prim) * root_from_world)
        return np.array(relative_transform(cache, prim, root))

    def motion(
        self,
        prims: list[Usd.Prim],
        root: Usd.Prim | None,
        varying: bool,
        shutter: Shutter | None = None,
        breakpoints: Iterable[float] = (),
    ) -> Motion:
        """How prims move in the space of `root`. `varying`: some transform between may change over time, its
        course at the time codes `breakpoints`. `shutter`: of the prims, where it is not the camera's."""
        own = shutter or self.shutter

        def evaluate(time01: float) -> np.ndarray:
            return self.matrices(time01, prims, root, own)

        def evaluate_some(time01: float, indices: np.ndarray) -> np.ndarray:
            return self.matrices(time01, [prims[index] for index in indices.tolist()], root, own)

        def carriers(index: int) -> list[UsdGeom.Xformable]:
            return list(xformables(prims[index], root))

        def turns(index: int) -> Turns:
            return total_turns(self._own_turns(xformable, own) for xformable in xformables(prims[index], root))

        still = not (varying and own.moving)
        breakpoints01 = () if still else tuple(sorted({own.time01(time) for time in breakpoints}))
        return Motion(own, len(prims), still, evaluate, breakpoints01, evaluate_some, carriers, turns)

    def _own_turns(self, xformable: UsdGeom.Xformable, shutter: Shutter) -> Turns:
        """xform_turns(), remembered: siblings have the same ancestors."""
        key = xformable.GetPath(), shutter
        if key not in self._turns:
            self._turns[key] = xform_turns(xformable, shutter)
        return self._turns[key]


def may_move(prim: Usd.Prim, root: Usd.Prim | None) -> bool:
    """Whether the transform of a prim in the space of `root` may change over time. For prims that no traversal
    has come by."""
    if root is not None and not prim.GetPath().HasPrefix(root.GetPath()):
        return may_move(prim, None) or may_move(root, None)
    return any(may_vary(xformable) for xformable in xformables(prim, root))


def transform_breakpoints(prim: Usd.Prim, root: Usd.Prim | None, shutter: Shutter) -> set[float]:
    """The time codes inside the shutter at which the transform of a prim in the space of `root` may change its
    course."""
    if root is not None and not prim.GetPath().HasPrefix(root.GetPath()):
        return transform_breakpoints(prim, None, shutter) | transform_breakpoints(root, None, shutter)
    if not shutter.moving:
        return set()
    return set().union(*(xform_breakpoints(xformable, shutter) for xformable in xformables(prim, root)))


def xformables(prim: Usd.Prim, root: Usd.Prim | None) -> Iterator[UsdGeom.Xformable]:
    """The prim and its ancestors below `root` (of a prim elsewhere: all), as far as they carry it."""
    while prim and not prim.IsPseudoRoot() and prim != root:
        xformable = UsdGeom.Xformable(prim)
        if xformable:
            yield xformable
            if resets(xformable):
                return
        prim = prim.GetParent()


def authored_xform_times(xformables: list[UsdGeom.Xformable], shutter: Shutter) -> set[float]:
    """The time codes within the shutter at which any of the prims has a transform authored."""
    if not shutter.moving:
        return set()
    return set().union(*(xform_breakpoints(xformable, shutter) for xformable in xformables))
