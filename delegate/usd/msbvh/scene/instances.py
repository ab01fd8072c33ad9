"""Instances, native ones and those of point instancers, nested in any way, as levels that the translator
multiplies out."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import product

import numpy as np
from pxr import Sdf, Usd, UsdGeom

from .._core import LARGEST_ELEMENT, InstanceLevel, MotionSamples, PixelSize
from ..base.errors import Diagnostics
from ..motion.boxes import Box
from ..motion.context import FrameContext
from ..motion.points import carries_still_pose
from ..motion.times import Shutter
from ..motion.transform_faults import report_unusable
from ..motion.transforms import Motion, XformCaches
from ..motion.visibility import common_intervals, visible_intervals
from ..stage.usd_faults import leaving_out
from .instance_count import InstanceGraph
from .part import Part
from .point_instancers import (
    Colours,
    Values,
    each,
    moving_attributes,
    no_values,
    own_transform,
    prototypes,
    read_point_instancer,
)
from .traversal import WORLD, Group, Traversal


@dataclass(frozen=True)
class Level:
    """Maps that stand side by side: prims that USD evaluates, or a point instancer's arrays."""

    motion: Motion | None
    """Of prims; None: arrays."""
    arrays: InstanceLevel | None = None
    """Of a point instancer, with the instances that count."""

    @property
    def count(self) -> int:
        """How many there are."""
        return self.motion.count if self.motion is not None else len(self.known_arrays.selected)

    @property
    def known_arrays(self) -> InstanceLevel:
        """Of a level without a motion."""
        assert self.arrays is not None
        return self.arrays


@dataclass(frozen=True)
class Placement:
    """A group, as often as it stands somewhere by one chain of instancing prims."""

    path: str
    """Of the last prim in the chain."""
    key: Hashable
    levels: tuple[Level, ...]
    """From the group's space into that of the chain's start, the world in the end; the innermost first."""
    visible: np.ndarray | None
    """float64[K, 2]: the parts of the shutter in which the whole chain is visible; None: always."""
    display_color: Colours | None
    """Of `count` instances; None: the group's own colours."""
    values: Values
    """Primvars of `count` instances that come before the group's own."""
    homes: Callable[[], list[Sdf.Path]]
    """Of `count` instances: the prim that each is, or the point instancer that shows it."""
    place: Callable[[], Motion]
    """The levels multiplied out by USD itself, which is for lights: there are few of them."""

    @property
    def count(self) -> int:
        """How often the group stands there."""
        return int(np.prod([level.count for level in self.levels], dtype=np.int64)) if self.levels else 1

    @cached_property
    def motion(self) -> Motion:
        """See `place`."""
        return self.place()

    def values_inside(self, outer: Placement, name: str) -> np.ndarray | None:
        """See `values`, of this under each of `outer`."""
        own = self.values(name)
        if own is not None:
            return np.tile(own, (outer.count, 1))
        theirs = outer.values(name)
        return None if theirs is None else np.repeat(theirs, self.count, axis=0)

    def inside(self, outer: Placement) -> Placement:
        """This under each of `outer`. The innermost that has colours, or other values, decides."""
        colour = None
        if self.display_color is not None:
            colour = each(self.display_color, lambda own: np.tile(own, (outer.count, 1)))
        elif outer.display_color is not None:
            colour = each(outer.display_color, lambda theirs: np.repeat(theirs, self.count, axis=0))
        return Placement(
            self.path,
            self.key,
            self.levels + outer.levels,
            common_intervals(self.visible, outer.visible),
            colour,
            partial(self.values_inside, outer),
            self.homes,
            lambda: self.motion.inside(outer.motion),
        )


def _itself(motion: Motion) -> Motion:
    return motion


def _paths(parts: list[Part]) -> list[Sdf.Path]:
    return [part.prim.GetPath() for part in parts]


def _repeated(path: Sdf.Path, count: int) -> list[Sdf.Path]:
    return [path] * count


def _homes(own: Callable[[], list[Sdf.Path]], root: Usd.Prim | None, outer: Placement) -> list[Sdf.Path]:
    """Of paths in a group with that root, which stands at each of the homes of `outer`; None: in the world."""
    paths = own()
    if root is None:
        return paths
    start = root.GetPath()
    return [path.ReplacePrefix(start, home) for home in outer.homes() for path in paths]


