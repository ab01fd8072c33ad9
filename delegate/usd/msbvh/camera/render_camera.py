"""The render camera: which one, what it sees, and how it moves over its shutter."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from pxr import Gf, Sdf, Tf, Usd, UsdGeom, UsdUtils

from .. import _core
from .._core import LARGEST_ELEMENT, Density, PixelSize, Turns, dense_times01
from ..base.errors import Diagnostics, SceneError
from ..base.image_metadata import world_to_camera, world_to_ndc
from ..motion.boxes import Box
from ..motion.held_values import warn_of_change
from ..motion.motion_scales import scales_at
from ..motion.times import (
    Shutter,
    asked_shutter,
    breakpoints_of,
    checked_shutter,
    is_held,
)
from ..motion.transform_faults import unusable_op
from ..motion.transforms import authored_xform_times, xformables
from ..motion.turns import NO_TURNS, report_too_fast, total_turns, xform_turns
from ..stage.opening import tf_reason
from ..stage.value_types import FLOAT
from ..stage.values import value
from .aspect import Window, optics_of, window_of
from .camera_values import CameraValues
from .exposure import exposure_scale
from .framing import framing_camera
from .lens import read_lenses
from .picture import Picture, PixelWindow


@dataclass(frozen=True)
class RenderCamera:
    """A camera over the shutter, with the image that it makes. Spaces as in USD: looks along -z, y up."""

    path: str
    """Of the prim; empty for a framing camera."""
    projection: str
    """perspective or orthographic."""
    shutter: Shutter
    times01: np.ndarray
    """float64[T], increasing."""
    world_from_camera: np.ndarray
    """float64[T, 4, 4]."""
    windows: np.ndarray
    """float32[T, 4]: left, right, bottom, top of the pixels at unit distance (orthographic: stage units)."""
    breakpoints01: np.ndarray
    """float64[B]: where the camera may change its course."""
    periods01: np.ndarray
    """float64[P]: shares of the shutter after which its motion may repeat."""
    lenses: np.ndarray
    """float32[T, 2]: radius and focus distance, in the camera's space; radius 0: a pinhole."""
    near_clip: float
    """The nearest and the farthest of the shutter."""
    far_clip: float
    clips: np.ndarray | None
    """float32[T, 2]: near and far, where they change; None: the same throughout."""
    clipping_planes: np.ndarray
    """float32[P, 4]: unit normal and offset, in camera space; what lies below any of them is not seen."""
    pixels: PixelWindow
    """What is rendered of the picture: all of it, a crop, or overscan too."""
    frame_matrix: np.ndarray
    """world_from_camera at the frame, float64[4, 4]."""
    frame_window: Window
    """At the frame, of the whole picture."""
    pixel_aspect_ratio: float
    """Width of a pixel over its height; not 1 only where the conform policy or render settings say so."""
    exposure: float = 1.0
    """What the picture's colours are multiplied by."""

    @property
    def width(self) -> int:
        """Of the pixels that are rendered."""
        return self.pixels.width

    @property
    def height(self) -> int:
        """Of the pixels that are rendered."""
        return self.pixels.height

    @property
    def world_to_camera(self) -> np.ndarray:
        """float64[4, 4] at the frame, in OpenEXR's convention."""
        return world_to_camera(self.frame_matrix)

    @property
    def world_to_ndc(self) -> np.ndarray:
        """float64[4, 4] at the frame, in OpenEXR's convention."""
        return world_to_ndc(self.world_to_camera, self.frame_window, self.projection == "perspective")

    def pixel_size(self) -> PixelSize:
        """The size of a pixel in the world, the smallest over the shutter."""
        extent = self.windows[:, [1, 3]] - self.windows[:, [0, 2]]
        per_unit = float(np.abs(extent / (self.width, self.height)).min())
        eyes = Box.around(self.world_from_camera[:, 3, :3])
        return PixelSize(eyes.ends(), self.projection == "perspective", per_unit, max(self.near_clip, 0.0))


@dataclass(frozen=True)
class Blur:
    """What of a camera blurs a picture."""

    shutter: tuple[float, float] | None = None
    """In place of the camera's own, in frames relative to the frame; None: the camera's."""
    motion: bool = True
    """False: the shutter is closed."""
    lens: bool = True
    """False: a pinhole."""


