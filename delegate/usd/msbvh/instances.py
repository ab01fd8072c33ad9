"""Instances: native ones and those of point instancers, nested in any way, as matrices of groups in the world."""

from __future__ import annotations

from collections.abc import Hashable, Iterator
from dataclasses import dataclass

import numpy as np
from pxr import Usd, UsdGeom

from .context import FrameContext, array
from .points import changes
from .primvars import read_primvar
from .transforms import Motion, XformCaches
from .traversal import WORLD, Group, Traversal, moving_attributes, prototypes


@dataclass(frozen=True)
class Placement:
    """A group, as often as it stands in the world by one chain of instancing prims."""

    path: str
    """Of the last prim in the chain."""
    key: Hashable
    motion: Motion
    """world_from_group."""
    display_color: np.ndarray | None
    """float32[count, 3], or None: the group's own colours."""


class Placer:
    """Flattens the graph of groups into placements in the world."""

    def __init__(self, traversal: Traversal, caches: XformCaches, context: FrameContext) -> None:
        self._groups = traversal.groups
        self._caches = caches
        self._context = context

    def placements(self) -> Iterator[Placement]:
        """Every group wherever it stands, the world once at the identity."""
        identity = Motion(self._caches.grid, 1, True, lambda _: np.eye(4)[None])
        yield from self._below(Placement("/", WORLD, identity, None), ())

    def _below(self, outer: Placement, trail: tuple[Hashable, ...]) -> Iterator[Placement]:
        if outer.key in trail:
            self._context.diagnostics.error(outer.path, "prototypes", "found a prototype that instances itself; not drawn")
            return
        yield outer
        group = self._groups[outer.key]
        for inner in (*self._native(group), *self._points(group)):
            colour = _combined_color(outer, inner)
            placed = Placement(inner.path, inner.key, inner.motion.inside(outer.motion), colour)
            yield from self._below(placed, (*trail, outer.key))

    def _native(self, group: Group) -> Iterator[Placement]:
        """The native instances of a group, those of one prototype together."""
        for key, parts in group.instances.items():
            for varying in (False, True):
                prims = [part.prim for part in parts if part.varying == varying]
                if prims:
                    yield Placement(str(prims[0].GetPath()), key, self._caches.motion(prims, group.root, varying), None)

    def _points(self, group: Group) -> Iterator[Placement]:
        """The instances of a group's point instancers."""
        for part in group.instancers:
            instancer = UsdGeom.PointInstancer(part.prim)
            own = self._caches.motion([part.prim], group.root, part.varying)
            yield from self._instancer(instancer, own)

    def _instancer(self, instancer: UsdGeom.PointInstancer, own: Motion) -> Iterator[Placement]:
        """The instances of a point instancer that are neither invisible nor inactive, one placement a prototype.

        `own` is group_from_instancer.
        """
        prims = prototypes(instancer)
        chosen = self._prototype_indices(instancer, prims)
        if chosen is None:
            return
        moves = self._moves(instancer)
        every = Motion(self._caches.grid, len(chosen), not moves, lambda time: self._matrices(instancer, time, len(chosen)))
        if every.at_time(0.0).shape[0] != len(chosen):
            found = f"found {len(chosen)} instances but USD cannot compute their transforms; not drawn"
            self._context.diagnostics.error(str(instancer.GetPath()), "", found)
            return
        colours = self._display_color(instancer, len(chosen))
        for index, prim in enumerate(prims):
            selected = np.flatnonzero(chosen == index)
            if not len(selected):
                continue
            placed = _selected(every, selected, self._caches, prim).inside(own)
            colour = None if colours is None else colours[selected]
            yield Placement(str(instancer.GetPath()), Traversal.prototype_key(prim), placed, colour)

    def _prototype_indices(self, instancer: UsdGeom.PointInstancer, prims: list[Usd.Prim]) -> np.ndarray | None:
        """int32[N], -1 for instances that are not drawn; None if there are none at all."""
        path, code, diagnostics = str(instancer.GetPath()), self._context.code, self._context.diagnostics
        indices = array(instancer.GetProtoIndicesAttr().Get(code), np.int32).copy()
        if not len(indices):
            diagnostics.group(path, "", "empty: it has no instances at this frame", "note")
            return None
        mask = np.array(instancer.ComputeMaskAtTime(code), bool)
        if len(mask) == len(indices):
            indices[~mask] = -1
        elif len(mask):
            found = f"found {len(mask)} ids, expected {len(indices)}, one an instance; nothing is masked"
            diagnostics.warning(path, "ids", found)
        exists = np.array([bool(prim) for prim in prims] + [False])
        drawn = (indices >= 0) & (indices < len(prims))
        bad = np.unique(indices[~drawn & (indices != -1) | drawn & ~exists[np.where(drawn, indices, -1)]])
        if len(bad):
            found = f"found {', '.join(map(str, bad[:8]))}, expected the index of one of {len(prims)} existing prototypes"
            diagnostics.error(path, "protoIndices", f"{found}; those instances are not drawn")
            indices[np.isin(indices, bad)] = -1
        if changes(instancer.GetProtoIndicesAttr(), self._context):
            message = "the instances change within the shutter; the frame's are drawn throughout"
            diagnostics.warning(path, "protoIndices", message)
        return indices

    def _moves(self, instancer: UsdGeom.PointInstancer) -> bool:
        if not self._context.shutter.moving:
            return False
        speeds = (instancer.GetVelocitiesAttr(), instancer.GetAngularVelocitiesAttr())
        return any(attribute.HasAuthoredValue() for attribute in speeds) or any(
            attribute.ValueMightBeTimeVarying() for attribute in moving_attributes(instancer)
        )

    def _matrices(self, instancer: UsdGeom.PointInstancer, time01: float, count: int) -> np.ndarray:
        """instancer_from_instance without the prototypes' own transforms: float64[count, 4, 4]; [0, 4, 4] on failure."""
        point_instancer = UsdGeom.PointInstancer
        computed = instancer.ComputeInstanceTransformsAtTimes(
            [self._context.shutter.time_code(time01)],
            self._context.code,
            point_instancer.ExcludeProtoXform,
            point_instancer.IgnoreMask,
        )
        matrices = np.array(computed[0]) if computed else np.zeros((0, 4, 4))
        return matrices if len(matrices) == count else np.zeros((0, 4, 4))

    def _display_color(self, instancer: UsdGeom.PointInstancer, count: int) -> np.ndarray | None:
        """float32[count, 3] where displayColor varies over the instances. A constant one is inherited, not ours."""
        primvar = read_primvar(instancer.GetPrim(), "displayColor", 3, self._context)
        if primvar is None or primvar[0] == "constant":
            return None
        _, values, indices = primvar
        path = str(instancer.GetPath())
        if indices is not None:
            if len(indices) and (indices.min() < 0 or indices.max() >= len(values)):
                self._context.diagnostics.warning(path, "primvars:displayColor", "found indices out of range; ignored")
                return None
            values = values[indices]
        if len(values) != count:
            found = f"found {len(values)} values, expected {count}, one an instance; ignored"
            self._context.diagnostics.warning(path, "primvars:displayColor", found)
            return None
        return values


def _selected(every: Motion, selected: np.ndarray, caches: XformCaches, prototype: Usd.Prim) -> Motion:
    """Some instances of an instancer with their prototype's own transform inside: instancer_from_group."""
    xformable = UsdGeom.Xformable(prototype)
    moving = bool(xformable) and xformable.TransformMightBeTimeVarying() and caches.grid.shutter.moving

    def evaluate(time01: float) -> np.ndarray:
        matrices = every.at_time(time01)[selected]
        return np.array(caches.cache(time01).GetLocalTransformation(prototype)[0]) @ matrices

    return Motion(caches.grid, len(selected), every.still and not moving, evaluate)


def _combined_color(outer: Placement, inner: Placement) -> np.ndarray | None:
    """The colours of `inner` under each of `outer`; the innermost that has any decides."""
    if inner.display_color is not None:
        return np.tile(inner.display_color, (outer.motion.count, 1))
    if outer.display_color is not None:
        return np.repeat(outer.display_color, inner.motion.count, axis=0)
    return None
