"""Meshes on their way from the stage to the translator: read, skinned, and moved together where they move alike."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from operator import itemgetter

import numpy as np
from pxr import Usd, UsdGeom

from ..look.materials import Materials
from ..motion.boxes import Box, Pixels
from ..motion.context import FrameContext
from ..motion.held_values import stretches
from ..motion.points import Samples
from ..motion.times import Shutter
from ..motion.transform_faults import report_unusable
from ..motion.transform_sampling import SAMPLING_SHARE, TransformSamples, transform_samples
from ..motion.transforms import XformCaches, may_move, transform_breakpoints
from ..motion.visibility import visible_intervals
from ..skel.skinning import read_skinning
from ..stage.inherited import Inherited
from ..stage.usd_faults import FAULTS, report_left_out
from .implicit import ChooseSides
from .meshes import faces_by_subset, held_at, held_attributes, read_shape
from .shape_sizes import side_chooser
from .traversal import Part

BATCH_WEIGHT = 2**22
"""Points that are held in memory at once, for meshes that are evaluated together."""


Course = tuple[bool, tuple[float, ...], Shutter]


@dataclass(frozen=True)
class Shape:
    """A mesh as it was read, before its transform is sampled."""

    part: Part
    mesh: dict
    """The translator's keywords, all but the transform and the material."""
    samples: Samples
    """Its points."""
    placed_by: Usd.Prim
    """Whose transform places it: itself, or its skeleton."""
    course: Course
    """Whether that may vary, where it may change its course, and over which shutter."""

    @cached_property
    def box(self) -> Box:
        """Around its points over the shutter, in their own space."""
        return self.samples.box()

    def weight(self) -> int:
        """Points in all samples, and a thousand for the prim itself."""
        return 1000 + sum(len(points) for _, points in self.mesh["points"])

    def extent(self, caches: XformCaches, root: Usd.Prim | None) -> Box:
        """Around the points in the space of the group, at a few times."""
        varying, breakpoints, shutter = self.course
        motion = caches.motion([self.placed_by], root, varying, shutter, breakpoints)
        matrices = motion.at_times(motion.few_times01())[:, 0]
        return Box.around(np.concatenate([self.box.corners() @ matrix[:, :3] for matrix in matrices]))


