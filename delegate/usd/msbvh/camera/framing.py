"""The camera that is made where a stage has none."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from pxr import Gf, Tf, Usd, UsdGeom

from ..base.errors import Diagnostics
from ..motion.boxes import Box
from ..motion.times import SHUTTER_HINT, Shutter
from ..motion.xform_ops import world_transform
from ..skel.skinned_bounds import SkinnedBounds
from ..stage.tokens import inherited_purpose
from ..stage.value_types import FLOAT3S
from ..stage.values import value
from .aspect import window_of
from .picture import Picture

LARGEST_COORDINATE = 2.0**60
"""What single precision can square and multiply; see core/geometry/triangle_mesh.h."""
TIMES_OF_THE_SHUTTER = 9
"""At which bounds are computed where the shutter is open, its ends included: each costs as much as a still
frame's."""
MARGIN = 1.03
"""By how much more than the bounds the image shows at least, so that nothing touches its edge. A cube has 3 %
from usdrecord's distance."""


def framing_camera(
    stage: Usd.Stage,
    shutter: Shutter,
    purposes: list[str],
    picture: Picture,
    diagnostics: Diagnostics,
) -> Gf.Camera:
    """A 50 mm camera in front of everything, as usdrecord makes it (OpenUSD, usdAppUtils/frameRecorder.cpp).

    It looks along -z (y up) or +y (z up) at the stage's bounds over the shutter, from usdrecord's distance,
    at which the diagonal of their front face fills the width. usdrecord cuts off what is tall; here the
    camera goes back until all corners are in the image. usdrecord's clipping range is 1 to 1e6 whatever the
    scene's size; here it fits the scene.
    """
    bounds = _bounds(stage, shutter, purposes, diagnostics)
    if bounds is None:
        message = "no camera and no finite bounds to frame; a camera at (0, 0, 10) looks at the origin"
        diagnostics.warning("", "", message + _closed(shutter))
        return Gf.Camera(Gf.Matrix4d().SetTranslate(Gf.Vec3d(0, 0, 10)))
    diagnostics.note("", "", "no camera on the stage; made one in front of everything" + _closed(shutter))
    y_up = UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.y
    size, centre = (bounds.hi - bounds.lo).tolist(), Gf.Vec3d(*((bounds.lo + bounds.hi) / 2).tolist())
    up, depth = (size[1], size[2]) if y_up else (size[2], size[1])

    camera = Gf.Camera()
    to_front = max(_distance(camera, size[0], up, picture), 1e-6)  # More than 0 for a single point.
    distance = to_front + depth / 2
    if y_up:
        camera.transform = Gf.Matrix4d().SetTranslate(centre + Gf.Vec3d(0, 0, distance))
    else:
        turned = Gf.Matrix4d().SetRotate(Gf.Rotation(Gf.Vec3d.XAxis(), 90))
        camera.transform = turned.SetTranslateOnly(centre + Gf.Vec3d(0, -distance, 0))
    near = min(1.0, distance * 1e-3, to_front / 2)
    camera.clippingRange = Gf.Range1f(near, max(1e6, distance * 10))
    return camera


def _closed(shutter: Shutter) -> str:
    """What a made-up camera says about its shutter: nobody else does, since no prim has authored it."""
    if shutter.moving or shutter.frame is None:
        return ""
    return f". Its shutter is closed, so nothing is blurred; {SHUTTER_HINT}"


def _distance(camera: Gf.Camera, width: float, height: float, picture: Picture) -> float:
    """From which a face of that size is seen whole."""
    (left, right, bottom, top), _ = picture.fitted(window_of(camera), picture.sized(camera.aspectRatio))
    as_usdrecord = math.hypot(width, height) / math.tan(
        math.radians(camera.GetFieldOfView(Gf.Camera.FOVHorizontal)) / 2
    )
    return max(as_usdrecord / 2, MARGIN * width / (right - left), MARGIN * height / (top - bottom))


