"""Cameras that move: their tracks as rays are made from them, against usd-core's own evaluation at 33 times, in
pixels at several depths."""

from __future__ import annotations

import numpy as np
import pytest
from msbvh.base.errors import Diagnostics
from msbvh.camera.aspect import conformed
from msbvh.camera.render_camera import find_camera
from msbvh.scene.reader import ReadResult, ReadSettings, read_frame
from msbvh.stage.opening import open_stage
from pxr import Gf, UsdGeom
from recording import DENSE_TIMES01, Shot
from shared_scenes import SharedScene, broken, here, scene_parameters

SHARE = 0.1
"""Of the tolerance: the camera's error adds to every object's."""
PLACES = [(x, y) for x in (0.0, 0.5, 1.0) for y in (0.0, 0.5, 1.0)]


def window_of(camera: Gf.Camera, aspect: float) -> np.ndarray:
    """left, right, bottom, top at unit distance (orthographic: in stage units)."""
    perspective = camera.projection == Gf.Camera.Perspective
    box = camera.frustum.GetWindow()
    scale = camera.frustum.GetReferencePlaneDepth() if perspective else 1.0
    (left, bottom), (right, top) = box.GetMin() / scale, box.GetMax() / scale
    return np.array(conformed((left, right, bottom, top), (aspect, 1.0), "expandAperture")[0])


def worst_pixels(result: ReadResult, camera: UsdGeom.Camera) -> float:
    """How far apart the track and usd-core see the same points: at the picture's corners, edges and middle, from
    the near plane to a thousand times as far."""
    read, worst = result.camera, 0.0
    size = np.array([read.width, read.height])
    for time01 in DENSE_TIMES01:
        truth = camera.GetCamera(read.shutter.time_code(time01))
        window = window_of(truth, read.width / read.height)
        matrix, seen, _, clip = result.scene.camera(time01)
        planes = np.array([truth.clippingRange.min, truth.clippingRange.max])
        worst = max(worst, float(np.abs(clip / planes - 1.0).max()) * read.width)
        track = np.linalg.inv(np.array(matrix))
        for multiple in (1.0, 10.0, 1000.0):
            for x, y in PLACES:
                on_plane = np.array([window[0] + x * (window[1] - window[0]), window[2] + y * (window[3] - window[2])])
                depth = multiple * max(read.near_clip, 1e-3)
                ahead = [*(on_plane * (depth if read.projection == "perspective" else 1.0)), -depth, 1.0]
                point = np.array(ahead) @ np.array(truth.transform) @ track
                found = point[:2] / (-point[2] if read.projection == "perspective" else 1.0)
                place = (found - [seen[0], seen[2]]) / [seen[1] - seen[0], seen[3] - seen[2]]
                worst = max(worst, float(np.linalg.norm((place - (x, y)) * size)))
    return worst


def rounding_pixels(result: ReadResult) -> float:
    """What single precision leaves over in the frame's world, whose origin is the camera."""
    return 1e-6 * max(result.camera.width, result.camera.height)


@pytest.mark.parametrize("tolerance", [0.1, 0.01])
def test_a_fast_zooming_camera_under_an_asymmetric_shutter(tolerance: float) -> None:
    shot = Shot((-0.2, 0.5))
    turn = shot.camera.AddRotateYOp()
    for time, degrees, focal in ((9.0, 0.0, 20.0), (10.0, 30.0, 35.0), (10.3, 36.0, 80.0), (11.0, 90.0, 50.0)):
        turn.Set(degrees, time)
        shot.camera.CreateClippingRangeAttr().Set(Gf.Vec2f(focal / 20, 1000 * focal), time)
        shot.camera.CreateFocalLengthAttr().Set(focal, time)
    shot.mesh("/Mesh")
    settings = ReadSettings(motion_tolerance=tolerance)
    result = read_frame(shot.stage, 10.0, settings, Diagnostics())
    assert result.tracks[0].segments > 0
    assert worst_pixels(result, shot.camera) <= SHARE * tolerance + rounding_pixels(result)


def without_camera(shared: SharedScene) -> str:
    return broken(shared) or ("" if shared.has_camera else "has no camera")


@pytest.mark.shared
@pytest.mark.parametrize("tolerance", [0.1, 0.01])
@pytest.mark.parametrize("shared", scene_parameters(without_camera))
def test_cameras_of_public_scenes(shared: SharedScene | None, tolerance: float) -> None:
    shared = here(shared)
    stage = open_stage(str(shared.path), Diagnostics())
    prim = find_camera(stage, None, Diagnostics())
    assert prim is not None
    camera = UsdGeom.Camera(prim)
    frame = float(shared.frame) if shared.frame else stage.GetStartTimeCode()
    stage.SetEditTarget(stage.GetSessionLayer())
    if not prim.IsInstanceProxy():
        camera.GetShutterOpenAttr().Set(-0.3)
        camera.GetShutterCloseAttr().Set(0.7)
    result = read_frame(stage, frame, ReadSettings(camera=str(prim.GetPath()), motion_tolerance=tolerance))
    assert worst_pixels(result, camera) <= SHARE * tolerance + rounding_pixels(result)
