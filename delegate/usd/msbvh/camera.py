"""The render camera: which one, what it sees, and how it moves over its shutter."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom, UsdUtils

from .boxes import Box, PixelSize
from .conform import Window, conformed
from .errors import Diagnostics, SceneError
from .framing import framing_camera
from .held_values import warn_of_change
from .lens import read_lenses
from .metadata import world_to_camera, world_to_ndc
from .motion_scales import scales_at
from .times import Shutter, TimeGrid, checked_shutter, is_held
from .transform_faults import unusable_op
from .transforms import LARGEST, authored_xform_times, xformables

CAMERA_LEVEL = 10
"""2^10 intervals."""


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
    """float32[T, 4]: left, right, bottom, top of the image at unit distance (orthographic: stage units)."""
    bends01: np.ndarray
    """float64[B]: where the camera may change its course."""
    lenses: np.ndarray
    """float32[T, 2]: radius and focus distance, in the camera's space; radius 0: a pinhole."""
    near_clip: float
    """The nearest and the farthest of the shutter."""
    far_clip: float
    clips: np.ndarray | None
    """float32[T, 2]: near and far, where they change; None: the same throughout."""
    width: int
    height: int
    frame_matrix: np.ndarray
    """world_from_camera at the frame, float64[4, 4]."""
    frame_window: Window
    """At the frame."""
    pixel_aspect_ratio: float
    """Width of a pixel over its height; not 1 only where the conform policy says so."""

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
        return PixelSize(eyes, self.projection == "perspective", per_unit, max(self.near_clip, 0.0))


def read_camera(
    stage: Usd.Stage,
    frame: float | None,
    name: str | None,
    image_size: tuple[int, int | None],
    conform: str,
    purposes: list[str],
    diagnostics: Diagnostics,
) -> RenderCamera:
    """Finds the camera, and samples it over its shutter.

    `image_size` is width and height in pixels; height None: the camera's aspect ratio decides, as in
    usdrecord. Raises SceneError for an unknown camera, an unknown conform policy and optics that make no
    image.
    """
    prim = find_camera(stage, name, diagnostics)
    if prim is None:
        framing = framing_camera(stage, frame, purposes, diagnostics)
        shutter = checked_shutter(frame, 0.0, 0.0, "", diagnostics) if frame is None else Shutter(frame)
        return _sampled("", shutter, TimeGrid(shutter), lambda _: framing, image_size, conform, diagnostics)
    camera = UsdGeom.Camera(prim)
    code = Shutter(frame).frame_code
    opening, closing = camera.GetShutterOpenAttr().Get(code), camera.GetShutterCloseAttr().Get(code)
    shutter = checked_shutter(frame, opening or 0.0, closing or 0.0, str(prim.GetPath()), diagnostics)
    own = shutter.scaled(scales_at(prim, shutter, diagnostics).blur)
    grid = TimeGrid(own, _authored_times(prim, own), is_held(stage))

    warn_of_change(camera.GetProjectionAttr(), "", own, diagnostics)
    projection = camera.GetCamera(code).projection

    def camera_at(code: Usd.TimeCode) -> Gf.Camera:
        found = camera.GetCamera(code)
        found.projection = projection
        if not (np.abs(np.array(found.transform)) <= LARGEST).all():
            path, attribute, message = unusable_op(list(xformables(prim, None)), own)
            raise SceneError(f"{path}.{attribute}: {message}")
        return found

    return _sampled(str(prim.GetPath()), shutter, grid, camera_at, image_size, conform, diagnostics)


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
        diagnostics.note(
            str(chosen.GetPath()), "", f"the first of {len(cameras)} cameras; --camera chooses another"
        )
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


