"""What generated scenes share: units, a camera with an open shutter, a sun, a ground, and meshes of triangles."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from pxr import Gf, Usd, UsdGeom, UsdLux, Vt

FRAME = 1
"""The frame that is rendered; time samples lie around it."""
SHUTTER = (-0.25, 0.25)
CAMERA = "/camera"
IRRADIANCE = 3.0
"""Of the sun on a surface that faces it: a normalised light's intensity."""
RATE = 24.0
Colour = tuple[float, float, float]


@dataclass(frozen=True)
class Shape:
    """Triangles: float32[P, 3] and int32[T, 3]."""

    points: np.ndarray
    triangles: np.ndarray


def setting(stage: Usd.Stage) -> None:
    """Units, camera, sun and ground, which all scenes share."""
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    stage.SetTimeCodesPerSecond(RATE)
    stage.SetFramesPerSecond(RATE)
    stage.SetStartTimeCode(FRAME)
    stage.SetEndTimeCode(FRAME)
    camera = UsdGeom.Camera.Define(stage, CAMERA)
    view = Gf.Matrix4d().SetLookAt(Gf.Vec3d(0, -16, 6), Gf.Vec3d(0, 0, 0), Gf.Vec3d(0, 0, 1))
    camera.AddTransformOp().Set(view.GetInverse())
    camera.CreateFocalLengthAttr(45.0)
    camera.CreateHorizontalApertureAttr(36.0)
    camera.CreateVerticalApertureAttr(24.0)
    camera.CreateClippingRangeAttr(Gf.Vec2f(0.1, 1000.0))
    camera.CreateShutterOpenAttr(SHUTTER[0])
    camera.CreateShutterCloseAttr(SHUTTER[1])
    sun = UsdLux.DistantLight.Define(stage, "/sun")
    sun.CreateIntensityAttr(IRRADIANCE)
    sun.CreateAngleAttr(0.53)
    sun.CreateNormalizeAttr(True)
    sun.AddRotateXYZOp().Set(Gf.Vec3f(40.0, 0.0, 30.0))
    corners = np.array([[-20, -20, -3], [20, -20, -3], [20, 20, -3], [-20, 20, -3]], np.float32)
    add_mesh(stage, "/ground", Shape(corners, np.array([[0, 1, 2], [0, 2, 3]], np.int32)), (0.6, 0.6, 0.6))


def add_mesh(stage: Usd.Stage, path: str, shape: Shape, colour: Colour) -> UsdGeom.Mesh:
    mesh = UsdGeom.Mesh.Define(stage, path)
    mesh.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(shape.points))
    mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(shape.triangles.ravel()))
    mesh.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(np.full(len(shape.triangles), 3, np.int32)))
    mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    mesh.CreateDisplayColorAttr([Gf.Vec3f(*colour)])
    mesh.CreateDoubleSidedAttr(True)
    return mesh


def sheet(faces: int, place: Callable[[np.ndarray, np.ndarray], Sequence[np.ndarray]]) -> Shape:
    """`faces` x `faces` squares, two triangles each, where `place` puts the points of [0, 1] x [0, 1]."""
    across = np.linspace(0.0, 1.0, faces + 1)
    u, v = np.meshgrid(across, across, indexing="ij")
    points = np.stack(place(u, v), axis=-1).reshape(-1, 3).astype(np.float32)
    first = (np.arange(faces)[:, None] * (faces + 1) + np.arange(faces)).ravel()
    a, b, c, d = first, first + faces + 1, first + faces + 2, first + 1
    triangles = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    return Shape(points, triangles.astype(np.int32))


def torus(faces: int, radius: float, tube: float) -> Shape:
    def place(u: np.ndarray, v: np.ndarray) -> Sequence[np.ndarray]:
        around, across = 2 * np.pi * u, 2 * np.pi * v
        reach = radius + tube * np.cos(across)
        return reach * np.cos(around), reach * np.sin(around), tube * np.sin(across)

    return sheet(faces, place)


def faces_for(side: int, detail: float, least: int = 8) -> int:
    return max(least, round(side * detail))
