"""Instances, native ones and those of point instancers, nested in any way, as matrices in the world."""

from __future__ import annotations

from collections.abc import Hashable, Iterator
from dataclasses import dataclass

import numpy as np
from pxr import UsdGeom

from .context import FrameContext
from .point_instancers import read_point_instancer
from .transforms import Motion, XformCaches
from .traversal import WORLD, Group, Part, Traversal


@dataclass(frozen=True)
class Placement:
    """A group, as often as it stands somewhere by one chain of instancing prims."""

    path: str
    """Of the last prim in the chain."""
    key: Hashable
    motion: Motion
    """From the group's space into that of the chain's start, the world in the end."""
    display_color: np.ndarray | None
    """float32[count, 3], or None: the group's own colours."""

    def inside(self, outer: Placement) -> Placement:
        """This under each of `outer`. The innermost that has colours decides."""
        colour = None
        if self.display_color is not None:
            colour = np.tile(self.display_color, (outer.motion.count, 1))
        elif outer.display_color is not None:
            colour = np.repeat(outer.display_color, self.motion.count, axis=0)
        return Placement(self.path, self.key, self.motion.inside(outer.motion), colour)


class Placer:
    """Flattens the graph of groups into placements in the world."""

    def __init__(self, traversal: Traversal, caches: XformCaches, context: FrameContext) -> None:
        self._groups = traversal.groups
        self._caches = caches
        self._context = context

    def placements(self) -> Iterator[Placement]:
        """Every group wherever it stands; the world first, once, at the identity."""
        identity = Motion(self._caches.grid, 1, True, lambda _: np.eye(4)[None])
        yield from self._below(Placement("/", WORLD, identity, None), ())

    def _below(self, outer: Placement, trail: tuple[Hashable, ...]) -> Iterator[Placement]:
        if outer.key in trail:
            message = "found a prototype that instances itself, expected none; not drawn"
            self._context.diagnostics.error(outer.path, "prototypes", message)
            return
        yield outer
        group = self._groups[outer.key]
        for inner in self._inner(group):
            yield from self._below(inner.inside(outer), (*trail, outer.key))

    def _inner(self, group: Group) -> Iterator[Placement]:
        """What instances in a group show, in the group's space."""
        for key, parts in group.instances.items():
            for varying in (False, True):
                prims = [part.prim for part in parts if part.varying == varying]
                if prims:
                    motion = self._caches.motion(prims, group.root, varying)
                    yield Placement(str(prims[0].GetPath()), key, motion, None)
        for part in group.instancers:
            yield from self._points(part, group)

    def _points(self, part: Part, group: Group) -> Iterator[Placement]:
        group_from_instancer = self._caches.motion([part.prim], group.root, part.varying)
        instancer = UsdGeom.PointInstancer(part.prim)
        for points in read_point_instancer(instancer, self._caches, self._context):
            key = Traversal.prototype_key(points.prototype)
            motion = points.motion.inside(group_from_instancer)
            yield Placement(str(part.prim.GetPath()), key, motion, points.display_color)
