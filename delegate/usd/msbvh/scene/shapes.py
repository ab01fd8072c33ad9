"""Meshes on their way from the stage to the translator: read, skinned, and moved together where they move alike."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from math import nan
from operator import itemgetter

import numpy as np
from pxr import Usd, UsdGeom

from .._core import MeshInput, PixelSize, TransformSamples, face_materials
from ..look.materials import Materials
from ..motion.boxes import Box
from ..motion.context import FrameContext
from ..motion.held_values import stretches
from ..motion.points import Samples
from ..motion.times import Shutter
from ..motion.transform_faults import report_unusable
from ..motion.transforms import XformCaches, may_move, transform_breakpoints
from ..motion.visibility import visible_intervals
from ..skel.bindings import SkelBinding, read_binding
from ..skel.skinning import Poser
from ..stage.usd_faults import FAULTS, report_left_out
from .implicit import ImplicitShape
from .material_primvars import add_material_primvars
from .meshes import Form, faces_by_subset, held_at, held_attributes, read_shape
from .nurbs_patch import NurbsShape, RefinedPatch
from .part import Part
from .round import reach_of
from .shape_sizes import sides_of
from .stand_ins import StandIn

BATCH_WEIGHT = 2**22
"""Points that are held in memory at once, for meshes that are evaluated together."""


_UNLIMITED = PixelSize.uniform(float("inf"))
"""Pixels so large that no motion is seen: for a first look at where things are."""

Course = tuple[bool, tuple[float, ...], Shutter]


@dataclass
class Draft:
    """A mesh that has been read, but for what depends on how large it is seen: the sides of an implicit shape, the poses
    of a skeleton."""

    part: Part
    context: FrameContext
    """With the prim's own shutter."""
    mesh: MeshInput
    form: Form
    """Its points at rest, or what has them and the topology."""
    binding: SkelBinding | None
    placed_by: Usd.Prim
    """Whose transform places it: itself, or its skeleton."""
    course: Course
    """Whether that may vary, where it may change its course, and over which shutter."""
    poser: Poser | None = None
    """Of a skinned mesh, once it has been posed: it remembers the poses."""


@dataclass
class Shape:
    """A mesh before its transform is sampled. Never changed once it is made."""

    part: Part
    mesh: MeshInput
    """All but the transform and the material."""
    samples: Samples
    """Its points."""
    placed_by: Usd.Prim
    """Whose transform places it: itself, or its skeleton."""
    course: Course
    """Whether that may vary, where it may change its course, and over which shutter."""
    patch: RefinedPatch | None = None
    """What its primvars are still to be refined by."""

    @cached_property
    def box(self) -> Box:
        """Around what is drawn over the shutter, in its own space."""
        box = self.samples.box()
        return box.grown(reach_of(self.mesh)) if self.part.is_round else box

    def weight(self) -> int:
        """Points in all samples, and a thousand for the prim itself."""
        return 1000 + sum(len(points) for _, points in self.samples.values)