def read_camera(
    stage: Usd.Stage,
    frame: float | None,
    name: str | None,
    picture: Picture,
    purposes: list[str],
    diagnostics: Diagnostics,
    blur: Blur = Blur(),
) -> RenderCamera:
    """Finds the camera, and samples it over its shutter.

    Raises SceneError for an unknown camera, an unknown conform policy and optics that make no image.
    """
    prim = find_camera(stage, name, diagnostics)
    if prim is None:
        shutter = _shutter(None, frame, blur, diagnostics)
        framing = framing_camera(stage, shutter, purposes, picture, diagnostics)
        course = Course(shutter, (), NO_TURNS, False)
        return _sampled("", shutter, course, lambda _: framing, picture, diagnostics)
    try:
        camera = _read(prim, frame, picture, diagnostics, blur)
        return (
            replace(camera, exposure=exposure_scale(prim, camera.shutter, diagnostics)) if picture.exposed else camera
        )
    except Tf.ErrorException as error:
        raise SceneError(f"{prim.GetPath()}: USD cannot evaluate it: {tf_reason(error)}") from error


def _read(
    prim: Usd.Prim,
    frame: float | None,
    picture: Picture,
    diagnostics: Diagnostics,
    blur: Blur,
) -> RenderCamera:
    camera = UsdGeom.Camera(prim)
    code = Shutter(frame).frame_code
    shutter = _shutter(camera, frame, blur, diagnostics)
    own = shutter.scaled(scales_at(prim, shutter, diagnostics).blur)
    course = _course(prim, own, is_held(prim.GetStage()))
    report_too_fast(course.turns, str(prim.GetPath()), diagnostics)
    values_at = CameraValues(camera).at

    for attribute in (camera.GetProjectionAttr(), camera.GetClippingPlanesAttr()):
        warn_of_change(attribute, "", own, diagnostics)
    projection = values_at(code).projection

    def camera_at(code: Usd.TimeCode) -> Gf.Camera:
        found = values_at(code)
        found.projection = projection
        if not blur.lens:
            found.fStop = 0.0
        if not (np.abs(np.array(found.transform)) <= LARGEST_ELEMENT).all():
            path, attribute, message = unusable_op(list(xformables(prim, None)), own)
            raise SceneError(f"{path}.{attribute}: {message}")
        return found

    return _sampled(str(prim.GetPath()), shutter, course, camera_at, picture, diagnostics)


def _shutter(
    camera: UsdGeom.Camera | None,
    frame: float | None,
    blur: Blur,
    diagnostics: Diagnostics,
) -> Shutter:
    """The one that was asked for, else the camera's; closed where a camera is made up, which says so itself."""
    if not blur.motion:
        return Shutter(frame)
    if frame is not None and blur.shutter is not None:
        return asked_shutter(frame, blur.shutter, diagnostics)
    if camera is None:
        return checked_shutter(frame, 0.0, 0.0, "", diagnostics) if frame is None else Shutter(frame)
    code = Shutter(frame).frame_code
    opening = value(camera.GetShutterOpenAttr(), code, FLOAT)
    closing = value(camera.GetShutterCloseAttr(), code, FLOAT)
    return checked_shutter(frame, opening or 0.0, closing or 0.0, str(camera.GetPath()), diagnostics)


def find_camera(stage: Usd.Stage, name: str | None, diagnostics: Diagnostics) -> Usd.Prim | None:
    """The camera of that path or name; without one the primary camera of USD's convention, else the first.

    None if the stage has no camera and none was asked for. Raises SceneError if the one asked for is not
    there.
    """
    cameras = list(_cameras(stage))
    if name:
        return _named_camera(cameras, name)
    if not cameras:
        return None
    primary = [prim for prim in cameras if prim.GetName() == UsdUtils.GetPrimaryCameraName()]
    chosen = (primary or cameras)[0]
    if len(cameras) > 1 and not primary:
        diagnostics.note(str(chosen.GetPath()), "", f"the first of {len(cameras)} cameras; --camera chooses another")
    return chosen


def _cameras(stage: Usd.Stage) -> Iterator[Usd.Prim]:
    """Those in instances too. What has none is looked through once, however many instances show it."""
    known: dict[Sdf.Path, bool] = {}

    def has_camera(prototype: Usd.Prim) -> bool:
        path = prototype.GetPath()
        if path not in known:
            known[path] = any(
                prim.IsA(UsdGeom.Camera) or (prim.IsInstance() and has_camera(prim.GetPrototype()))
                for prim in Usd.PrimRange(prototype)
            )
        return known[path]

    prims = iter(Usd.PrimRange.Stage(stage, Usd.TraverseInstanceProxies()))
    for prim in prims:
        if prim.IsA(UsdGeom.Camera):
            yield prim
        if prim.IsInstance() and not has_camera(prim.GetPrototype()):
            prims.PruneChildren()


def _named_camera(cameras: list[Usd.Prim], name: str) -> Usd.Prim:
    for prim in cameras:
        # As usdrecord has it, a relative path counts from the root.
        if prim.GetName() == name or str(prim.GetPath()) == "/" + name.lstrip("/"):
            return prim
    known = ", ".join(str(prim.GetPath()) for prim in cameras[:8]) or "none"
    raise SceneError(f"camera: found no camera '{name}', expected one of the stage's cameras: {known}")


