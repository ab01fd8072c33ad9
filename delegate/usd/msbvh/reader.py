"""Reads one frame of a stage into a scene that the renderer draws."""

from __future__ import annotations

import gc
import time
from collections.abc import Callable, Hashable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from pxr import Usd, UsdGeom

from .boxes import Box
from .camera import RenderCamera, optics, read_camera
from .context import FrameContext
from .errors import Diagnostics, SceneError
from .instance_count import InstanceGraph
from .instances import Placement, Placer, coarse_keywords, level_keywords
from .light_values import Switches
from .lights import add_lights, camera_light
from .materials import Materials
from .motion_scales import scales_at
from .point_instancers import each
from .samples import SampleLog
from .shapes import BATCH_WEIGHT, Shape, Shapes
from .stage import tf_messages
from .times import is_held
from .transforms import XformCaches
from .traversal import WORLD, Group, Traversal


MAX_INSTANCES = 10_000_000
"""While they are read and their tree is built, instances take 0.8 kB each, moving ones 1 kB: these fit in 10 GB."""


@dataclass(frozen=True)
class ReadSettings:
    """What is read. Names and defaults are usdrecord's where it has them."""

    camera: str | None = None
    """Path or name; None: the primary or first camera, or one that frames the stage."""
    width: int = 960
    height: int | None = None
    """Pixels; None: from the camera's aspect ratio."""
    conform: str = "expandAperture"
    """UsdRenderSettings' aspectRatioConformPolicy."""
    purposes: tuple[str, ...] = ("proxy",)
    """Drawn beside the default purpose."""
    disable_camera_light: bool = False
    motion_tolerance: float = 0.1
    """Pixels by which a moving point may stray from the stage's own evaluation. Less: more keys, more memory.
    """
    max_segments: int = 128
    interpolation: str = "auto"
    """linear, quadratic or cubic tracks only; auto: the cheapest for each prim."""
    segments: int = 0
    """Exactly these for whatever moves, a power of two; 0: as few as it takes."""
    max_instances: int = MAX_INSTANCES
    """More are refused, nested ones multiplied out."""


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


def read_frame(
    stage: Usd.Stage,
    frame: float | None,
    settings: ReadSettings = ReadSettings(),
    diagnostics: Diagnostics | None = None,
    make_translator: Callable[..., Any] | None = None,
    *,
    progress: Callable[[float], object] | None = None,
    found: SampleLog | None = None,
) -> ReadResult:
    """Reads what is visible at a frame, and its motion over the camera's shutter.

    `frame` is a time code; None: USD's default time, without blur. `make_translator` stands in for
    msbvh._core.Translator in tests. `progress` is called with the finished share in [0, 1], after each mesh
    and after each prototype's instances; `found` notes which samples moved what. Raises SceneError where
    there is nothing that could be rendered through this camera; whatever else is wrong or unsupported leaves
    a diagnostic, and the rest is read.
    """
    diagnostics = Diagnostics() if diagnostics is None else diagnostics
    make_translator = make_translator or _core_translator
    with tf_messages(diagnostics), _no_collection():
        return _FrameReader(stage, frame, settings, diagnostics, make_translator, progress, found).read()


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


def _core_translator(**settings: Any) -> Any:
    from . import _core

    try:
        return _core.Translator(**settings)
    except _core.Error as error:
        raise SceneError(str(error)) from None