def _bounds(stage: Usd.Stage, shutter: Shutter, purposes: list[str], diagnostics: Diagnostics) -> Box | None:
    """Around everything that is drawn, at a few times of the shutter; None where there is nothing, or nothing
    whose bounds single precision holds."""
    drawn = {"default", *purposes}
    cache = UsdGeom.BBoxCache(shutter.frame_code, list(drawn), useExtentsHint=True)
    skinned, absurd = SkinnedBounds(stage, drawn), list(_absurd(stage, shutter.frame_code))
    for prim in absurd:
        message = "found no finite box, expected the box around what the prim draws; framed by that"
        diagnostics.warning(str(prim.GetPath()), "extent", message)
    bounds = Box.empty()
    for time01 in np.linspace(0.0, 1.0, TIMES_OF_THE_SHUTTER if shutter.moving else 1).tolist():
        code = shutter.time_code(time01)
        cache.SetTime(code)
        whole = _world_box(cache, stage.GetPseudoRoot())
        if not _usable(whole):  # Without points USD's bounds are the largest floats, not empty.
            whole = Box.empty()
            absurd = list(_boundables(stage))
        for box in (whole, *skinned.boxes(code), *_usable_boxes(absurd, code, drawn)):
            bounds = bounds.union(box)
    return bounds if _usable(bounds) else None


def _world_box(cache: UsdGeom.BBoxCache, prim: Usd.Prim) -> Box:
    """Errors on single prims, which USD raises once, leave the others'."""
    for _ in range(2):
        try:
            return _box(cache.ComputeWorldBound(prim).ComputeAlignedRange())
        except Tf.ErrorException:
            continue
    return Box.empty()


def _computed_extent(boundable: UsdGeom.Boundable, code: Usd.TimeCode) -> Box:
    """From the points, or the parameters; empty where USD cannot evaluate them."""
    try:
        return _extent(UsdGeom.Boundable.ComputeExtentFromPlugins(boundable, code))
    except Tf.ErrorException:
        return Box.empty()


def _boundables(stage: Usd.Stage) -> Iterator[Usd.Prim]:
    prims = iter(Usd.PrimRange.Stage(stage, Usd.TraverseInstanceProxies()))
    bounded: dict[str, bool] = {}  # By type: asking each of a hundred thousand prims takes a while.
    for prim in prims:
        kind = prim.GetTypeName()
        if kind not in bounded:
            bounded[kind] = prim.IsA(UsdGeom.Boundable)
        if bounded[kind]:
            if prim.IsA(UsdGeom.PointInstancer):
                prims.PruneChildren()
            yield prim


def _absurd(stage: Usd.Stage, code: Usd.TimeCode) -> Iterator[Usd.Prim]:
    """Prims whose authored extent is not one: USD leaves them out of its bounds, or everything else."""
    for prim in _boundables(stage):
        extent = prim.GetAttribute("extent")
        if extent.HasAuthoredValue() and not _usable(_extent(value(extent, code, FLOAT3S))):
            yield prim


def _usable_boxes(prims: list[Usd.Prim], code: Usd.TimeCode, purposes: set[str]) -> Iterator[Box]:
    """Of each visible prim in the world, computed from its points where its authored extent makes no
    sense."""
    xforms = UsdGeom.XformCache(code)
    for prim in prims:
        imageable, boundable = UsdGeom.Imageable(prim), UsdGeom.Boundable(prim)
        hidden = imageable.ComputeVisibility(code) == UsdGeom.Tokens.invisible
        if hidden or inherited_purpose(prim) not in purposes:
            continue
        local = _extent(value(boundable.GetExtentAttr(), code, FLOAT3S))
        if not _usable(local):
            local = _computed_extent(boundable, code)
        world = np.array(world_transform(xforms, prim))
        box = Box.around(local.corners() @ world[:, :3])
        if _usable(local) and _usable(box):
            yield box


def _extent(extent: object) -> Box:
    """Empty for what is no pair of corners."""
    corners = np.zeros((0, 3)) if extent is None else np.asarray(extent, np.float64)
    return Box(*corners) if corners.shape == (2, 3) else Box.empty()


def _box(bounds: Gf.Range3d) -> Box:
    return Box.empty() if bounds.IsEmpty() else Box(np.array(bounds.min), np.array(bounds.max))


def _usable(box: Box) -> bool:
    """Whether it is a box of finite size that single precision can work with."""
    return bool((np.abs([box.lo, box.hi]) < LARGEST_COORDINATE).all() and (box.lo <= box.hi).all())
