"""How many instances a stage multiplies out to, before anything of them is read but how many each instancer has."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from pxr import Usd, UsdGeom

from ..base.errors import SceneError
from ..motion.context import FrameContext, array
from ..stage.value_types import INTS
from ..stage.values import Unreadable, required
from .point_instancers import prototypes
from .traversal import WORLD, Group, Traversal

_CHUNK = 2**22
"""Indices that are counted at once: an array of a billion takes no memory beside its own."""


@dataclass(frozen=True)
class Use:
    """A group as one prim, or several alike, instance it in another."""

    path: str
    """Of the prim, or the first of them."""
    attribute: str
    """What says how often; empty for native instances."""
    key: Hashable
    count: int


def uses_of(group: Group, groups: Mapping[Hashable, Group], context: FrameContext) -> list[Use]:
    """What a group instances at the frame. Ids that are masked count all the same: they are read, too."""
    found = [Use(str(parts[0].prim.GetPath()), "", key, len(parts)) for key, parts in group.instances.items()]
    for part in group.instancers:
        found.extend(_uses_of_instancer(part.prim, groups, context))
    return found


def _uses_of_instancer(prim: Usd.Prim, groups: Mapping[Hashable, Group], context: FrameContext) -> Iterator[Use]:
    instancer = UsdGeom.PointInstancer(prim)
    try:
        roots = prototypes(instancer)
        indices = array(required(instancer.GetProtoIndicesAttr(), context.code, INTS), np.int32)
    except Unreadable:
        return  # Whoever reads the instances says so.
    counts = np.zeros(len(roots), np.int64)
    for begin in range(0, len(indices), _CHUNK):
        some = indices[begin : begin + _CHUNK]
        counts += np.bincount(some[(some >= 0) & (some < len(roots))], minlength=len(roots))
    for root, count in zip(roots, counts.tolist(), strict=True):
        if root and count:
            group = groups[Traversal.prototype_key(root)]
            for key in filter(None, (group.key, group.reset)):
                yield Use(str(prim.GetPath()), "protoIndices", key, count)


class InstanceGraph:
    """Which groups instance which, without those uses that lead back to where they come from."""

    def __init__(self, groups: Mapping[Hashable, Group], context: FrameContext) -> None:
        uses = {key: uses_of(group, groups, context) for key, group in groups.items()}
        self._component = _components({key: [use.key for use in found] for key, found in uses.items()})
        self._shows = {key: bool(group.shapes or group.lights) for key, group in groups.items()}
        self._uses = {key: [use for use in found if not self.leads_back(key, use.key)] for key, found in uses.items()}
        self._instances: dict[Hashable, int] = {}
        self._ways: dict[Hashable, int] = {}
        for key in sorted(groups, key=self._component.__getitem__):  # What is used comes before what uses it.
            self._instances[key] = sum(self._multiplied(use) for use in self._uses[key])
            self._ways[key] = sum(1 + self._ways[use.key] for use in self._uses[key])

    def leads_back(self, outer: Hashable, inner: Hashable) -> bool:
        """Whether a group that is instanced in another instances that one, directly or not."""
        return self._component[outer] == self._component[inner]

    def check(self, limit: int) -> None:
        """Raises SceneError where more instances are drawn than the limit, or where instancers that draw none are
        nested in more ways."""
        total, ways = self._instances[WORLD], self._ways[WORLD]
        if total > limit:
            use, found = self._largest()
            of = "" if total == found else f" of {total} on the stage"
            raise SceneError(_refusal(use, f"found {found} instances{of}", limit))
        if ways > limit:
            use = max(self._uses[WORLD], key=lambda use: self._ways[use.key])
            raise SceneError(_refusal(use, f"found {ways} ways in which instances are nested", limit))

    def _multiplied(self, use: Use) -> int:
        """How many instances are drawn by a use of a group, those in it included."""
        return use.count * (self._shows[use.key] + self._instances[use.key])

    def _largest(self) -> tuple[Use, int]:
        """The prim in the world that multiplies out to most, and to how many; where that is a native instance, the
        instancer in it, if that has most of them."""
        named, found = use, _ = self._largest_in(WORLD, 1)
        times = 1
        while not use.attribute and self._uses[use.key]:
            times *= use.count
            use, inside = self._largest_in(use.key, times)
            if 2 * inside < found:
                break
            if use.attribute:
                named, found = use, inside
        return named, found

    def _largest_in(self, key: Hashable, times: int) -> tuple[Use, int]:
        """All uses by one prim count together."""
        by_path: dict[str, int] = {}
        first: dict[str, Use] = {}
        for use in self._uses[key]:
            by_path[use.path] = by_path.get(use.path, 0) + times * self._multiplied(use)
            first.setdefault(use.path, use)
        path = max(by_path, key=by_path.__getitem__)
        return first[path], by_path[path]


def _refusal(use: Use, found: str, limit: int) -> str:
    subject = ".".join(filter(None, (use.path, use.attribute)))
    raised = "--max-instances raises the limit, at about 1 kB of memory each"
    return f"{subject}: {found}, expected at most {limit}; {raised}"


def _components(edges: dict[Hashable, list[Hashable]]) -> dict[Hashable, int]:
    """The number of each node's strongly connected component (Tarjan 1972, without recursion); what a node leads to
    has a smaller number, or its own where it leads back."""
    index: dict[Hashable, int] = {}
    low: dict[Hashable, int] = {}
    component: dict[Hashable, int] = {}
    path: list[Hashable] = []
    finished = 0
    for start in edges:
        pending = [(start, iter(edges[start]))] if start not in index else []
        while pending:
            node, rest = pending[-1]
            if node not in index:
                index[node] = low[node] = len(index)
                path.append(node)
            for target in rest:
                if target not in index:
                    pending.append((target, iter(edges[target])))
                    break
                if target not in component:
                    low[node] = min(low[node], index[target])
            else:
                pending.pop()
                if pending:
                    low[pending[-1][0]] = min(low[pending[-1][0]], low[node])
                if low[node] == index[node]:
                    while True:
                        member = path.pop()
                        component[member] = finished
                        if member == node:
                            break
                    finished += 1
    return component