def _unlimited(corners: np.ndarray) -> np.ndarray:
    """Pixels so large that no motion is seen: for a first look at where things are."""
    return np.full(corners.shape[1], np.inf)


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
                (settings.width, settings.height),
                settings.conform,
                purposes,
                diagnostics,
            )
            shutter = self._camera.shutter
            self._context = FrameContext(stage, shutter, is_held(stage), diagnostics, found=found)
            self._traversal = Traversal(self._context, purposes)
            self._graph = InstanceGraph(self._traversal.groups, self._context)
            self._graph.check(settings.max_instances)
            self._caches = XformCaches(shutter, self._traversal.authored_times, self._context.held)
        self._pixel = self._camera.pixel_size()
        self._translator = make_translator(**self._translator_settings())
        materials = Materials(self._translator, self._context)
        self._shapes = Shapes(self._context, self._caches, materials, settings.motion_tolerance)
        self._light_count = 0
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

    def _step(self) -> None:
        """A mesh is done, or a prototype's instances are."""
        self._steps_done += 1
        if self._progress is not None:
            self._progress(min(self._steps_done / self._steps, 1.0))

    def _note_camera(self, found: SampleLog) -> None:
        prim = self._context.stage.GetPrimAtPath(self._camera.path)
        scales = scales_at(prim, self._context.shutter, Diagnostics())
        shutter = self._context.shutter.scaled(scales.blur)
        found.camera(optics(UsdGeom.Camera(prim)), prim, shutter, self._camera.times01)

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
            "bends01": camera.bends01,
            "lenses": camera.lenses,
            "near_clip": camera.near_clip,
            "far_clip": camera.far_clip,
            "clips": camera.clips,
            "width": camera.width,
            "height": camera.height,
            "motion_tolerance": settings.motion_tolerance,
            "max_segments": settings.max_segments,
            "interpolation": settings.interpolation,
            "segments": settings.segments,
        }

    def _add_world_meshes(self) -> None:
        """Meshes by the hundred, so that those that move alike are evaluated together."""
        batch: list[Shape] = []
        weight = 0
        for part in self._traversal.groups[WORLD].shapes:
            shape = self._shapes.read(part, None, self._world_pixel_sizes)
            if shape is not None:
                batch.append(shape)
                weight += shape.weight()
            self._step()
            if weight > BATCH_WEIGHT:
                self._shapes.hand_down(batch, None, self._world_pixel_sizes, self._translator.add_mesh)
                batch, weight = [], 0
        self._shapes.hand_down(batch, None, self._world_pixel_sizes, self._translator.add_mesh)

    def _world_pixel_sizes(self, corners: np.ndarray) -> np.ndarray:
        return self._pixel.nearest(corners)

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
        coarse = [self._shapes.read(part, group.root, _unlimited) for part in group.shapes]
        box = Box.empty()
        for shape in filter(None, coarse):
            box = box.union(shape.extent(self._caches, group.root))
        pixels_per_unit = max(self._pixels_per_unit(placement, box) for placement in placed)

        def pixel_sizes(corners: np.ndarray) -> np.ndarray:
            return np.full(corners.shape[1], 1.0 / max(pixels_per_unit, 1e-30))

        prototype = self._translator.begin_prototype(group.path, pixels_per_unit)

        def add(**mesh: Any) -> None:
            self._translator.add_prototype_mesh(prototype, **mesh)

        shapes = []
        for part, shape in zip(group.shapes, coarse, strict=True):
            if shape is not None and shape.mesh.get("computed_points"):
                shape = self._shapes.read(part, group.root, pixel_sizes)  # Skinned: sampled as the pixels ask.
            self._step()
            shapes.extend([shape] if shape is not None else [])
        self._shapes.hand_down(shapes, group.root, pixel_sizes, add)
        for placement in placed:
            self._add_instances(placement, prototype, box)
        self._step()

    def _pixels_per_unit(self, placement: Placement, box: Box) -> float:
        return self._measure([coarse_keywords(level) for level in placement.levels], box)

    def _measure(self, levels: list[dict], box: Box) -> float:
        if (box.lo > box.hi).any():
            return 0.0
        return self._translator.pixels_per_unit(levels=levels, box=np.array([box.lo, box.hi], np.float64))

    def _add_instances(self, placement: Placement, prototype: int, box: Box) -> None:
        tolerance, held = self._settings.motion_tolerance, self._context.held
        diagnostics = self._context.diagnostics
        for levels, indices in level_keywords(placement, box, self._measure, tolerance, held, diagnostics):
            colour = placement.display_color
            if colour is not None:
                colour = each(colour, lambda every, some=indices: np.ascontiguousarray(every[some]))
            if self._context.found is not None:
                self._context.found.evaluated_instances(placement.path, levels)
            self._translator.add_instances(
                path=placement.path,
                prototype=prototype,
                levels=levels,
                visible=placement.visible,
                display_color=colour,
            )

    def _add_lights(self, placements: list[Placement]) -> None:
        for placement in placements:
            group = self._traversal.groups[placement.key]
            for part in group.lights:
                shutter = self._context.shutter.scaled(part.scales.blur)
                motion = self._caches.motion([part.prim], group.root, part.varying, shutter)
                motion = motion.inside(placement.motion)
                switches = Switches(part.blinking, placement.visible)
                self._light_count += add_lights(self._translator, part.prim, switches, motion, self._context)
        if self._light_count == 0 and not self._settings.disable_camera_light:
            self._translator.add_light(**camera_light(self._camera.times01, self._camera.world_from_camera))

    def _finish(self) -> ReadResult:
        diagnostics = self._context.diagnostics
        for found in self._translator.diagnostics():
            if found.severity == "error":
                diagnostics.error(found.path, found.attribute, f"{found.message}; the prim is not drawn")
            else:
                diagnostics.warning(found.path, found.attribute, found.message)
        if self._translator.empty:
            diagnostics.warning(
                "", "", "nothing to draw: no visible meshes or instances at this frame; the image is empty"
            )
        tracks = self._translator.tracks()
        return ReadResult(self._translator.finish(), self._camera, diagnostics, tracks, self._seconds)
