"""What the reader found of each prim's motion: attributes, their sample times, and who computed them.

For `msbvh motion`. While a frame is read only references are noted, a few a prim and none an instance; what
they hold is looked up when it is asked for.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field

from pxr import Usd, UsdGeom

from .._core import InstanceLevel
from ..stage.values import might_vary
from .times import Shutter, bracketing_times
from .xform_ops import ordered_ops, resets

COMPOSED_TRANSFORM = "xformOpOrder"
"""The attribute that stands for a transform as a whole, as in diagnostics."""
_SHAPE = ("points", "velocities", "accelerations", "primvars:normals", "normals", "radius", "height", "size")
_EXTENTS = ("width", "length", "radiusTop", "radiusBottom", "pointWeights", "extentsHint")
_TOPOLOGY = ("faceVertexCounts", "faceVertexIndices", "surfaceFaceVertexIndices", "tetVertexIndices")
_INSTANCER = ("positions", "orientationsf", "orientations", "scales")
_RATES = ("velocities", "accelerations", "angularVelocities", "protoIndices")
_ANIMATION = ("translations", "rotations", "scales", "blendShapeWeights")


@dataclass(frozen=True)
class FoundSamples:
    """The samples of an attribute that say how it moves over the shutter, those that bracket it included."""

    attribute: str
    """Its path."""
    times: tuple[float, ...]
    """Time codes, increasing; empty for a value that holds at all times. For a spline those of its knots."""
    authored: bool
    """Authored as time samples or default; else computed by the stage at these times, or by a spline."""


@dataclass
class _Entry:
    """One prim that is drawn, or several instances that move alike."""

    prims: Sequence[Usd.Prim]
    root: Usd.Prim | None
    """In whose space it moves."""
    shutter: Shutter
    """Its own."""
    placed_by: Usd.Prim
    attributes: tuple[str, ...] = ()
    """Of the prim, as far as they are authored."""
    animation: Usd.Prim | None = None
    posed_at01: tuple[float, ...] = ()
    """Where a skeleton posed its points."""
    blinking: tuple[Usd.Attribute, ...] = ()
    prototypes: tuple[tuple[Usd.Prim, Shutter], ...] = ()
    """Roots of a point instancer's prototypes, each with its own shutter."""
    evaluated_at01: tuple[float, ...] = ()
    """Where the stage composed its transforms."""
    outer: set[str] = field(default_factory=set)
    """Paths of the instances that it was found inside."""

    def samples(self, prim: Usd.Prim) -> Iterator[FoundSamples]:
        """What moves one of the prims."""
        shutter, path = self.shutter, prim.GetPath()
        for name in self.attributes:
            attribute = prim.GetAttribute(name)
            posed = name == "points" and self.posed_at01
            if not posed and attribute and attribute.HasAuthoredValue() and self._tells(attribute, name):
                yield found_samples(attribute, shutter)
        if self.posed_at01:
            yield FoundSamples(f"{path}.points", _codes(self.posed_at01, shutter), False)
        if self.animation:
            for name in _ANIMATION:
                attribute = self.animation.GetAttribute(name)
                if attribute and attribute.HasAuthoredValue():
                    yield found_samples(attribute, shutter)
        for visibility in self.blinking:
            yield found_samples(visibility, shutter)
        placed_by = prim if self.placed_by == self.prims[0] else self.placed_by
        yield from transform_samples_of(placed_by, self.root, shutter)
        for prototype, own in self.prototypes:
            yield from transform_samples_of(prototype, prototype.GetParent(), own)
        if len(self.evaluated_at01) > 1:
            codes = _codes(self.evaluated_at01, shutter)
            yield FoundSamples(f"{path}.{COMPOSED_TRANSFORM}", codes, False)

    def _tells(self, attribute: Usd.Attribute, name: str) -> bool:
        """Whether an attribute is worth a line: topology and sizes only where they may change."""
        if name in _TOPOLOGY or name == "protoIndices":
            return self.shutter.moving and might_vary(attribute)
        return name in _SHAPE[:5] + _INSTANCER + _RATES or might_vary(attribute)


