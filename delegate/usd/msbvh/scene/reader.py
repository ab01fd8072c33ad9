"""Reads one frame of a stage into a scene that the renderer draws."""

from __future__ import annotations

import gc
import time
from collections.abc import Callable, Hashable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np
from pxr import Tf, Usd, UsdGeom

from .._core import EDGE_LENGTHS, MOST_PLACES, SILHOUETTES, InstanceLevel, MeshInput, PixelSize, RefinementCache
from ..base.crash_line import crash_line
from ..base.errors import Diagnostics, SceneError
from ..camera.render_camera import Blur, RenderCamera, optics, read_camera
from ..look.lights import camera_light
from ..look.materials import Materials
from ..motion.boxes import Box
from ..motion.context import FrameContext
from ..motion.motion_scales import scales_at
from ..motion.samples import SampleLog
from ..motion.times import is_held
from ..motion.transforms import XformCaches
from ..stage.opening import tf_messages, tf_reason
from ..stage.overs import report_overs
from ..stage.rendering_space import rendered_in
from ..stage.values import reported_to
from .coarser_tracks import CoarserTracks, coarser_tracks
from .frame_lights import FrameLights
from .instance_count import InstanceGraph
from .instances import Placement, Placer, coarse_level, sampled_levels
from .part import Part
from .point_instancers import each, taken
from .primvars import PrimvarInput
from .read_settings import DEFAULTS
from .read_settings import MAX_INSTANCES as MAX_INSTANCES
from .read_settings import ReadSettings as ReadSettings
from .shapes import BATCH_WEIGHT, Draft, Shape, Shapes
from .shared_shapes import Crowd, SharedShapes
from .traversal import WORLD, Group, Traversal


@dataclass
class ReadResult:
    """A frame, read."""

    scene: Any
    """msbvh._core.Scene."""
    camera: RenderCamera
    diagnostics: Diagnostics
    tracks: list
    """msbvh._core.TrackReport of every mesh and instance."""
    seconds: dict[str, float] = field(default_factory=dict)
    """Wall-clock time of each part of the reading."""
    left_out: list = field(default_factory=list)
    """msbvh._core.LeftOut of each prim that no ray can reach."""
    settings: ReadSettings = DEFAULTS
    """By which it was read."""

    @property
    def coarser_tracks(self) -> CoarserTracks:
        """Of what moves outside of the picture."""
        return coarser_tracks(self.tracks)


def read_frame(
    stage: Usd.Stage,
    frame: float | None,
    settings: ReadSettings = DEFAULTS,
    diagnostics: Diagnostics | None = None,
    make_translator: Callable[..., Any] | None = None,
    *,
    progress: Callable[[float], object] | None = None,
    found: SampleLog | None = None,
    refinements: RefinementCache | None = None,
) -> ReadResult:
    """Reads what is visible at a frame, and its motion over the camera's shutter.

    `frame` is a time code; None: USD's default time, without blur. `make_translator` stands in for
    msbvh._core.Translator in tests. `progress` is called with the finished share in [0, 1], after each mesh
    and after each prototype's instances; `found` notes which samples moved what; `refinements` keeps
    subdivided cages from frame to frame. Raises SceneError where there is nothing that could be rendered through this
    camera; whatever else is wrong or unsupported leaves a diagnostic, and the rest is read.
    """
    diagnostics = Diagnostics() if diagnostics is None else diagnostics
    make_translator = make_translator or partial(_core_translator, refinements)
    where = stage.GetRootLayer().realPath or stage.GetRootLayer().identifier
    # What is not finite is looked for where it matters.
    space, quiet = rendered_in(settings.rendering_space), np.errstate(over="ignore", invalid="ignore", divide="ignore")
    with crash_line(where), reported_to(diagnostics), tf_messages(diagnostics), space, _no_collection(), quiet:
        try:
            return _FrameReader(stage, frame, settings, diagnostics, make_translator, progress, found).read()
        except (Tf.ErrorException, UnicodeDecodeError) as error:
            raise SceneError(f"{where}: cannot be read as USD: {tf_reason(error)}") from error