class Shapes:
    """Reads the meshes of one frame and hands them down."""

    def __init__(
        self,
        context: FrameContext,
        caches: XformCaches,
        materials: Materials,
        tolerance_pixels: float,
        silhouette_pixels: float,
    ) -> None:
        self._context = context
        self._caches = caches
        self._materials = materials
        self._tolerance = tolerance_pixels
        self._silhouette = silhouette_pixels

    def read(self, part: Part, root: Usd.Prim | None, pixel_sizes: Pixels) -> Shape | None:
        """A mesh and how it moves; None if it is not drawn."""
        try:
            return self._read(part, root, pixel_sizes)
        except FAULTS as error:
            report_left_out(part.prim, error, self._context.code)
            return None

    def _read(self, part: Part, root: Usd.Prim | None, pixel_sizes: Pixels) -> Shape | None:
        context = self._context.scaled(part.scales.blur)
        choose_sides = self._side_chooser(part, root, context, pixel_sizes)
        mesh = read_shape(part.prim, context, part.scales.velocity, part.authored, choose_sides)
        if mesh is None:
            return None
        placed_by, varying, breakpoints = part.prim, part.varying, part.breakpoints
        tolerance = self._skinning_tolerance(root, context, pixel_sizes)
        skinned = read_skinning(part.prim, mesh, context, tolerance, part.authored)
        samples = mesh.pop("samples")
        if skinned is not None:
            if skinned.samples is None:
                return None
            samples, placed_by = skinned.samples, skinned.placed_by
            if placed_by != part.prim:
                varying = may_move(placed_by, root)
                breakpoints = tuple(transform_breakpoints(placed_by, root, context.shutter))
            mesh.update(normals=skinned.normals, normals_indices=None, computed_points=True)
            for name in ("velocities", "accelerations"):
                mesh.pop(name, None)
        if context.found is not None:
            animation, posed = (skinned.animation, samples.values) if skinned is not None else (None, ())
            times01 = [time01 for time01, _ in posed]
            own = part.prim, part.blinking, root, context.shutter
            context.found.shape(*own, placed_by, animation, times01)
        mesh["visible"] = visible_intervals(part.blinking, self._context.shutter)
        mesh.update(points=samples.values, points_held=samples.held)
        return Shape(part, mesh, samples, placed_by, (varying, breakpoints, context.shutter))

    def hand_down(
        self, shapes: list[Shape], root: Usd.Prim | None, pixel_sizes: Pixels, add: Callable[..., None]
    ) -> None:
        """Hands meshes to the translator with their transforms over the shutter, in their order."""
        held = self._context.held
        alike: dict[Course, list[int]] = {}
        for index, shape in enumerate(shapes):
            alike.setdefault(shape.course, []).append(index)
        moved: dict[int, tuple[TransformSamples, int]] = {}
        for (varying, breakpoints, shutter), same in alike.items():
            prims = [shapes[index].placed_by for index in same]
            motion = self._caches.motion(prims, root, varying, shutter, breakpoints)
            boxes = [] if motion.still else [shapes[index].box for index in same]
            for samples in transform_samples(motion, boxes, pixel_sizes, self._tolerance, held):
                for place, index in enumerate(samples.indices.tolist()):
                    if samples.usable:
                        moved[same[index]] = samples, place
                    else:
                        report_unusable(motion, index, self._context.diagnostics)
        for index, (samples, place) in sorted(moved.items(), key=itemgetter(0)):
            for part, context in self._stretches(shapes[index]):
                self._add_shape(part, samples, place, add, context)

    def _stretches(self, shape: Shape) -> Iterator[tuple[Shape, FrameContext]]:
        """A mesh, once for each part of the shutter over which its faces are the same; with the context to read them
        in."""
        prim, context = shape.part.prim, self._context.scaled(shape.part.scales.blur)
        held = held_attributes(prim, shape.mesh, shape.part.authored, context)
        if not held:
            yield shape, context
            return
        for stretch in stretches(held, context.shutter, context.diagnostics):
            yield replace(shape, mesh=held_at(prim, shape.mesh, stretch, context)), context.at(stretch.code)

    def _add_shape(
        self,
        shape: Shape,
        transform: TransformSamples,
        place: int,
        add: Callable[..., None],
        context: FrameContext,
    ) -> None:
        """With the materials of the subsets of `context`. Its matrices are number `place` of the samples'."""
        if self._context.found is not None:
            self._context.found.evaluated_shape(shape.mesh["path"], transform.times01.tolist())
        mesh = {
            **shape.mesh,
            "transform_times01": transform.times01,
            "transforms": np.ascontiguousarray(transform.matrices[:, place]),
            "transform_breakpoints01": transform.breakpoints01,
            "transforms_held": transform.held,
            "transform_error_pixels": transform.error_pixels,
        }
        if transform.periods01 and transform.periods01[place]:
            mesh["transform_periods01"] = np.array(transform.periods01[place])
        prim = shape.part.prim
        binds = self._context.cache(Inherited).binds_material(prim, shape.part.authored)
        material = self._materials.bound_to(prim) if binds else None
        if prim.IsA(UsdGeom.Mesh):
            mesh["face_materials"] = self._face_materials(UsdGeom.Mesh(prim), mesh, material, context)
        add(material=material, **mesh)

    def _face_materials(
        self, prim: UsdGeom.Mesh, mesh: dict, own: int | None, context: FrameContext
    ) -> np.ndarray | None:
        """int32: one a face, negative for none; None where no subset has a material of its own."""
        subsets, owners = faces_by_subset(prim, len(mesh["face_vertex_counts"]), context)
        if not subsets:
            return None
        bound = [self._materials.bound_to(subset) for subset in subsets]
        numbers = np.array([-1 if material is None else material for material in (*bound, own)], np.int32)
        return numbers[owners]  # Number -1, of the faces of no subset, is the last: the mesh's own.

    def _side_chooser(
        self, part: Part, root: Usd.Prim | None, context: FrameContext, pixel_sizes: Pixels
    ) -> ChooseSides:
        """Of an implicit shape, by its size in pixels."""

        def matrices() -> np.ndarray:
            motion = self._caches.motion([part.prim], root, part.varying, context.shutter, part.breakpoints)
            return motion.at_times(motion.few_times01())[:, 0]

        return side_chooser(matrices, part.prim.GetTypeName() == "Sphere", pixel_sizes, self._silhouette)

    def _skinning_tolerance(
        self, root: Usd.Prim | None, context: FrameContext, pixel_sizes: Pixels
    ) -> Callable[[Usd.Prim, Box], float]:
        """How far skinned points may stray between samples: a share of the tolerance, the rest of which the
        track has."""

        def tolerance(placed_by: Usd.Prim, box: Box) -> float:
            motion = self._caches.motion([placed_by], root, True, context.shutter)
            matrices = motion.at_times(motion.few_times01())[:, 0]
            stretch = np.linalg.norm(matrices[:, :3, :3], ord=2, axis=(1, 2)).max()
            corners = (box.corners() @ matrices[..., :3])[:, None]
            share = SAMPLING_SHARE * self._tolerance
            return share * float(pixel_sizes(corners)[0]) / max(stretch, 1e-30)

        return tolerance
