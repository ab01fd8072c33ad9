"""Implicit shapes in crowds: a mesh for all that are alike and as large in the picture, placed by
instances."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from pxr import Usd

from .._core import (
    SHARED_FROM,
    InstanceLevel,
    MeshInput,
    PixelSize,
    Surface,
    TransformSamples,
    can_be_instances,
    implicit_surface,
    shapes_from_units,
)
from ..look.materials import Materials
from ..motion.boxes import Box
from ..motion.context import FrameContext
from ..motion.times import Shutter
from ..motion.transform_faults import report_unusable
from ..motion.transforms import Motion, XformCaches
from ..motion.visibility import common_intervals, visible_intervals
from .implicit import IMPLICIT_TYPES, SIDE_COUNTS, stray
from .instance_primvars import named_primvars
from .instances import Level, Placement, matrix_level
from .material_primvars import leave_undisplaced
from .part import Part
from .point_instancers import no_values
from .shape_sizes import sides_in_pixels
from .simple_shapes import Alike, Simple, SimpleShapes


@dataclass(frozen=True)
class Crowd:
    """Shapes that are alike and whose transforms may vary at the same times."""

    alike: Alike
    parts: list[Part]
    paths: list[str]
    """Of their prims."""
    shape_from_unit: np.ndarray
    """float64[N, 4, 4]."""
    root_from_unit: np.ndarray
    """float64[T, N, 4, 4] at a few times."""
    colours: np.ndarray | None
    """float32[N, 3]."""
    materials: np.ndarray | None
    """int32[N], negative for none."""
    shutter: Shutter
    """Of the shapes."""

    def some(self, chosen: np.ndarray) -> Crowd:
        """Those of int[M] numbers."""
        return Crowd(
            self.alike,
            [self.parts[index] for index in chosen.tolist()],
            [self.paths[index] for index in chosen.tolist()],
            self.shape_from_unit[chosen],
            self.root_from_unit[:, chosen],
            None if self.colours is None else self.colours[chosen],
            None if self.materials is None else self.materials[chosen],
            self.shutter,
        )


Measure = Callable[[Placement, Box], Iterator[tuple[list[InstanceLevel], np.ndarray]]]
"""The translator's levels of a placement of things in a box, and which of its instances they are."""


