"""Scenes that are hard on a refit, for refit_frames.py: a column that is wound up, and shards that fly apart.

    .venv/bin/python bench/refit_scenes.py DIR

DIR/twist.usdc: 40000 triangles of a ribbed column, its top an eighth of a turn further each frame.
DIR/burst.usdc: 40000 shards of a ball, each with a velocity of its own. Both at rest in frame 0, to frame 32.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
from pxr import Usd, UsdGeom, Vt

FRAMES = 32
COUNT = 40_000
SIDE = 100
"""Quads around the column; as many along it as make COUNT triangles."""


def column() -> tuple[np.ndarray, np.ndarray]:
    """Points [N, 3] and triangles [COUNT, 3] of a ribbed tube along y."""
    rows = COUNT // (2 * SIDE)
    angle, height = np.meshgrid(np.arange(SIDE) * 2 * np.pi / SIDE, np.linspace(-2.0, 2.0, rows + 1))
    radius = 1.0 + 0.3 * np.sin(12 * angle)
    points = np.stack([radius * np.cos(angle), height, radius * np.sin(angle)], axis=-1).reshape(-1, 3)
    row, side = np.meshgrid(np.arange(rows), np.arange(SIDE), indexing="ij")
    a, b = row * SIDE + side, row * SIDE + (side + 1) % SIDE
    triangles = np.stack([np.stack([a, b, a + SIDE], -1), np.stack([b, b + SIDE, a + SIDE], -1)], axis=2)
    return points, triangles.reshape(-1, 3)


def twisted(points: np.ndarray, frame: float) -> np.ndarray:
    angle = frame * np.pi / 4 * (points[:, 1] + 2.0) / 4.0
    c, s = np.cos(angle), np.sin(angle)
    x, y, z = points.T
    return np.stack([c * x - s * z, y, s * x + c * z], axis=1)


def write(path: Path, triangles: np.ndarray, points_at: Callable[[float], np.ndarray]) -> None:
    """A mesh that has points_at() at every frame, and a camera that sees it."""
    stage = Usd.Stage.CreateNew(str(path))
    stage.SetStartTimeCode(0)
    stage.SetEndTimeCode(FRAMES)
    mesh = UsdGeom.Mesh.Define(stage, "/mesh")
    mesh.CreateSubdivisionSchemeAttr("none")
    mesh.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(np.full(len(triangles), 3, np.int32)))
    mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(triangles.astype(np.int32).ravel()))
    for frame in range(-1, FRAMES + 2):
        points = np.ascontiguousarray(points_at(float(frame)), np.float32)
        mesh.CreatePointsAttr().Set(Vt.Vec3fArray.FromNumpy(points), frame)
    camera = UsdGeom.Camera.Define(stage, "/main_cam")
    camera.CreateShutterOpenAttr(-0.25)
    camera.CreateShutterCloseAttr(0.25)
    camera.AddTranslateOp().Set((0.0, 0.0, 11.0))
    stage.Save()


def main(folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    points, triangles = column()
    write(folder / "twist.usdc", triangles, lambda frame: twisted(points, frame))
    random = np.random.default_rng(1)
    centre = random.normal(size=(COUNT, 1, 3))
    centre *= random.random((COUNT, 1, 1)) ** (1 / 3) / np.linalg.norm(centre, axis=2, keepdims=True)
    shards = (centre + random.uniform(-0.03, 0.03, (COUNT, 3, 3))).reshape(-1, 3)
    velocity = np.repeat(random.normal(scale=0.06, size=(COUNT, 3)), 3, axis=0)
    free = np.arange(3 * COUNT).reshape(-1, 3)
    write(folder / "burst.usdc", free, lambda frame: shards + max(frame, 0.0) * velocity)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
