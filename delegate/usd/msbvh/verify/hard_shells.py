"""Closed shells in motions that break renderers: what `msbvh verify` looks at where no scene is given."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from pxr import Gf, Usd, UsdGeom, Vt

FRAME = 1.0
RINGS = 12
SHUTTER = (-0.5, 0.5)
"""That they are made for, in frames around it."""


def hard_shells() -> dict[str, Usd.Stage]:
    """A stage for each motion, by its name: to be read at FRAME with SHUTTER. None has a camera."""
    return {name: _stage(fill) for name, fill in _MOTIONS.items()}


def _stage(fill: Callable[[Usd.Stage], None]) -> Usd.Stage:
    stage = Usd.Stage.CreateInMemory()
    stage.SetStartTimeCode(FRAME)
    stage.SetEndTimeCode(FRAME)
    stage.SetTimeCodesPerSecond(24.0)
    fill(stage)
    return stage


def _ball() -> tuple[np.ndarray, np.ndarray]:
    """A closed unit ball: float32[P, 3] and int32[T, 3], facing outwards."""
    down = np.pi * np.arange(1, RINGS) / RINGS
    around = np.pi * np.arange(2 * RINGS) / RINGS
    ring = np.stack([np.cos(around), np.sin(around)], axis=-1)
    sides = np.concatenate(
        [np.sin(down)[:, None, None] * ring, np.broadcast_to(np.cos(down)[:, None, None], (RINGS - 1, 2 * RINGS, 1))],
        axis=-1,
    )
    points = np.concatenate([[[0.0, 0.0, 1.0]], sides.reshape(-1, 3), [[0.0, 0.0, -1.0]]]).astype(np.float32)
    last, triangles = len(points) - 1, []
    for k in range(2 * RINGS):
        after = (k + 1) % (2 * RINGS)
        triangles.append((0, 1 + k, 1 + after))
        for row in range(RINGS - 2):
            a, b = 1 + row * 2 * RINGS, 1 + (row + 1) * 2 * RINGS
            triangles += [(a + k, b + k, b + after), (a + k, b + after, a + after)]
        first = 1 + (RINGS - 2) * 2 * RINGS
        triangles.append((first + k, last, first + after))
    return points, np.array(triangles, np.int32)


def _mesh(stage: Usd.Stage, path: str = "/ball") -> UsdGeom.Mesh:
    points, triangles = _ball()
    mesh = UsdGeom.Mesh.Define(stage, path)
    mesh.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(points))
    mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(triangles.ravel()))
    mesh.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(np.full(len(triangles), 3, np.int32)))
    mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    return mesh


def _deform(mesh: UsdGeom.Mesh, move: Callable[[np.ndarray, float], np.ndarray], samples: int) -> None:
    points, _ = _ball()
    for k in range(samples + 1):
        step = k / samples - 0.5
        moved = move(points.astype(np.float64), step)
        mesh.GetPointsAttr().Set(Vt.Vec3fArray.FromNumpy(moved.astype(np.float32)), FRAME + step)


def _still(stage: Usd.Stage) -> None:
    _mesh(stage)


def _whole_turns(stage: Usd.Stage) -> None:
    turn = _mesh(stage).AddRotateXYZOp()
    for step in (-1.0, 1.0):
        turn.Set(Gf.Vec3f(0.0, 720.0, 360.0) * step, FRAME + step)


def _far_away(stage: Usd.Stage) -> None:
    move = _mesh(stage).AddTranslateOp()
    for step in (-1.0, 1.0):
        move.Set(Gf.Vec3d(1e6 + 3.0 * step, -1e6, 2.0 * step), FRAME + step)


def _tiny(stage: Usd.Stage) -> None:
    mesh = _mesh(stage)
    move = mesh.AddTranslateOp()
    mesh.AddScaleOp().Set(Gf.Vec3f(1e-6))
    for step in (-1.0, 1.0):
        move.Set(Gf.Vec3d(2e-6 * step, 0.0, 0.0), FRAME + step)


def _inside_out(stage: Usd.Stage) -> None:
    """Through zero volume at the middle of the shutter."""
    _deform(_mesh(stage), lambda points, step: points * (-2.0 * step), 2)


def _sheared(stage: Usd.Stage) -> None:
    """Sixteen samples that go back and forth, so that many segments are needed."""

    def move(points: np.ndarray, step: float) -> np.ndarray:
        slant = np.sin(40.0 * step)
        return points + np.stack([slant * points[:, 2], 0.3 * slant * points[:, 0], 0.0 * points[:, 0]], axis=-1)

    _deform(_mesh(stage), move, 16)


def _accelerated(stage: Usd.Stage) -> None:
    """By velocities and accelerations of each point: a quadratic track."""
    mesh = _mesh(stage)
    points, _ = _ball()
    mesh.GetPointsAttr().Set(Vt.Vec3fArray.FromNumpy(points), FRAME)
    mesh.CreateVelocitiesAttr().Set(Vt.Vec3fArray.FromNumpy(24.0 * points[:, [1, 2, 0]]), FRAME)
    mesh.CreateAccelerationsAttr().Set(Vt.Vec3fArray.FromNumpy(-576.0 * points[:, [2, 0, 1]]), FRAME)


def _instanced(stage: Usd.Stage) -> None:
    """Tumbling instances, placed closely."""
    instancer = UsdGeom.PointInstancer.Define(stage, "/balls")
    _mesh(stage, "/balls/ball")
    instancer.CreatePrototypesRel().AddTarget("/balls/ball")
    places = [Gf.Vec3f(1.5 * x, 1.5 * y, 0.2 * x * y) for x in range(4) for y in range(4)]
    instancer.CreateProtoIndicesAttr([0] * len(places))
    instancer.CreatePositionsAttr().Set(places, FRAME)
    instancer.CreateVelocitiesAttr().Set([Gf.Vec3f(24.0, -12.0 * k, 6.0) for k in range(len(places))], FRAME)
    instancer.CreateAngularVelocitiesAttr().Set([Gf.Vec3f(4000.0, 90.0 * k, 700.0) for k in range(len(places))], FRAME)


_MOTIONS: dict[str, Callable[[Usd.Stage], None]] = {
    "still": _still,
    "whole turns": _whole_turns,
    "a million units away": _far_away,
    "a millionth as large": _tiny,
    "inside out": _inside_out,
    "sheared back and forth": _sheared,
    "accelerated": _accelerated,
    "tumbling instances": _instanced,
}