class Shapes:
    """Reads the meshes of one frame and hands them down."""

    def __init__(
        self,
        context: FrameContext,
        caches: XformCaches,
        materials: Materials,
        tolerance_pixels: float,
        silhouette_pixels: float,
        edge_pixels: float,
    ) -> None:
        self._context = context
        self._caches = caches
        self._materials = materials
        self._tolerance = tolerance_pixels
        self._silhouette = silhouette_pixels
        self._edge = edge_pixels

    def read(self, part: Part, root: Usd.Prim | None) -> Draft | None:
        """A mesh and how it moves; None if it is not drawn."""
        try:
            return self._read(part, root)
        except FAULTS as error:
            report_left_out(part.prim, error, self._context.code)
            return None

    def _read(self, part: Part, root: Usd.Prim | None) -> Draft | None:
        context = self._context.scaled(part.scales.blur)
        read = read_shape(part, context)
        if read is None:
            return None
        mesh, form = read
        if part.blinking:
            mesh.visible = visible_intervals(part.blinking, self._context.shutter)
        binding = None if part.draw_mode else read_binding(part.prim, context, part.authored)
        placed_by, course = part.prim, (part.varying, part.breakpoints, context.shutter)
        if binding is not None and binding.placed_by != part.prim:
            placed_by = binding.placed_by
            breakpoints = tuple(transform_breakpoints(placed_by, root, context.shutter))
            course = may_move(placed_by, root), breakpoints, context.shutter
        return Draft(part, context, mesh, form, binding, placed_by, course)

    def shape(self, draft: Draft, root: Usd.Prim | None, pixel_size: PixelSize) -> Shape | None:
        """As fine as its size in pixels asks for; None if it is not drawn."""
        try:
            return self._shape(draft, root, pixel_size)
        except FAULTS as error:
            report_left_out(draft.part.prim, error, self._context.code)
            return None

    def _shape(self, draft: Draft, root: Usd.Prim | None, pixel_size: PixelSize) -> Shape | None:
        part, mesh, form = draft.part, draft.mesh, draft.form
        if isinstance(form, ImplicitShape):
            mesh = mesh.copy()
            matrices = self._few_matrices(draft, root)
            samples = form.fill(mesh, sides_of(form, matrices, pixel_size, self._silhouette))
        elif isinstance(form, StandIn):
            mesh = mesh.copy()
            samples = form.fill(mesh, self._few_matrices(draft, root), pixel_size)
        else:
            samples = form.controls if isinstance(form, NurbsShape) else form
        posed_at: list[float] = []
        if draft.binding is not None:
            poser = draft.poser or Poser(draft.binding, mesh, samples, draft.context)
            if part.is_mesh or part.is_round:
                mesh, draft.poser = mesh.copy(), poser
            placed = self._caches.motion([draft.placed_by], root, True, draft.context.shutter)
            skinned = poser.skinned(placed, pixel_size, self._tolerance)
            if skinned is None:
                return None
            samples = skinned.samples
            mesh.normals, mesh.normals_indices = skinned.normals, None
            mesh.velocities = mesh.accelerations = None
            mesh.computed_points = True
            if isinstance(form, ImplicitShape):
                mesh.stray = nan
            posed_at = [time01 for time01, _ in samples.values if time01 is not None]
        patch = None
        if isinstance(form, NurbsShape):
            mesh, matrices = mesh.copy(), self._few_matrices(draft, root)
            samples, patch = form.refined(mesh, samples, matrices, pixel_size, self._edge)
        if draft.context.found is not None:
            moved_by = draft.binding.moved_by if draft.binding is not None else None
            own = part.prim, part.blinking, root, draft.context.shutter
            draft.context.found.shape(*own, draft.placed_by, moved_by, posed_at)
        mesh.points, mesh.points_held = samples.values, samples.held
        return Shape(part, mesh, samples, draft.placed_by, draft.course, patch)

    def extent(self, draft: Draft, root: Usd.Prim | None) -> Box | None:
        """Around the points in the space of the group, at a few times; None if it is not drawn."""
        if draft.binding is None and not isinstance(draft.form, Samples):
            box = draft.form.box
        else:
            shape = self.shape(draft, root, _UNLIMITED)
            if shape is None:
                return None
            box = shape.box
        varying, breakpoints, shutter = draft.course
        motion = self._caches.motion([draft.placed_by], root, varying, shutter, breakpoints)
        matrices = motion.at_times(motion.few_times01())[:, 0]
        return Box.around(np.concatenate([box.corners() @ matrix[:, :3] for matrix in matrices]))

    def hand_down(
        self, shapes: list[Shape], root: Usd.Prim | None, pixel_size: PixelSize, add: Callable[[MeshInput], None]
    ) -> None:
        """Hands meshes to the translator with their transforms over the shutter, in their order."""
        held = self._context.held
        alike: dict[Course, list[int]] = {}
        for index, shape in enumerate(shapes):
            alike.setdefault(shape.course, []).append(index)
        moved: dict[int, TransformSamples] = {}
        for (varying, breakpoints, shutter), same in alike.items():
            prims = [shapes[index].placed_by for index in same]
            motion = self._caches.motion(prims, root, varying, shutter, breakpoints)
            boxes = [] if motion.still else [shapes[index].box for index in same]
            for samples in motion.samples(boxes, pixel_size, self._tolerance, held):
                for place, index in enumerate(samples.indices.tolist()):
                    if samples.usable:
                        moved[same[index]] = samples.of(place)
                    else:
                        report_unusable(motion, index, self._context.diagnostics)
        for index, transform in sorted(moved.items(), key=itemgetter(0)):
            for mesh, context in self._stretches(shapes[index]):
                mesh.transform = transform
                self._add_shape(shapes[index], mesh, add, context)

    def _stretches(self, shape: Shape) -> Iterator[tuple[MeshInput, FrameContext]]:
        """A mesh, once for each part of the shutter over which its faces are the same; with the context to read them
        in."""
        part, context = shape.part, self._context.scaled(shape.part.scales.blur)
        held = held_attributes(part, shape.mesh, context)
        if not held:
            yield shape.mesh, context
            return
        for stretch in stretches(held, context.shutter, context.diagnostics):
            yield held_at(part, shape.mesh, stretch, context), context.at(stretch.code)

    def _add_shape(
        self, shape: Shape, mesh: MeshInput, add: Callable[[MeshInput], None], context: FrameContext
    ) -> None:
        """With the materials of the subsets of `context`."""
        part = shape.part
        if self._context.found is not None:
            self._context.found.evaluated_shape(mesh.path, mesh.transform.times01.tolist())
        mesh.material = self._materials.bound_to(part.prim) if part.binds_material and not part.draw_mode else None
        if shape.patch is not None:
            shape.patch.set_primvars(mesh)
        elif part.is_mesh and part.has_children:
            mesh.face_materials = self._face_materials(UsdGeom.Imageable(part.prim), mesh, context)
        instead = "" if part.is_mesh else "curves and points" if part.is_round else "an implicit shape"
        if shape.patch is not None:
            instead = "a NURBS patch"
        if (
            mesh.material is not None
            or mesh.face_materials is not None
            or mesh.round == "curves"
            or self._materials.kept
        ):
            add_material_primvars(mesh, part, instead, self._materials, context)
            if shape.patch is not None:
                shape.patch.set_named_primvars(mesh)
        add(mesh)

    def _face_materials(self, prim: UsdGeom.Imageable, mesh: MeshInput, context: FrameContext) -> np.ndarray | None:
        """int32: one a face, negative for none; None where no subset has a material of its own."""
        subsets, owners = faces_by_subset(prim, len(mesh.face_vertex_counts), context)
        if not subsets:
            return None
        return face_materials(owners, [self._materials.bound_to(subset) for subset in subsets], mesh.material)

    def _few_matrices(self, draft: Draft, root: Usd.Prim | None) -> np.ndarray:
        """float64[T, 4, 4]: where a shape is, at a few times."""
        varying, breakpoints, shutter = draft.course
        motion = self._caches.motion([draft.placed_by], root, varying, shutter, breakpoints)
        return np.ascontiguousarray(motion.at_times(motion.few_times01())[:, 0])