class Placer:
    """Flattens the graph of groups into placements in the world."""

    def __init__(self, traversal: Traversal, graph: InstanceGraph, caches: XformCaches, context: FrameContext) -> None:
        self._groups = traversal.groups
        self._graph = graph
        self._caches = caches
        self._context = context

    def placements(self) -> Iterator[Placement]:
        """Every group wherever it stands; the world first, once, at the identity."""
        identity = Motion(self._caches.shutter, 1, True, lambda _: np.eye(4)[None])
        yield from self._below(Placement("/", WORLD, (), None, None, no_values, list, lambda: identity))

    def _below(self, outer: Placement) -> Iterator[Placement]:
        yield outer
        group = self._groups[outer.key]
        for inner in self._inner(group):
            if self._graph.leads_back(outer.key, inner.key):
                message = "found a prototype that instances itself, expected none; not drawn"
                self._context.diagnostics.error(inner.path, "prototypes", message)
                continue
            if self._context.found is not None:
                self._context.found.inside(inner.path, outer.path)
            root = None if outer.key == WORLD else group.root
            inside = replace(inner.inside(outer), homes=partial(_homes, inner.homes, root, outer))
            yield from self._below(inside)

    def _inner(self, group: Group) -> Iterator[Placement]:
        """What instances in a group show, in the group's space; those that move alike together."""
        for key, parts in group.instances.items():
            alike: dict[Hashable, list[Part]] = {}
            for part in parts:
                alike.setdefault((part.varying, part.breakpoints, part.scales, part.blinking), []).append(part)
            for same in alike.values():
                motion = self._motion(same, group)
                if self._context.found is not None:
                    shutter = self._context.shutter.scaled(same[0].scales.blur)
                    prims = [part.prim for part in same]
                    self._context.found.instances(prims, same[0].blinking, group.root, shutter)
                visible = self._visible(same[0])
                path = str(same[0].prim.GetPath())
                homes = partial(_paths, same)
                yield Placement(path, key, (Level(motion),), visible, None, no_values, homes, partial(_itself, motion))
        for part in group.instancers:
            with leaving_out(part.prim, self._context.code):
                yield from self._points(part, group)

    def _motion(self, parts: list[Part], group: Group) -> Motion:
        first = parts[0]
        shutter = self._context.shutter.scaled(first.scales.blur)
        prims = [part.prim for part in parts]
        return self._caches.motion(prims, group.root, first.varying, shutter, first.breakpoints)

    def _visible(self, part: Part) -> np.ndarray | None:
        return visible_intervals(part.blinking, self._context.shutter)

    def _points(self, part: Part, group: Group) -> Iterator[Placement]:
        group_from_instancer = self._motion([part], group)
        instancer = UsdGeom.PointInstancer(part.prim)
        context = self._context.scaled(part.scales.blur)
        if self._context.found is not None:
            shown = [(prim, self._root_shutter(prim)) for prim in prototypes(instancer) if prim]
            self._context.found.instancer(part.prim, part.blinking, group.root, context.shutter, shown)
        for points in read_point_instancer(instancer, self._caches, context, part.scales.velocity):
            own = own_transform(points.prototype, self._caches, self._root_shutter(points.prototype))
            chosen = points.arrays.copy()
            chosen.selected = points.selected
            arrays = Level(None, chosen)
            speeds = [instancer.GetVelocitiesAttr(), instancer.GetAngularVelocitiesAttr()]
            # With velocities USD takes all from the sample before the frame, scales too.
            moved = any(speed.GetNumTimeSamples() for speed in speeds)
            if moved and carries_still_pose(moving_attributes(instancer), context):
                arrays = Level(points.motion)
            placed = points.motion.inside(group_from_instancer)
            path, colour = str(part.prim.GetPath()), points.display_color
            visible = common_intervals(self._visible(part), points.visible)
            outer = (arrays, Level(group_from_instancer))
            root = self._groups[Traversal.prototype_key(points.prototype)]
            whole = own.inside(placed)
            values = points.values
            homes = partial(_repeated, part.prim.GetPath(), arrays.count)
            levels = (Level(own), *outer)
            yield Placement(path, root.key, levels, visible, colour, values, homes, partial(_itself, whole))
            if root.reset is not None:
                yield Placement(path, root.reset, outer, visible, colour, values, homes, partial(_itself, placed))

    def _root_shutter(self, prototype: Usd.Prim) -> Shutter:
        """Of a point instancer's prototype: its own motion:blurScale scales it."""
        return self._context.shutter.scaled(self._groups[Traversal.prototype_key(prototype)].scales.blur)


