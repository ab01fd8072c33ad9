"""Every public scene that moves, under a shutter of a whole frame: the tracks as they are traced against usd-core's
own evaluation at 33 times, in pixels of a camera that sees everything."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

import numpy as np
import pytest
from msbvh.base.errors import Diagnostics
from msbvh.scene.implicit import SIDES
from msbvh.scene.reader import ReadResult, ReadSettings, read_frame
from msbvh.stage.opening import open_stage
from pxr import Gf, Usd, UsdGeom
from recording import DENSE_TIMES01
from shared_scenes import SharedScene, here, scene_parameters
from stage_truth import StageTruth

SHUTTER = (-0.5, 0.5)
TOLERANCES = (0.1, 0.01)
"""Pixels."""
LARGEST_MATCH = 2**22
"""Pairs of instances that are compared at once."""


@pytest.fixture(autouse=True)
def implicit_shapes_of_one_fineness(monkeypatch: pytest.MonkeyPatch) -> None:
    """As the truth has them, whatever their size in pixels: points are compared by their number."""
    monkeypatch.setattr("msbvh.scene.implicit.SIDE_COUNTS", (SIDES,))


@dataclass
class Frame:
    """A frame read, and what usd-core says of it."""

    truth: StageTruth
    result: ReadResult


def read(shared: SharedScene, tolerance: float) -> Frame:
    """Through a camera of our own, in the session layer, far enough to see everything."""
    stage = open_stage(str(shared.path), Diagnostics())
    frame = float(shared.frame) if shared.frame else stage.GetStartTimeCode()
    bounds = UsdGeom.BBoxCache(frame, ["default", "proxy"]).ComputeWorldBound(stage.GetPseudoRoot())
    box = bounds.ComputeAlignedRange()
    size = 0.0 if box.IsEmpty() else max(box.GetSize())
    eye = (Gf.Vec3d(0) if box.IsEmpty() else box.GetMidpoint()) + Gf.Vec3d(0, 0, 1.5 * size or 10.0)
    stage.SetEditTarget(stage.GetSessionLayer())
    camera = UsdGeom.Camera.Define(stage, "/TestCamera")
    camera.AddTranslateOp().Set(eye)
    camera.CreateShutterOpenAttr(SHUTTER[0])
    camera.CreateShutterCloseAttr(SHUTTER[1])
    # Cages: a surface is linear in its cage, and the stage knows no other points.
    settings = ReadSettings(camera="/TestCamera", motion_tolerance=tolerance, outside_tolerance=1.0, edge_length=0.0)
    result = read_frame(stage, frame, settings, Diagnostics())
    return Frame(StageTruth(with_single_orientations(stage), frame, SHUTTER), result)


def with_single_orientations(stage: Usd.Stage) -> Usd.Stage:
    """The stage with the very same orientations in single precision: usd-core rounds what it interpolates to the
    precision of the attribute, which for half is a tenth of a pixel on objects of some hundred pixels."""
    for prim in list(stage.Traverse()):
        instancer = UsdGeom.PointInstancer(prim)
        half = instancer.GetOrientationsAttr() if instancer else None
        if half and half.GetNumTimeSamples() and not instancer.GetOrientationsfAttr().HasAuthoredValue():
            for time in half.GetTimeSamples():
                values = [Gf.Quatf(quaternion) for quaternion in half.Get(time) or ()]
                instancer.CreateOrientationsfAttr().Set(values, time)
    return stage


def moves(result: ReadResult) -> bool:
    """Whether anything has a track or a part of the shutter to itself."""
    return any(track.segments > 0 or track.hidden_partly for track in result.tracks)


def found_points(result: ReadResult, time01: float, stage: Usd.Stage) -> dict[int, np.ndarray]:
    """float64[K, N, 3] of all meshes with N vertices, but for NURBS patches, whose vertices usd-core does not know:
    test_nurbs_patch.py holds them against their definition."""
    found = defaultdict(list)
    for path, _, points in result.scene.poses(time01):
        if not stage.GetPrimAtPath(path).IsA(UsdGeom.NurbsPatch):
            found[points.shape[1]].append(points)
    return {count: np.concatenate(parts) for count, parts in found.items()}


def expected_points(truth: StageTruth, time: float) -> dict[int, np.ndarray]:
    """Likewise; what has no face is not drawn."""
    expected = defaultdict(list)
    for drawn in truth.polygons(time, vertices=True):
        if (np.asarray(drawn.counts) >= 3).any():
            expected[len(drawn.points)].append(drawn.world_points())
    return {count: np.concatenate(parts) for count, parts in expected.items()}


def counterparts(points: np.ndarray, others: np.ndarray) -> np.ndarray:
    """float64[K, N, 3]: for each of [K, N, 3] the one of [L, N, 3] that it looks most like."""
    features = points[:, [0, points.shape[1] // 2]].reshape(len(points), -1)
    candidates = others[:, [0, others.shape[1] // 2]].reshape(len(others), -1)
    centre = candidates.mean(axis=0)
    features, candidates = features - centre, candidates - centre
    squares = (candidates**2).sum(axis=1)
    chosen = np.empty(len(points), int)
    step = max(1, LARGEST_MATCH // len(others))
    for start in range(0, len(points), step):
        part = features[start : start + step]
        chosen[start : start + step] = (squares - 2 * part @ candidates.T).argmin(axis=1)
    return others[chosen]


class Projection:
    """Points in pixels of the still test camera, which everything lies in front of."""

    def __init__(self, result: ReadResult) -> None:
        camera = result.camera
        self._camera_from_world = np.linalg.inv(camera.frame_matrix)
        left, right, _, _ = camera.frame_window
        self._pixels = camera.width / (right - left)

    def __call__(self, points: np.ndarray) -> np.ndarray:
        """float64[..., 3] to float64[..., 2]."""
        local = points @ self._camera_from_world[:3, :3] + self._camera_from_world[3, :3]
        assert (local[..., 2] < 0.0).all()
        return local[..., :2] / -local[..., 2:] * self._pixels


def worst_pixels(frame: Frame, time01: float, expected: dict[int, np.ndarray] | None = None) -> float:
    """The largest distance of any vertex from where usd-core has it, in pixels, beyond what rounding explains. `expected`:
    where that is, if it is known already."""
    result, worst = frame.result, 0.0
    seen = Projection(result)
    if expected is None:
        expected = expected_points(frame.truth, result.camera.shutter.time_code(time01).GetValue())
    found = found_points(result, time01, frame.truth.stage)
    assert set(found) == set(expected)
    for count, points in expected.items():
        rounding = 1e-6 * max(np.abs(points).max(), np.abs(result.camera.frame_matrix[3, :3]).max())
        for some, others in ((points, found[count]), (found[count], points)):
            other = counterparts(some, others)
            strayed = np.linalg.norm(some - other, axis=-1)
            pixels = np.linalg.norm(seen(some) - seen(other), axis=-1)
            # What single-precision points cannot tell apart is not counted.
            pixels *= np.maximum(1.0 - rounding / np.maximum(strayed, 1e-300), 0.0)
            worst = max(worst, float(pixels.max(initial=0.0)))
    return worst


@pytest.mark.slow
@pytest.mark.shared
@pytest.mark.parametrize("shared", scene_parameters())
def test_tracks_follow_the_stage(shared: SharedScene | None) -> None:
    frames = {tolerance: read(here(shared), tolerance) for tolerance in TOLERANCES}
    coarse = frames[max(TOLERANCES)]
    for time01 in DENSE_TIMES01 if any(moves(frame.result) for frame in frames.values()) else [0.5]:
        expected = expected_points(coarse.truth, coarse.result.camera.shutter.time_code(time01).GetValue())
        for tolerance, frame in frames.items():
            error = worst_pixels(frame, time01, expected)
            assert error <= tolerance, f"{error:.4g} pixels at {time01:.4g} of the shutter, tolerance {tolerance:g}"