class SampleLog:
    """Notes what is read of a frame; give one to read_frame()."""

    def __init__(self) -> None:
        self._shapes: dict[str, _Entry] = {}
        self._instances: dict[str, _Entry] = {}
        self._camera_path = ""
        self._camera: tuple[FoundSamples, ...] = ()

    def camera(self, optics: Iterable[Usd.Attribute], prim: Usd.Prim, shutter: Shutter, at01: Sequence[float]) -> None:
        """The render camera, evaluated at `at01`."""
        found = [found_samples(a, shutter) for a in optics if a.HasAuthoredValue() and might_vary(a)]
        found.extend(transform_samples_of(prim, None, shutter))
        if len(at01) > 1:
            path = f"{prim.GetPath()}.{COMPOSED_TRANSFORM}"
            found.append(FoundSamples(path, _codes(at01, shutter), False))
        self._camera = tuple(found)
        self._camera_path = str(prim.GetPath())

    def shape(
        self,
        prim: Usd.Prim,
        blinking: tuple[Usd.Attribute, ...],
        root: Usd.Prim | None,
        shutter: Shutter,
        placed_by: Usd.Prim,
        animation: Usd.Prim | None = None,
        posed_at01: Sequence[float] = (),
    ) -> None:
        """A mesh that moves in the space of `root` by the transform of `placed_by`; `blinking`: visibilities
        that change. `posed_at01` and `animation` where it is skinned."""
        names = (*_SHAPE, *_EXTENTS, *_TOPOLOGY)
        entry = _Entry((prim,), root, shutter, placed_by, names, animation, tuple(posed_at01), blinking)
        self._shapes[str(prim.GetPath())] = entry

    def instances(
        self,
        prims: Sequence[Usd.Prim],
        blinking: tuple[Usd.Attribute, ...],
        root: Usd.Prim | None,
        shutter: Shutter,
    ) -> None:
        """Native instances that move alike; the first gives its name to their track."""
        path = str(prims[0].GetPath())
        if path not in self._instances:
            self._instances[path] = _Entry(prims, root, shutter, prims[0], blinking=blinking)

    def instancer(
        self,
        prim: Usd.Prim,
        blinking: tuple[Usd.Attribute, ...],
        root: Usd.Prim | None,
        shutter: Shutter,
        prototypes: Sequence[tuple[Usd.Prim, Shutter]],
    ) -> None:
        """A point instancer, and the roots of its prototypes with the shutter that each has."""
        path = str(prim.GetPath())
        if path not in self._instances:
            entry = _Entry((prim,), root, shutter, prim, _INSTANCER + _RATES, blinking=blinking)
            entry.prototypes = tuple(prototypes)
            self._instances[path] = entry

    def inside(self, inner: str, outer: str) -> None:
        """Instances that were found inside of others and move with them."""
        if inner in self._instances and outer in self._instances and inner != outer:
            self._instances[inner].outer.add(outer)

    def evaluated_shape(self, path: str, times01: Sequence[float]) -> None:
        """Where the stage composed the transform of a mesh."""
        self._shapes[path].evaluated_at01 = tuple(times01)

    def evaluated_instances(self, path: str, levels: Sequence[InstanceLevel]) -> None:
        """The same of instances, by their levels."""
        times01 = {time for level in levels if level.times01 is not None for time in level.times01.tolist()}
        entry = self._instances.get(path)
        if entry is not None and len(times01) > len(entry.evaluated_at01):
            entry.evaluated_at01 = tuple(sorted(times01))

    def prims(self, path: str) -> Sequence[Usd.Prim]:
        """The prims that a track of this path stands for; none for what has not been noted."""
        for entries in (self._instances, self._shapes):
            if path in entries:
                return entries[path].prims
        return ()

    def samples(self, path: str, prim: Usd.Prim | None = None) -> list[FoundSamples]:
        """All that moves what has a track of this path, each attribute once; `prim`: of the prims that the
        track stands for."""
        if path == self._camera_path:
            return list(self._camera)
        found: dict[tuple[str, bool], FoundSamples] = {}
        pending, seen = [path], set()
        while pending:
            entries = [e for e in (self._shapes.get(pending[0]), self._instances.get(pending[0])) if e]
            seen.add(pending.pop(0))
            for entry in entries:
                for samples in entry.samples(prim if prim in entry.prims else entry.prims[0]):
                    found.setdefault((samples.attribute, samples.authored), samples)
                pending.extend(sorted(entry.outer - seen))
        return list(found.values())


def found_samples(attribute: Usd.Attribute, shutter: Shutter) -> FoundSamples:
    """The times of an attribute that bear on the shutter, or on the frame where that is closed."""
    path = str(attribute.GetPath())
    if attribute.HasSpline():
        knots = sorted(attribute.GetSpline().GetKnots().keys())
        return FoundSamples(path, _around(knots, shutter), False)
    if shutter.moving:
        return FoundSamples(path, tuple(bracketing_times(attribute, shutter)), True)
    around = () if shutter.frame is None else attribute.GetBracketingTimeSamples(shutter.frame)
    return FoundSamples(path, tuple(sorted(set(around))), True)


def transform_samples_of(prim: Usd.Prim, root: Usd.Prim | None, shutter: Shutter) -> Iterator[FoundSamples]:
    """The varying ops of a prim and of its ancestors below `root`, the prim's first."""
    while prim and not prim.IsPseudoRoot() and prim != root:
        xformable = UsdGeom.Xformable(prim)
        if xformable:
            paths = set()
            for op in ordered_ops(xformable):
                attribute = op.GetAttr()
                if op.MightBeTimeVarying() and attribute.GetPath() not in paths:
                    paths.add(attribute.GetPath())  # An op and its inverse share one.
                    yield found_samples(attribute, shutter)
            if resets(xformable):
                return
        prim = prim.GetParent()


def _around(times: Sequence[float], shutter: Shutter) -> tuple[float, ...]:
    """Those inside the shutter and the ones next to it."""
    if shutter.frame is None or not times:
        return ()
    opening, closing = shutter.frame + shutter.open, shutter.frame + shutter.close
    before = [time for time in times if time <= opening][-1:]
    after = [time for time in times if time >= closing][:1]
    return tuple(sorted({*before, *(time for time in times if opening < time < closing), *after}))


def _codes(times01: Sequence[float], shutter: Shutter) -> tuple[float, ...]:
    if shutter.frame is None:
        return ()
    return tuple(shutter.time_code(float(time01)).GetValue() for time01 in times01)
