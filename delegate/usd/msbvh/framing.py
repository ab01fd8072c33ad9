"""The camera that is made where a stage has none."""

from __future__ import annotations

import math

from pxr import Gf, Usd, UsdGeom

from .bounds import stage_bounds
from .errors import Diagnostics
from .times import Shutter

def framing_camera(
    stage: Usd.Stage, frame: float | None, purposes: list[str], diagnostics: Diagnostics
) -> Gf.Camera:
    """A 50 mm camera in front of everything, as usdrecord makes it (OpenUSD, usdAppUtils/frameRecorder.cpp).

    It looks along -z (y up) or +y (z up) at the stage's bounds, from where their front face fills the width.
    usdrecord's clipping range is 1 to 1e6 whatever the scene's size; here it fits the scene.
    """
    bounds = stage_bounds(stage, Shutter(frame).frame_code, ["default", *purposes], diagnostics)
    if bounds.IsEmpty():
        diagnostics.warning(
            "", "", "no camera and no finite bounds to frame; a camera at (0, 0, 10) looks at the origin"
        )
        return Gf.Camera(Gf.Matrix4d().SetTranslate(Gf.Vec3d(0, 0, 10)))
    diagnostics.note("", "", "no camera on the stage; made one in front of everything, as usdrecord does")
    y_up = UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.y
    size, centre = bounds.GetSize(), bounds.GetMidpoint()
    up, depth = (size[1], size[2]) if y_up else (size[2], size[1])

    camera = Gf.Camera()
    half_view = math.radians(camera.GetFieldOfView(Gf.Camera.FOVHorizontal)) / 2
    distance = math.hypot(size[0], up) / 2 / math.tan(half_view) + depth / 2
    distance = max(distance, 1e-6)  # A single point.
    if y_up:
        camera.transform = Gf.Matrix4d().SetTranslate(centre + Gf.Vec3d(0, 0, distance))
    else:
        turned = Gf.Matrix4d().SetRotate(Gf.Rotation(Gf.Vec3d.XAxis(), 90))
        camera.transform = turned.SetTranslateOnly(centre + Gf.Vec3d(0, -distance, 0))
    camera.clippingRange = Gf.Range1f(min(1.0, distance * 1e-3), max(1e6, distance * 10))
    return camera
