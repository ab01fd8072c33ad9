"""Skinned public scenes: points that USD's own tool has baked, and UsdSkel at dense times."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from msbvh.base.errors import Diagnostics
from msbvh.scene.implicit import SIDES
from msbvh.scene.reader import ReadSettings, read_frame
from pxr import Gf, Usd, UsdGeom
from recording import Recording, interpolated, messages, points_at
from shared_scenes import SCENES, require
from skinning_oracle import pixels, usd_skinned_points, worst_skinned_deviation

SKINNED = SCENES / "skinned"
BAKED = SKINNED / "usdSkelBakeSkinning"
RELATIVE = 1e-4
"""Of the size of the mesh: the baked text has seven digits, and was made in single precision."""

pytestmark = pytest.mark.shared


@pytest.fixture(autouse=True)
def _scenes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Implicit shapes of one fineness, as the truth has them: points are compared by their number."""
    require(SKINNED)
    monkeypatch.setattr("msbvh.scene.implicit.SIDE_COUNTS", (SIDES,))


def read(stage: Usd.Stage, frame: float | None, **settings: Any) -> Any:
    return read_frame(stage, frame, ReadSettings(outside_tolerance=1.0, **settings), Diagnostics(), Recording)


def with_camera(path: Path, shutter: tuple[float, float]) -> Usd.Stage:
    """The scene with a camera of ours, 20 units off, in the session layer."""
    stage = Usd.Stage.Open(str(path))
    stage.SetEditTarget(stage.GetSessionLayer())
    camera = UsdGeom.Camera.Define(stage, "/TestCamera")
    camera.AddTranslateOp().Set(Gf.Vec3d(0, 0, 20))
    camera.CreateShutterOpenAttr(shutter[0])
    camera.CreateShutterCloseAttr(shutter[1])
    return stage


@pytest.mark.parametrize(
    ("source", "baked"),
    [
        ("lbs", "lbs.baked"),
        ("dqs", "dqs.baked"),
        ("blendshapes", "blendshapes.baked"),
        ("blendshapesWithNormals", "blendshapesWithNormals.baked"),
        ("lbs", "lbs.bakedInterval"),
        ("dqs", "dqs.bakedInterval"),
    ],
)
def test_poses_are_those_that_usdskelbakeskinning_wrote(source: str, baked: str):
    stage, truth = (Usd.Stage.Open(str(BAKED / name)) for name in (f"{source}.usda", f"baseline/{baked}.usda"))
    frames = baked_frames(truth)
    assert len(frames) >= 5
    for frame in frames:
        found, expected = read(stage, frame).scene.meshes, read(truth, frame).scene.meshes
        assert found.keys() == expected.keys()
        for path, mesh in found.items():
            points, true_points = points_at(mesh, 0.0), points_at(expected[path], 0.0)
            size = np.ptp(true_points, axis=0).max()
            assert np.abs(points - true_points).max() <= RELATIVE * size, (path, frame)


def baked_frames(stage: Usd.Stage) -> list[float]:
    """Where any mesh has baked points."""
    meshes = [UsdGeom.Mesh(prim) for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh)]
    return sorted({time for mesh in meshes for time in mesh.GetPointsAttr().GetTimeSamples()})


@pytest.mark.parametrize(
    ("source", "path"),
    [
        ("lbs", "/Root/MeshWithNormals"),
        ("dqs", "/Root/MeshWithNormals"),
        ("lbs", "/Root/MeshWithFaceVaryingNormals"),
        ("dqs", "/Root/MeshWithFaceVaryingNormals"),
        ("blendshapesWithNormals", "/TestPlane/Mesh"),
    ],
)
def test_normals_are_those_that_usdskelbakeskinning_wrote(source: str, path: str):
    stage = Usd.Stage.Open(str(BAKED / f"{source}.usda"))
    truth = Usd.Stage.Open(str(BAKED / f"baseline/{source}.baked.usda"))
    attribute = UsdGeom.Mesh(truth.GetPrimAtPath(path)).GetNormalsAttr()
    assert attribute.GetTimeSamples()
    for frame in attribute.GetTimeSamples():
        found, expected = (world_normals(read(scene, frame).scene.meshes[path]) for scene in (stage, truth))
        assert np.abs(found - expected).max() <= 1e-4, frame


def world_normals(mesh: dict) -> np.ndarray:
    matrix = interpolated(mesh["transform"].times01, mesh["transform"].matrices, 0.0)
    normals = mesh["normals"][0][1] @ np.linalg.inv(matrix[:3, :3]).T
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)


@pytest.mark.parametrize(
    ("scene", "frame", "camera"),
    [
        ("usdgl_SkelSkinning/test_lbs.usda", 15.0, "/TestCamera"),
        ("usdgl_SkelSkinning/test_lbs.usda", 75.0, "/TestCamera"),
        ("usdgl_SkelSkinning/test_dqs.usda", 75.0, "/TestCamera"),
        ("usdgl_SkelSkinning/test_dqs.usda", 89.9, "/TestCamera"),
        ("usdSkelBakeSkinning/blendshapes.usda", 2.5, "/TestCamera"),
        ("arnold_1443/data/test.usda", 3.0, "/Cameras/camera"),
        ("CesiumMan/CesiumMan.usdz", 12.0, "/TestCamera"),
    ],
)
@pytest.mark.parametrize("shutter", [(-0.5, 0.5), (0.0, 4.0)])
def test_motion_is_usdskel_s_at_dense_times(scene: str, frame: float, camera: str, shutter: tuple[float, float]):
    stage = with_camera(SKINNED / scene, shutter)
    result = read(stage, frame, camera=camera)
    skinned = [stage.GetPrimAtPath(path) for path in result.scene.meshes if is_skinned(stage, path)]
    assert skinned
    for prim in skinned:
        units = worst_skinned_deviation(result, prim)
        points = usd_skinned_points(prim, Usd.TimeCode(frame))
        rounding = 1e-6 * np.abs(points).max()  # UsdSkel's own, in single precision
        assert pixels(result, prim, max(units - rounding, 0.0)) <= 0.05, units


def is_skinned(stage: Usd.Stage, path: str) -> bool:
    prim = stage.GetPrimAtPath(path)
    names = ("primvars:skel:jointIndices", "skel:blendShapes")
    return prim.IsA(UsdGeom.Mesh) and any(prim.GetAttribute(name).HasAuthoredValue() for name in names)


def test_a_crowd_of_instances_and_copies_stands_where_usdskel_puts_it():
    stage = Usd.Stage.Open(str(SKINNED / "arnold_1352/data/test.usd"))
    result = read(stage, 1600.0)
    assert not messages(result, "error")
    poses = {mesh: points[0] for mesh, _, points in result.scene.poses(0.0)}
    skinned = [path for path in poses if is_skinned(stage, path)]
    assert len(skinned) == 22
    for path in skinned:
        expected = usd_skinned_points(stage.GetPrimAtPath(path), Usd.TimeCode(1600.0))
        found = poses[path]
        assert np.abs(found - expected).max() <= RELATIVE * np.ptp(expected, axis=0).max(), path
