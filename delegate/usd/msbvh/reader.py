"""Reads one frame of a stage into a scene that the renderer draws."""

from __future__ import annotations

import time
from collections.abc import Callable, Hashable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from pxr import Usd, UsdGeom

from .camera import RenderCamera, read_camera
from .context import FrameContext
from .errors import Diagnostics, SceneError
from .instances import Placement, Placer
from .lights import add_lights, camera_light
from .materials import Materials
from .meshes import faces_by_material, read_shape
from .points import CHORD_TOLERANCE
from .skinning import read_skinning
from .stage import tf_messages
from .times import TimeGrid, is_held
from .transforms import Box, XformCaches, dense_samples, may_move
from .traversal import WORLD, Group, Part, Traversal


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
) -> ReadResult:
    """Reads what is visible at a frame, and its motion over the camera's shutter.

    `frame` is a time code; None: USD's default time, without blur. `make_translator` stands in for
    msbvh._core.Translator in tests. Raises SceneError where there is nothing that could be rendered through
    this camera; whatever else is wrong or unsupported leaves a diagnostic, and the rest is read.
    """
    diagnostics = Diagnostics() if diagnostics is None else diagnostics
    with tf_messages(diagnostics):
        return _FrameReader(stage, frame, settings, diagnostics, make_translator or _core_translator).read()


def _core_translator(**settings: Any) -> Any:
    from . import _core

    try:
        return _core.Translator(**settings)
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
            self._context = FrameContext(stage, shutter, is_held(stage), diagnostics)
            self._traversal = Traversal(self._context, purposes)
            self._caches = XformCaches(TimeGrid(shutter, self._traversal.authored_times, self._context.held))
        self._pixel = self._camera.pixel_size()
        self._translator = make_translator(**self._translator_settings())
        self._materials = Materials(self._translator, self._context)
        self._prototypes: dict[Hashable, tuple[int, Box]] = {}
        self._light_count = 0

    def read(self) -> ReadResult:
        """Hands everything down and finishes the scene."""
        with self._timed("meshes"):
            self._add_world_meshes()
        placements = list(Placer(self._traversal, self._caches, self._context).placements())
        with self._timed("instances"):
            for placement in placements[1:]:
                self._add_instances(placement)
        with self._timed("lights"):
            self._add_lights(placements)
        with self._timed("finish"):
            return self._finish()

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
            "lenses": camera.lenses,
            "near_clip": camera.near_clip,
            "far_clip": camera.far_clip,
            "width": camera.width,
            "height": camera.height,
            "motion_tolerance": settings.motion_tolerance,
            "max_segments": settings.max_segments,
        }

    def _add_world_meshes(self) -> None:
        for part in self._traversal.groups[WORLD].shapes:
            self._add_shape(part, None, self._settings.motion_tolerance, self._translator.add_mesh)

    def _add_shape(
        self, part: Part, root: Usd.Prim | None, tolerance: float, add: Callable[..., None]
    ) -> Box:
        """Hands a mesh down, once for each material on it. Returns its box in the space of `root` over the
        shutter."""
        mesh = read_shape(part.prim, self._context)
        if mesh is None:
            return Box.empty()
        placed_by, varying = part.prim, part.varying
        skinned = read_skinning(part.prim, mesh, self._context, self._skinning_tolerance(root, tolerance))
        samples = mesh.pop("samples")
        if skinned is not None:
            if skinned.samples is None:
                return Box.empty()
            samples, placed_by = skinned.samples, skinned.placed_by
            varying = may_move(placed_by, root)
            mesh.update(normals=skinned.normals, normals_indices=None)
        box = samples.box()
        motion = self._caches.motion([placed_by], root, varying)
        ((_, times01, matrices),) = dense_samples(motion, box, self._pixel, tolerance)
        mesh.update(
            points=samples.values,
            points_held=samples.held,
            transform_times01=np.array(times01),
            transforms=np.ascontiguousarray(matrices[:, 0]),
        )
        parts = []
        if part.prim.IsA(UsdGeom.Mesh):
            parts = faces_by_material(UsdGeom.Mesh(part.prim), len(mesh["face_vertex_counts"]), self._context)
        for prim, outside in parts or [(part.prim, None)]:
            holes = mesh["hole_indices"]
            if outside is not None:
                holes = outside if holes is None else np.union1d(holes, outside).astype(np.int32)
            add(**{**mesh, "hole_indices": holes, "material": self._materials.bound_to(prim)})
        return Box.around((box.corners() @ matrices[:, 0, :, :3]).reshape(-1, 3))

    def _skinning_tolerance(
        self, root: Usd.Prim | None, tolerance_pixels: float
    ) -> Callable[[Usd.Prim, Box], float]:
        """How far skinned points may stray between samples: a quarter of the tolerance, the rest of which the
        track has. In a prototype, whose size in pixels is not known, as for points under acceleration."""

        def tolerance(placed_by: Usd.Prim, box: Box) -> float:
            if root is not None:
                return CHORD_TOLERANCE * float(np.max(box.hi - box.lo))
            matrices = np.array([self._caches.matrix(time, placed_by, None) for time in (0.0, 0.5, 1.0)])
            stretch = np.linalg.norm(matrices[:, :3, :3], ord=2, axis=(1, 2)).max()
            corners = (box.corners() @ matrices[..., :3])[:, None]
            return 0.25 * tolerance_pixels * float(self._pixel.nearest(corners)[0]) / max(stretch, 1e-30)

        return tolerance

    def _prototype(self, key: Hashable) -> tuple[int, Box] | None:
        """The translator's id of a group and its box; None if it shows nothing. Hands its meshes down at
        first use."""
        group: Group = self._traversal.groups[key]
        if not group.shapes:
            return None
        if key not in self._prototypes:
            prototype = self._translator.begin_prototype(group.path)

            def add(**mesh: Any) -> None:
                self._translator.add_prototype_mesh(prototype, **mesh)

            box = Box.empty()
            for part in group.shapes:
                # How large a pixel is depends on the instance: motion inside a prototype is sampled as finely
                # as it goes.
                box = box.union(self._add_shape(part, group.root, 0.0, add))
            self._prototypes[key] = (prototype, box)
        return self._prototypes[key]

    def _add_instances(self, placement: Placement) -> None:
        known = self._prototype(placement.key)
        if known is None:
            return
        prototype, box = known
        tolerance = self._settings.motion_tolerance
        for indices, times01, matrices in dense_samples(placement.motion, box, self._pixel, tolerance):
            colour = placement.display_color
            self._translator.add_instances(
                path=placement.path,
                prototype=prototype,
                times01=np.array(times01),
                matrices=np.ascontiguousarray(matrices),
                display_color=None if colour is None else np.ascontiguousarray(colour[indices]),
            )

    def _add_lights(self, placements: list[Placement]) -> None:
        for placement in placements:
            group = self._traversal.groups[placement.key]
            for part in group.lights:
                motion = self._caches.motion([part.prim], group.root, part.varying).inside(placement.motion)
                self._light_count += add_lights(
                    self._translator, part.prim, part.blinking, motion, self._context
                )
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