@dataclass(frozen=True)
class Course:
    """Where a camera may change its course, and how far it turns."""

    shutter: Shutter
    """The camera's own, scaled where it has a motion:blurScale."""
    breakpoints01: tuple[float, ...]
    turns: Turns
    held: bool
    """Values jump at the breakpoints."""

    def times01(self) -> list[float]:
        """Where the camera is evaluated: one time for a closed shutter."""
        if not self.shutter.moving:
            return [0.0]
        return dense_times01(Density.CAMERA, self.turns.rate, self.breakpoints01, self.held)


def _course(prim: Usd.Prim, shutter: Shutter, held: bool) -> Course:
    """Of a camera's optics and its own and its ancestors' transforms."""
    if not shutter.moving:
        return Course(shutter, (), NO_TURNS, held)
    carriers = list(xformables(prim, None))
    times = authored_xform_times(carriers, shutter)
    times = times.union(*(breakpoints_of(each, shutter) for each in optics(UsdGeom.Camera(prim))))
    breakpoints01 = tuple(sorted({shutter.time01(time) for time in times}))
    return Course(shutter, breakpoints01, total_turns(xform_turns(each, shutter) for each in carriers), held)


def optics(camera: UsdGeom.Camera) -> tuple[Usd.Attribute, ...]:
    """The attributes that zoom and focus a camera, and where it cuts off."""
    return (
        camera.GetFocalLengthAttr(),
        camera.GetHorizontalApertureAttr(),
        camera.GetVerticalApertureAttr(),
        camera.GetHorizontalApertureOffsetAttr(),
        camera.GetVerticalApertureOffsetAttr(),
        camera.GetFStopAttr(),
        camera.GetFocusDistanceAttr(),
        camera.GetClippingRangeAttr(),
    )


def _sampled(
    path: str,
    shutter: Shutter,
    course: Course,
    camera_at: Callable[[Usd.TimeCode], Gf.Camera],
    picture: Picture,
    diagnostics: Diagnostics,
) -> RenderCamera:
    """Evaluates `camera_at` as densely as interpolation between needs, to a thousandth of a pixel; or once if it does
    not move."""
    at_frame = camera_at(shutter.frame_code)
    _check_optics(path, at_frame)
    size = picture.sized(at_frame.aspectRatio)
    window, pixel_aspect = picture.fitted(window_of(at_frame), size)
    pixels = picture.pixels(size, diagnostics)

    times01 = course.times01()
    cameras = [camera_at(course.shutter.time_code(time01)) for time01 in times01]
    for camera in cameras:
        _check_optics(path, camera)
    matrices = np.array([np.array(camera.transform) for camera in cameras])
    shown = np.array([picture.fitted(window_of(camera), size)[0] for camera in cameras])
    windows = pixels.part_of(shown).astype(np.float32)
    lenses = read_lenses(path, at_frame, cameras, diagnostics)
    keep = len(times01)
    clips = np.array([(camera.clippingRange.min, camera.clippingRange.max) for camera in cameras], np.float32)
    if all((values == values[0]).all() for values in (matrices, windows, lenses, clips)):
        keep = 1
    return RenderCamera(
        path=path,
        projection=at_frame.projection.displayName.lower(),
        shutter=shutter,
        times01=np.array(times01[:keep]),
        world_from_camera=matrices[:keep],
        windows=windows[:keep],
        breakpoints01=np.array(_core.course_breakpoints01(course.breakpoints01, course.held)),
        periods01=np.array(course.turns.periods01),
        lenses=lenses[:keep],
        near_clip=float(clips[:, 0].min()),
        far_clip=float(clips[:, 1].max()),
        clips=None if (clips == clips[0]).all() else clips,
        clipping_planes=_planes(path, at_frame, diagnostics),
        pixels=pixels,
        frame_matrix=np.array(at_frame.transform),
        frame_window=window,
        pixel_aspect_ratio=pixel_aspect,
    )


def _planes(path: str, camera: Gf.Camera, diagnostics: Diagnostics) -> np.ndarray:
    given = np.array([list(plane) for plane in camera.clippingPlanes], np.float64).reshape(-1, 4)
    planes, said = _core.checked_planes(path, given)
    diagnostics.take(said)
    return planes


def _check_optics(path: str, camera: Gf.Camera) -> None:
    clip = camera.clippingRange
    try:
        _core.check_optics(path, optics_of(camera), clip.min, clip.max)
    except _core.Error as error:
        raise SceneError(str(error)) from None