@contextmanager
def _no_collection() -> Iterator[None]:
    """Python's collector looks through all that a stage of a hundred thousand prims makes, again and again, and
    finds no cycles: a third of the time."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()


def _core_translator(refinements: RefinementCache | None, **settings: Any) -> Any:
    from .. import _core

    try:
        return _core.Translator(**settings, refinements=refinements)
    except _core.Error as error:
        raise SceneError(str(error)) from None


class _FrameReader:
    """The steps of reading a frame, in their order."""

    def __init__(
        self,
        stage: Usd.Stage,
        frame: float | None,
        settings: ReadSettings,
        diagnostics: Diagnostics,
        make_translator: Callable[..., Any],
        progress: Callable[[float], object] | None,
        found: SampleLog | None,
    ) -> None:
        self._settings = settings
        self._seconds: dict[str, float] = {}
        with self._timed("traverse"):
            purposes = list(settings.purposes)
            self._camera = read_camera(
                stage,
                frame,
                settings.camera,
                settings.picture,
                purposes,
                diagnostics,
                Blur(settings.shutter, settings.motion_blur, settings.depth_of_field),
            )
            shutter = self._camera.shutter
            drawn = ("default", *purposes)
            self._context = FrameContext(
                stage, shutter, is_held(stage), diagnostics, drawn, found, settings.material_purpose
            )
            self._traversal = Traversal(self._context, not settings.disable_draw_modes)
            self._graph = InstanceGraph(self._traversal.groups, self._context)
            self._graph.check(settings.max_instances)
            self._caches = XformCaches(shutter)
        self._pixel = self._camera.pixel_size()
        self._translator = make_translator(**self._translator_settings())
        self._materials = materials = Materials(self._translator, self._context, ("st",) if settings.keep_st else ())
        silhouette = SILHOUETTES[settings.complexity]
        tolerance, edge = settings.motion_tolerance, self._edge_length
        self._shapes = Shapes(self._context, self._caches, materials, tolerance, silhouette, edge)
        self._shared = SharedShapes(
            self._context, self._caches, materials, self._translator, settings.motion_tolerance, silhouette
        )
        self._lights = FrameLights(self._traversal, self._caches, self._context, self._translator)
        self._linked = self._lights.links().any
        self._progress, self._steps_done = progress, 0
        self._steps = sum(len(group.shapes) + 1 for group in self._traversal.groups.values())
        if found is not None and self._camera.path:
            self._note_camera(found)

    def read(self) -> ReadResult:
        """Hands everything down and finishes the scene."""
        with self._timed("meshes"):
            self._add_world_meshes()
        placements = list(Placer(self._traversal, self._graph, self._caches, self._context).placements())
        with self._timed("instances"):
            self._add_instanced(placements[1:])
        with self._timed("lights"):
            self._add_lights(placements)
        with self._timed("finish"):
            result = self._finish()
        if self._progress is not None:
            self._progress(1.0)
        return result

    def _step(self, count: int = 1) -> None:
        """Meshes are done, or a prototype's instances are."""
        self._steps_done += count
        if self._progress is not None:
            self._progress(min(self._steps_done / self._steps, 1.0))

    def _note_camera(self, found: SampleLog) -> None:
        prim = self._context.stage.GetPrimAtPath(self._camera.path)
        scales = scales_at(prim, self._context.shutter, Diagnostics())
        shutter = self._context.shutter.scaled(scales.blur)
        found.camera(optics(UsdGeom.Camera(prim)), prim, shutter, self._camera.times01.tolist())

    @contextmanager
    def _timed(self, step: str) -> Iterator[None]:
        start = time.perf_counter()
        yield
        self._seconds[step] = time.perf_counter() - start

    def _translator_settings(self) -> dict[str, Any]:
        camera, settings = self._camera, self._settings
        return {
            "path": camera.path or "framing camera",
            "projection": camera.projection,
            "times01": camera.times01,
            "world_from_camera": camera.world_from_camera,
            "windows": camera.windows,
            "breakpoints01": camera.breakpoints01,
            "periods01": camera.periods01,
            "lenses": camera.lenses,
            "near_clip": camera.near_clip,
            "far_clip": camera.far_clip,
            "clips": camera.clips,
            "clipping_planes": camera.clipping_planes,
            "width": camera.width,
            "height": camera.height,
            "motion_tolerance": settings.motion_tolerance,
            "outside_tolerance": settings.outside_tolerance,
            "max_segments": settings.max_segments,
            "interpolation": settings.interpolation,
            "segments": settings.segments,
            "keep_faces": settings.keep_faces,
            "measure_shape": settings.measure_shape,
            "max_bounces": settings.max_bounces,
            "edge_length": self._edge_length,
            "displacement": settings.displacement,
            "displaced_triangle_bytes": settings.displaced_triangle_bytes,
            "curves": settings.curves,
        }

    @property
    def _edge_length(self) -> float:
        given = self._settings.edge_length
        return EDGE_LENGTHS[self._settings.complexity] if given is None else given

    def _add_world_meshes(self) -> None:
        """Meshes by the hundred, so that those that move alike are evaluated together."""
        crowds, parts = self._gathered(self._traversal.groups[WORLD].shapes, None)
        self._shared.add_to_world(crowds, self._pixel)
        self._step(sum(len(crowd.parts) for crowd in crowds))
        batch: list[Shape] = []
        weight = 0
        for part in parts:
            draft = self._shapes.read(part, None)
            shape = self._shapes.shape(draft, None, self._pixel) if draft else None
            if shape is not None:
                batch.append(shape)
                weight += shape.weight()
            self._step()
            if weight > BATCH_WEIGHT:
                self._shapes.hand_down(batch, None, self._pixel, self._translator.add_mesh)
                batch, weight = [], 0
        self._shapes.hand_down(batch, None, self._pixel, self._translator.add_mesh)

    def _add_instanced(self, placements: list[Placement]) -> None:
        """Every group once, and every place where it stands."""
        by_group: dict[Hashable, list[Placement]] = {}
        for placement in placements:
            by_group.setdefault(placement.key, []).append(placement)
        for key, placed in by_group.items():
            group = self._traversal.groups[key]
            if group.shapes:
                self._add_group(group, placed)

    def _add_group(self, group: Group, placed: list[Placement]) -> None:
        """A prototype's meshes, followed as closely as the instance asks for that is seen largest."""
        # How large a pixel is depends on the instances, and where they are on the meshes' extent.
        crowds, parts = self._crowds(group, placed)
        drafts: list[Draft] = []
        box = self._shared.extent(crowds)
        for part in parts:
            draft = self._shapes.read(part, group.root)
            extent = self._shapes.extent(draft, group.root) if draft else None
            if draft is not None and extent is not None:
                drafts.append(draft)
                box = box.union(extent)
        pixels_per_unit = max(self._pixels_per_unit(placement, box) for placement in placed)
        pixel = PixelSize.uniform(1.0 / max(pixels_per_unit, 1e-30))
        self._shared.add_to_group(crowds, group.root, pixel, placed, self._levels)
        self._step(sum(len(crowd.parts) for crowd in crowds))
        if parts:
            self._add_prototype(group, placed, drafts, pixel, box)
            self._step(len(parts))
        self._step()

    def _crowds(self, group: Group, placed: list[Placement]) -> tuple[list[Crowd], list[Part]]:
        """Of a group that stands in few places."""
        if sum(placement.count for placement in placed) > MOST_PLACES:
            return [], group.shapes
        return self._gathered(group.shapes, group.root)

    def _gathered(self, parts: list[Part], root: Usd.Prim | None) -> tuple[list[Crowd], list[Part]]:
        """None where links may tell shapes apart that are alike."""
        return ([], parts) if self._linked else self._shared.gather(parts, root)

    def _add_prototype(
        self, group: Group, placed: list[Placement], drafts: list[Draft], pixel: PixelSize, box: Box
    ) -> None:
        prototype = self._translator.begin_prototype(group.path, 1.0 / pixel.per_unit)

        def add(mesh: MeshInput) -> None:
            self._translator.add_prototype_mesh(prototype, mesh)

        shapes = [shape for draft in drafts if (shape := self._shapes.shape(draft, group.root, pixel))]
        self._shapes.hand_down(shapes, group.root, pixel, add)
        for placement in placed:
            self._add_instances(placement, prototype, box)

    def _pixels_per_unit(self, placement: Placement, box: Box) -> float:
        return self._measure([coarse_level(level) for level in placement.levels], box)

    def _measure(self, levels: list[InstanceLevel], box: Box) -> float:
        if (box.lo > box.hi).any():
            return 0.0
        return self._translator.pixels_per_unit(levels=levels, box=np.array([box.lo, box.hi], np.float64))

    def _levels(self, placement: Placement, box: Box) -> Iterator[tuple[list[InstanceLevel], np.ndarray]]:
        tolerance, held = self._settings.motion_tolerance, self._context.held
        return sampled_levels(placement, box, self._measure, tolerance, held, self._context.diagnostics)

    def _add_instances(self, placement: Placement, prototype: int, box: Box) -> None:
        for levels, indices in self._levels(placement, box):
            colour = placement.display_color
            if colour is not None:
                colour = each(colour, partial(taken, indices))
            opacity = placement.values("displayOpacity")
            if self._context.found is not None:
                self._context.found.evaluated_instances(placement.path, levels)
            self._translator.add_instances(
                path=placement.path,
                prototype=prototype,
                levels=levels,
                visible=placement.visible,
                display_color=colour,
                display_opacity=None if opacity is None else taken(indices, opacity[:, 0]),
                primvars=self._instance_primvars(placement, indices),
                ids=indices.astype(np.int32),
            )

    def _instance_primvars(self, placement: Placement, indices: np.ndarray) -> dict[str, PrimvarInput] | None:
        """What materials read, where the instances have values of their own."""
        found = {name: placement.values(name) for name in self._materials.read_primvars}
        return {
            name: ("vertex", taken(indices, each), None) for name, each in found.items() if each is not None
        } or None

    def _add_lights(self, placements: list[Placement]) -> None:
        if self._lights.add(placements) == 0 and not self._settings.disable_camera_light:
            self._translator.add_light(**camera_light(self._camera.times01, self._camera.world_from_camera))

    def _finish(self) -> ReadResult:
        diagnostics = self._context.diagnostics
        empty, scene = self._translator.empty, self._translator.finish()
        diagnostics.take(self._translator.diagnostics())
        if empty:
            diagnostics.warning(
                "", "", "nothing to draw: no visible meshes or instances at this frame; the image is empty"
            )
            report_overs(self._context.stage, diagnostics)
        tracks = self._translator.tracks()
        return ReadResult(
            scene, self._camera, diagnostics, tracks, self._seconds, self._translator.left_out(), self._settings
        )