Measure = Callable[[list[InstanceLevel], Box], float]
"""Pixels that a unit of a space covers at most, given the levels outside of it and a box in it."""


def sampled_levels(
    placement: Placement,
    box: Box,
    measure: Measure,
    tolerance_pixels: float,
    held: bool,
    diagnostics: Diagnostics,
) -> Iterator[tuple[list[InstanceLevel], np.ndarray]]:
    """The translator's levels of a placement, sampled as densely as straight lines need, and int[N]: which of its
    instances they are. Several where some instances need more samples than others; those that a transform puts
    nowhere are left out, with an error. `box` is the group's.
    """
    boxes = [box]
    for level in placement.levels[:-1]:
        boxes.append(_image(level, boxes[-1]))
    coarse = [coarse_level(level) for level in placement.levels]
    choices: list[list[tuple[np.ndarray, InstanceLevel]]] = []
    for index, level in enumerate(placement.levels):
        if level.motion is None:
            choices.append([(np.arange(level.count), level.known_arrays)])
            continue
        size = _pixel_size(coarse[index + 1 :], boxes[index], level, measure)
        sampled = level.motion.samples([boxes[index]], size, tolerance_pixels, held)
        for samples in sampled:
            if not samples.usable:
                _report(level.motion, samples.indices, diagnostics)
        choices.append([(samples.indices, matrix_level(samples)) for samples in sampled if samples.usable])
    counts = [level.count for level in placement.levels]
    for chosen in product(*choices):
        indices = np.zeros(1, np.int64)
        for (own, _), count in zip(reversed(chosen), reversed(counts), strict=True):
            indices = (indices[:, None] * count + own[None]).ravel()
        yield [one for _, one in chosen], indices


def _report(motion: Motion, indices: np.ndarray, diagnostics: Diagnostics) -> None:
    """The faults of a few things: beyond them it is one fault further up, or more than anybody reads."""
    for index in indices[:8].tolist():
        report_unusable(motion, index, diagnostics)


def matrix_level(samples: MotionSamples) -> InstanceLevel:
    """A level of matrices as the translator takes it."""
    level = InstanceLevel()
    level.times01, level.matrices = samples.times01, samples.matrices
    level.breakpoints01 = samples.breakpoints01
    level.periods01 = np.array(sorted({period for periods in samples.periods01 for period in periods}))
    level.held = samples.held
    return level


def coarse_level(level: Level) -> InstanceLevel:
    """A few samples of a level: how large things are seen, not how they move."""
    if level.motion is None:
        return level.known_arrays
    times01 = level.motion.few_times01()
    return _plain_level(np.array(times01), np.ascontiguousarray(level.motion.at_times(times01)))


def _plain_level(times01: np.ndarray, matrices: np.ndarray) -> InstanceLevel:
    level = InstanceLevel()
    level.times01, level.matrices = times01, matrices
    return level


def _pixel_size(outer: list[InstanceLevel], box: Box, level: Level, measure: Measure) -> PixelSize:
    """The size of a pixel in the space that a level leads to: one for all its things."""
    if level.motion is not None and level.motion.still:
        return PixelSize.uniform(1.0)
    image = _image(level, box)
    identity = _plain_level(np.zeros(1), np.eye(4).reshape(1, 1, 4, 4))
    return PixelSize.uniform(1.0 / max(measure(outer or [identity], image), 1e-30))


def _image(level: Level, box: Box) -> Box:
    """Around a box under all maps of a level, roughly: at a few times."""
    if level.motion is not None:
        with np.errstate(invalid="ignore", over="ignore"):
            corners = [box.corners() @ at[..., :3] for at in level.motion.at_times(level.motion.few_times01())]
        return Box.around(np.concatenate(corners).reshape(-1, 3))
    centres = Box.around(_usable(np.concatenate([values for _, values in level.known_arrays.positions])))
    scales = [np.abs(_usable(values)).max(initial=0.0) for _, values in level.known_arrays.scales or ()] or [1.0]
    reach = float(max(scales)) * float(np.linalg.norm(box.corners()[:, :3], axis=1).max())
    with np.errstate(over="ignore"):  # What is too large is left out by the translator.
        return Box(centres.lo - reach, centres.hi + reach)


def _usable(values: np.ndarray) -> np.ndarray:
    """Without those of float32[N, 3] that put an instance nowhere: the translator leaves it out."""
    return values[(np.abs(values) <= LARGEST_ELEMENT).all(axis=1)]
