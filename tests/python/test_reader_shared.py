"""Scenes that nobody here wrote, under a shutter of a whole frame: positions against usd-core's own
evaluation."""

from __future__ import annotations

import numpy as np
import pytest
from msbvh.errors import Diagnostics, SceneError
from msbvh.reader import ReadResult, ReadSettings, read_frame
from msbvh.stage import open_stage
from pxr import Gf, Usd, UsdGeom
from recording import DENSE_TIMES01, Recording, interpolated, points_at, usd_points_at
from shared_scenes import MOTION_GROUPS, SharedScene, shared_scenes

SCENES = shared_scenes(*MOTION_GROUPS, "edge")


def read(shared: SharedScene) -> tuple[Usd.Stage, ReadResult]:
    """A frame through a camera of our own, in the session layer, far enough to see everything."""
    stage = open_stage(str(shared.path), Diagnostics())
    frame = float(shared.frame) if shared.frame else stage.GetStartTimeCode()
    bounds = UsdGeom.BBoxCache(frame, ["default", "proxy"]).ComputeWorldBound(stage.GetPseudoRoot())
    box = bounds.ComputeAlignedRange()
    eye = box.GetMidpoint() + Gf.Vec3d(0, 0, 1.5 * max(box.GetSize())) if not box.IsEmpty() else Gf.Vec3d(0)
    stage.SetEditTarget(stage.GetSessionLayer())
    camera = UsdGeom.Camera.Define(stage, "/TestCamera")
    camera.AddTranslateOp().Set(eye)
    camera.CreateShutterOpenAttr(-0.5)
    camera.CreateShutterCloseAttr(0.5)
    settings = ReadSettings(camera="/TestCamera")
    return stage, read_frame(stage, frame, settings, Diagnostics(), Recording)


def check(result: ReadResult, found: np.ndarray, expected: np.ndarray) -> None:
    """Within a tenth of a pixel, or within the rounding of single-precision points."""
    assert found.shape == expected.shape
    if not len(found):
        return
    rounding = 1e-6 * np.abs(expected).max()
    pixel = result.camera.pixel_size().nearest(expected[None, None])[0]
    assert np.linalg.norm(found - expected, axis=-1).max() <= 0.1 * pixel + rounding


def held(result: ReadResult) -> set[str]:
    """Meshes that stand still because their topology changes, as their warnings say."""
    return {d.path for d in result.diagnostics if "held the frame's pose" in d.message}


@pytest.mark.parametrize("shared", SCENES or [None], ids=str)
def test_meshes_in_the_world(shared: SharedScene | None) -> None:
    if shared is None:
        pytest.skip("../shared/scenes is not on this machine")
    try:
        stage, result = read(shared)
    except SceneError as error:  # Files that are broken on purpose.
        assert shared.group == "edge" and "\n" not in str(error)
        return
    shutter = result.camera.shutter
    for path, mesh in result.scene.meshes.items():
        prim = stage.GetPrimAtPath(path.partition("#")[0])
        if not prim.IsA(UsdGeom.Mesh) or path in held(result):
            continue
        times = DENSE_TIMES01 if len(mesh["points"]) + len(mesh["transforms"]) > 2 else [0.0, 1.0]
        for time01 in times:
            expected = usd_points_at(prim, shutter.time_code(time01), shutter.frame_code)
            check(result, points_at(mesh, time01), expected)


@pytest.mark.parametrize("shared", [s for s in SCENES if s.group != "edge"] or [None], ids=str)
def test_point_instancers_in_the_world(shared: SharedScene | None) -> None:
    if shared is None:
        pytest.skip("../shared/scenes is not on this machine")
    stage, result = read(shared)
    shutter = result.camera.shutter
    paths = {str(p.GetPath()) for p in stage.Traverse() if p.IsA(UsdGeom.PointInstancer) and _stands_alone(p)}
    failed = {d.path for d in result.diagnostics if d.severity == "error"}
    for path in sorted(paths - failed):
        instancer = UsdGeom.PointInstancer.Get(stage, path)
        if not UsdGeom.Imageable(instancer).ComputeVisibility(shutter.frame_code) == UsdGeom.Tokens.inherited:
            continue
        parts = [i for i in result.scene.instances if i["path"] == path]
        for time01 in DENSE_TIMES01:
            code = shutter.time_code(time01)
            world = np.array(UsdGeom.XformCache(code).GetLocalToWorldTransform(instancer.GetPrim()))
            local = np.array(instancer.ComputeInstanceTransformsAtTime(code, shutter.frame_code))
            expected = (local.reshape(-1, 4, 4) @ world)[:, 3, :3]
            matrices = [interpolated(i["times01"], i["matrices"], time01) for i in parts]
            found = np.concatenate([np.zeros((0, 4, 4)), *matrices])[:, 3, :3]
            check(result, _in_the_order_of(expected, found), expected)


def _stands_alone(prim: Usd.Prim) -> bool:
    """Prototypes are meshes and nothing else, so that every instance arrives once under the instancer's own
    path."""
    targets = [
        prim.GetStage().GetPrimAtPath(p) for p in UsdGeom.PointInstancer(prim).GetPrototypesRel().GetTargets()
    ]
    inside = any(
        UsdGeom.PointInstancer(prim.GetStage().GetPrimAtPath(p)) for p in prim.GetPath().GetPrefixes()[:-1]
    )
    return (
        bool(targets)
        and not inside
        and all(
            target
            and not target.IsInstance()
            and not any(p.IsA(UsdGeom.PointInstancer) or p.IsInstance() for p in Usd.PrimRange(target))
            and any(p.IsA(UsdGeom.Mesh) for p in Usd.PrimRange(target))
            for target in targets
        )
    )


def _in_the_order_of(expected: np.ndarray, found: np.ndarray) -> np.ndarray:
    """The nearest found point to each expected one: instances arrive in groups of those that move alike."""
    assert found.shape == expected.shape
    if not len(found):
        return found
    squared = (expected**2).sum(axis=1)[:, None] - 2 * expected @ found.T + (found**2).sum(axis=1)
    return found[squared.argmin(axis=1)]
