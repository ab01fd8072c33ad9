"""Subdivided cages over the frames of a run: refined once, and pictures as of frames by themselves."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import Run
from exr import read_exr
from msbvh import _core
from msbvh.scene.reader import ReadSettings, read_frame
from pxr import Gf, UsdGeom, Vt
from recording import Shot
from subdivision_stages import CORNERS, cube, sheet

SMALL = ("-w", 64, "--spp", 2)
FRAMES = (8.0, 9.0, 10.0, 11.0)


def moving_scene(folder: Path, camera_moves: bool) -> Path:
    """A cube that breathes, one that slides under a transform, a still one of the same faces, and a still sheet."""
    shot = Shot((-0.25, 0.25))
    breathing = cube(shot, "/Breathing")
    for time in (7.0, 9.0, 12.0):
        points = (CORNERS * (1.0 + 0.15 * (time - 9.0))).astype(np.float32)
        breathing.GetPointsAttr().Set(Vt.Vec3fArray.FromNumpy(points), time)
    slide = cube(shot, "/Sliding").AddTranslateOp()
    slide.Set(Gf.Vec3d(-3, 2, 0), 7.0)
    slide.Set(Gf.Vec3d(3, 2, 0), 12.0)
    cube(shot, "/Still").AddTranslateOp().Set(Gf.Vec3d(0, -2.5, 0))
    sheet(shot, 4).AddTranslateOp().Set(Gf.Vec3d(0, 0, -4))
    if camera_moves:
        eye = next(op for op in shot.camera.GetOrderedXformOps() if op.GetOpType() == UsdGeom.XformOp.TypeTranslate)
        for time, z in ((7.0, 20.0), (12.0, 9.0)):
            eye.Set(Gf.Vec3d(0, 0, z), time)
    path = folder / "scene.usda"
    shot.stage.GetRootLayer().Export(str(path))
    return path


def recorded(msbvh: Run, folder: Path, scene: Path, frames: str, refit: str) -> tuple[list[np.ndarray], list[Any]]:
    done = msbvh(
        "record", scene, f"{refit}.###.exr", "-f", frames, "--refit", refit, "--stats", "stats.json", *SMALL
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    figures = json.loads((folder / "stats.json").read_text())["frames"]
    return [read_exr(folder / frame["output"][0]) for frame in figures], figures


@pytest.mark.parametrize("camera_moves", [False, True], ids=["still camera", "moving camera"])
@pytest.mark.parametrize("refit", ["auto", "always", "never"])
def test_a_sequence_is_the_frames_alone(msbvh: Run, tmp_path: Path, camera_moves: bool, refit: str) -> None:
    scene = moving_scene(tmp_path, camera_moves)
    together, figures = recorded(msbvh, tmp_path, scene, "8:11", refit)
    for frame, picture in zip(FRAMES, together, strict=True):
        (alone,), _ = recorded(msbvh, tmp_path, scene, f"{frame:g}", "never")
        assert np.array_equal(picture, alone)
    assert not np.array_equal(together[0], together[1])
    first, *others = [frame["subdivision"] for frame in figures]
    # Three cubes have one topology.
    assert (first["cages_made"], first["cages_kept"]) == (2, 2)
    for counts in others:
        assert (counts["cages_made"], counts["cages_kept"]) == (0, 4)
        assert counts["meshes_made"] + counts["meshes_kept"] == 4
        if not camera_moves:
            assert counts["meshes_kept"] >= 2  # what stands still is seen at the same rates


def test_frames_in_another_order_are_the_same_frames() -> None:
    shot = Shot((-0.25, 0.25))
    mesh = cube(shot)
    for time in (7.0, 12.0):
        mesh.GetPointsAttr().Set(Vt.Vec3fArray.FromNumpy((CORNERS * time / 8).astype(np.float32)), time)
    kept = _core.RefinementCache()

    def points(frame: float, cache: _core.RefinementCache | None) -> np.ndarray:
        result = read_frame(shot.stage, frame, ReadSettings(width=200), refinements=cache)
        return np.concatenate([p[0] for _, _, p in result.scene.poses(0.3)])

    for frame in (11.0, 8.0, 10.0, 8.0, 11.0):
        assert np.array_equal(points(frame, kept), points(frame, None))
    assert kept.counts["cages_made"] == 1
    assert kept.counts["meshes_kept"] >= 2


def test_memory_of_what_is_kept_is_bounded() -> None:
    shot = Shot((0.0, 0.0))
    cube(shot)
    for size, kept in ((0, _core.RefinementCache(0)), (10**6, _core.RefinementCache(10**6))):
        for width in (100, 200, 300, 400, 100):
            read_frame(shot.stage, 10.0, ReadSettings(width=width), refinements=kept)
            assert kept.bytes <= size
        assert kept.counts["cages_kept"] == (0 if size == 0 else 4)


def test_the_translator_takes_nothing_else() -> None:
    shot = Shot((0.0, 0.0))
    cube(shot)
    with pytest.raises(TypeError, match="refinements"):
        read_frame(shot.stage, 10.0, ReadSettings(), refinements=3)  # type: ignore[arg-type]