def _authored_times(prim: Usd.Prim, shutter: Shutter) -> set[float]:
    """Time codes within the shutter at which the camera's optics or an ancestor's transform are authored."""
    if not shutter.moving:
        return set()
    ancestors = [UsdGeom.Xformable(prim.GetStage().GetPrimAtPath(p)) for p in prim.GetPath().GetPrefixes()]
    times = authored_xform_times([xformable for xformable in ancestors if xformable], shutter)
    return times.union(*(a.GetTimeSamplesInInterval(shutter.interval) for a in optics(UsdGeom.Camera(prim))))


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
    grid: TimeGrid,
    camera_at: Callable[[Usd.TimeCode], Gf.Camera],
    image_size: tuple[int, int | None],
    conform: str,
    diagnostics: Diagnostics,
) -> RenderCamera:
    """Evaluates `camera_at` as densely as straight lines between need for a quarter turn within the shutter, to a
    thousandth of a pixel; or once if it does not move.

    The grid's shutter is the camera's own, scaled where it has a motion:blurScale."""
    at_frame = camera_at(shutter.frame_code)
    _check_optics(path, at_frame)
    width, height = image_size
    height = height or image_height(width, at_frame.aspectRatio)
    window, pixel_aspect = conformed(_window(at_frame), width / height, conform)

    times01 = grid.times01(CAMERA_LEVEL)
    cameras = [camera_at(grid.shutter.time_code(time01)) for time01 in times01]
    for camera in cameras:
        _check_optics(path, camera)
    matrices = np.array([np.array(camera.transform) for camera in cameras])
    windows = np.float32([conformed(_window(camera), width / height, conform)[0] for camera in cameras])
    lenses = read_lenses(path, at_frame, cameras, diagnostics)
    keep = len(times01)
    clips = np.float32([(camera.clippingRange.min, camera.clippingRange.max) for camera in cameras])
    if all((values == values[0]).all() for values in (matrices, windows, lenses, clips)):
        keep = 1
    return RenderCamera(
        path=path,
        projection=at_frame.projection.displayName.lower(),
        shutter=shutter,
        times01=np.array(times01[:keep]),
        world_from_camera=matrices[:keep],
        windows=windows[:keep],
        bends01=np.array(grid.bends01),
        lenses=lenses[:keep],
        near_clip=float(clips[:, 0].min()),
        far_clip=float(clips[:, 1].max()),
        clips=None if (clips == clips[0]).all() else clips,
        width=width,
        height=height,
        frame_matrix=np.array(at_frame.transform),
        frame_window=window,
        pixel_aspect_ratio=pixel_aspect,
    )


def image_height(width: int, aspect_ratio: float) -> int:
    """The image's height by usdrecord's rule: rounded down, never below one pixel.

    In single precision as there: in double, the float 16:9 would make 539 lines of 960 columns.
    """
    return max(int(np.float32(width) / np.float32(aspect_ratio if abs(aspect_ratio) > 1e-4 else 1.0)), 1)


def _window(camera: Gf.Camera) -> Window:
    """The camera's own window. Apertures and focal length share a unit, a tenth of the stage's."""
    if camera.projection == Gf.Camera.Orthographic:
        scale = Gf.Camera.APERTURE_UNIT
    else:
        scale = Gf.Camera.APERTURE_UNIT / (camera.focalLength * Gf.Camera.FOCAL_LENGTH_UNIT)
    x, half_width = camera.horizontalApertureOffset, camera.horizontalAperture / 2
    y, half_height = camera.verticalApertureOffset, camera.verticalAperture / 2
    return (
        (x - half_width) * scale,
        (x + half_width) * scale,
        (y - half_height) * scale,
        (y + half_height) * scale,
    )


def _check_optics(path: str, camera: Gf.Camera) -> None:
    sizes = {"horizontalAperture": camera.horizontalAperture, "verticalAperture": camera.verticalAperture}
    if camera.projection != Gf.Camera.Orthographic:
        sizes["focalLength"] = camera.focalLength
    for attribute, value in sizes.items():
        if not (math.isfinite(value) and value > 0.0):
            raise SceneError(f"{path}.{attribute}: found {value:g}, expected a finite number above 0")
    offsets = {
        "horizontalApertureOffset": camera.horizontalApertureOffset,
        "verticalApertureOffset": camera.verticalApertureOffset,
    }
    for attribute, value in offsets.items():
        if not math.isfinite(value):
            raise SceneError(f"{path}.{attribute}: found {value:g}, expected a finite number")
    near, far = camera.clippingRange.min, camera.clippingRange.max
    if not near < far:
        raise SceneError(f"{path}.clippingRange: found ({near:g}, {far:g}), expected near < far")