class SharedShapes:
    """Finds crowds among the shapes of groups, and hands them down."""

    def __init__(
        self,
        context: FrameContext,
        caches: XformCaches,
        materials: Materials,
        translator: Any,
        tolerance_pixels: float,
        silhouette_pixels: float,
    ) -> None:
        self._context = context
        self._caches = caches
        self._materials = materials
        self._translator = translator
        self._tolerance = tolerance_pixels
        self._silhouette = silhouette_pixels
        self._simple = SimpleShapes(context)
        self._prototypes: dict[tuple[Alike, int], int] = {}
        self._boxes: dict[Alike, Box] = {}

    def gather(self, parts: list[Part], root: Usd.Prim | None) -> tuple[list[Crowd], list[Part]]:
        """The crowds among the shapes of a group, and the shapes that stand for themselves."""
        implicit = [part for part in parts if part.prim.GetTypeName() in IMPLICIT_TYPES and not part.draw_mode]
        if len(implicit) < SHARED_FROM:
            return [], parts
        alike: dict[Alike, list[Simple]] = {}
        for simple in map(self._simple.read, implicit):
            if simple is not None:
                alike.setdefault(simple.alike, []).append(simple)
        crowds: list[Crowd] = []
        for each in alike.values():
            members = [simple for simple in each if not self._reads_its_own(simple)] if len(each) >= SHARED_FROM else []
            if len(members) >= SHARED_FROM:
                crowds.extend(self._crowds(members, root))
        shared = {id(part) for crowd in crowds for part in crowd.parts}
        return crowds, [part for part in parts if id(part) not in shared]

    def _reads_its_own(self, simple: Simple) -> bool:
        """Whether its material reads primvars that it has, so that it cannot share a mesh."""
        part = simple.part
        if not simple.binds or not (named_primvars(part.authored) or named_primvars(part.inherited)):
            return False
        return any(
            part.authors(f"primvars:{name}") for name, _ in self._materials.reads(self._materials.bound_to(part.prim))
        )

    def _crowds(self, members: list[Simple], root: Usd.Prim | None) -> Iterator[Crowd]:
        by_course: dict[Hashable, list[Simple]] = {}
        for simple in members:
            part = simple.part
            course = part.varying, part.breakpoints, part.scales, part.blinking, simple.colour is None
            by_course.setdefault(course, []).append(simple)
        for same in by_course.values():
            crowd = self._crowd(same, root)
            matrices = np.ascontiguousarray(crowd.root_from_unit)
            sound = can_be_instances(matrices, crowd.colours, crowd.alike.opacity)
            if sound.any():
                yield crowd if sound.all() else crowd.some(np.flatnonzero(sound))

    def _crowd(self, members: list[Simple], root: Usd.Prim | None) -> Crowd:
        parts = [simple.part for simple in members]
        shutter = self._context.shutter.scaled(parts[0].scales.blur)
        shape_from_unit = shapes_from_units([simple.form for simple in members])
        prims = [part.prim for part in parts]
        motion = self._caches.motion(prims, root, parts[0].varying, shutter, parts[0].breakpoints)
        root_from_shape = motion.at_times(motion.few_times01())
        colours = None
        if members[0].colour is not None:
            colours = np.array([simple.colour for simple in members], np.float32)
        paths = [prim.GetPath().pathString for prim in prims]
        materials, root_from_unit = self._material_numbers(members), shape_from_unit @ root_from_shape
        return Crowd(members[0].alike, parts, paths, shape_from_unit, root_from_unit, colours, materials, shutter)

    def _material_numbers(self, members: list[Simple]) -> np.ndarray | None:
        bound = [index for index, simple in enumerate(members) if simple.binds]
        if not bound:
            return None
        numbers = np.full(len(members), -1, np.int32)
        found = self._materials.bound_to_each([members[index].part.prim for index in bound])
        numbers[bound] = [-1 if material is None else material for material in found]
        for index, material in zip(bound, found, strict=True):
            if self._materials.displacement(material) is not None:
                leave_undisplaced(members[index].part.prim.GetPath().pathString, self._context)
        return numbers if (numbers >= 0).any() else None

    def extent(self, crowds: list[Crowd]) -> Box:
        """Around crowds in the space of their group, at a few times."""
        box = Box.empty()
        for crowd in crowds:
            corners = self._unit_box(crowd.alike).corners() @ crowd.root_from_unit[..., :3]
            box = box.union(Box.around(corners.reshape(-1, 3)))
        return box

    def add_to_world(self, crowds: list[Crowd], pixels: PixelSize) -> None:
        """Hands down crowds that stand in the world."""
        for crowd in crowds:
            self._note(crowd, None)
            visible = visible_intervals(crowd.parts[0].blinking, self._context.shutter)
            for prototype, sized in self._by_size(crowd, pixels):
                motion = self._motion(sized, None)
                box = self._unit_box(sized.alike)
                for samples in motion.samples([box], pixels, self._tolerance, self._context.held):
                    if samples.usable:
                        moved = sized.some(samples.indices)
                        self._add(moved, moved.paths[0], prototype, [matrix_level(samples)], visible)
                        continue
                    for index in samples.indices.tolist():
                        report_unusable(motion, index, self._context.diagnostics)

    def add_to_group(
        self, crowds: list[Crowd], root: Usd.Prim, pixels: PixelSize, placed: list[Placement], measure: Measure
    ) -> None:
        """Hands down the crowds of a group in each of its places."""
        for number, crowd in enumerate(crowds):
            self._note(crowd, root)
            own = visible_intervals(crowd.parts[0].blinking, self._context.shutter)
            for size, (prototype, sized) in enumerate(self._by_size(crowd, pixels)):
                box, level = self._unit_box(sized.alike), Level(self._motion(sized, root))
                for outer in placed:
                    visible = common_intervals(own, outer.visible)
                    chain = Placement(
                        outer.path, outer.key, (level, *outer.levels), visible, None, no_values, list, outer.place
                    )
                    for levels, indices in measure(chain, box):
                        inner = indices[: levels[0].matrices.shape[1]] % level.count
                        everywhere = _repeated(sized, inner, indices, outer)
                        # One report for what places the group: with the first thing in it.
                        whole = number == size == 0
                        self._add(everywhere, outer.path, prototype, levels, visible, sized.some(inner).paths, whole)

    def _note(self, crowd: Crowd, root: Usd.Prim | None) -> None:
        if self._context.found is not None:
            for part in crowd.parts:
                self._context.found.shape(part.prim, part.blinking, root, crowd.shutter, part.prim)

    def _by_size(self, crowd: Crowd, pixels: PixelSize) -> Iterator[tuple[int, Crowd]]:
        """Prototypes and the shapes that they are fine enough for."""
        kind, box = crowd.alike.kind, self._unit_box(crowd.alike)
        sides = np.zeros(len(crowd.parts), np.int32)
        if IMPLICIT_TYPES[kind].smooth:
            sides = sides_in_pixels(crowd.root_from_unit, kind, 1.0, box, pixels, self._silhouette)
        for count in np.unique(sides).tolist():
            chosen = np.flatnonzero(sides == count)
            sized = crowd if len(chosen) == len(sides) else crowd.some(chosen)
            yield self._prototype(crowd.alike, count, sized), sized

    def _prototype(self, alike: Alike, sides: int, crowd: Crowd) -> int:
        key = alike, sides
        if key not in self._prototypes:
            path = crowd.paths[0]
            self._prototypes[key] = self._translator.begin_prototype(path, 0.0)
            mesh = _mesh(path, _unit_surface(alike, sides), alike)
            mesh.stray = stray(alike.kind, 1.0, sides)
            self._translator.add_prototype_mesh(self._prototypes[key], mesh)
        return self._prototypes[key]

    def _unit_box(self, alike: Alike) -> Box:
        if alike not in self._boxes:
            self._boxes[alike] = Box.around(_unit_surface(alike, SIDE_COUNTS[0]).points)
        return self._boxes[alike]

    def _motion(self, crowd: Crowd, root: Usd.Prim | None) -> Motion:
        prims = [part.prim for part in crowd.parts]
        first, shutter, scaled = crowd.parts[0], crowd.shutter, crowd.shape_from_unit
        placed = self._caches.motion(prims, root, first.varying, shutter, first.breakpoints)
        if placed.still:
            return Motion(shutter, len(prims), True, lambda _: crowd.root_from_unit[0])

        def evaluate(time01: float) -> np.ndarray:
            return scaled @ self._caches.matrices(time01, prims, root, shutter)

        def evaluate_some(time01: float, indices: np.ndarray) -> np.ndarray:
            some = [prims[index] for index in indices.tolist()]
            return scaled[indices] @ self._caches.matrices(time01, some, root, shutter)

        moved = evaluate, placed.breakpoints01, evaluate_some, placed.carriers, placed.turns
        return Motion(shutter, len(prims), False, *moved)

    def _add(
        self,
        crowd: Crowd,
        path: str,
        prototype: int,
        levels: list[InstanceLevel],
        visible: np.ndarray | None,
        paths: list[str] | None = None,
        whole: bool = False,
    ) -> None:
        paths = crowd.paths if paths is None else paths
        found = self._context.found
        if found is not None:
            found.evaluated_instances(path, levels)
            for prim_path in paths:
                found.evaluated_shape(prim_path, levels[0].times01.tolist())
        self._translator.add_instances(
            path=path,
            prototype=prototype,
            levels=levels,
            visible=visible,
            display_color=crowd.colours,
            materials=crowd.materials,
            paths=paths,
            report_whole=whole,
        )


def _repeated(crowd: Crowd, inner: np.ndarray, indices: np.ndarray, outer: Placement) -> Crowd:
    """The colours and materials of instances of which those of the crowd are the innermost. An instancer's
    colours come before the shapes' own."""
    everywhere = crowd.some(np.tile(inner, len(indices) // len(inner)))
    colours = everywhere.colours
    if outer.display_color is not None:
        colours = np.ascontiguousarray(outer.display_color[indices // len(crowd.parts)])
    return replace(everywhere, colours=colours)


def _unit_surface(alike: Alike, sides: int) -> Surface:
    return implicit_surface(alike.kind, alike.parameters, sides)


def _mesh(path: str, surface: Surface, alike: Alike) -> MeshInput:
    mesh = MeshInput()
    mesh.path = path
    mesh.face_vertex_counts, mesh.face_vertex_indices = surface.counts, surface.indices
    mesh.points = [(0.0, surface.points.astype(np.float32))]
    mesh.transform = TransformSamples(np.zeros(1), np.eye(4)[None])
    mesh.computed_normals = IMPLICIT_TYPES[alike.kind].computed_normals
    if alike.opacity is not None:
        mesh.display_opacity = ("constant", np.array([alike.opacity], np.float32), None)
    return mesh
