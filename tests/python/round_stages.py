"""Stages with curves and points, and what their pictures cover."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio
from msbvh.cli.main import main
from pxr import Gf, UsdGeom, Vt
from recording import Shot

PIXEL = 20 * 20.955 / 50 / 960
"""Of the default camera at the origin, in stage units."""


ZIGZAG = [(0, 0, 0), (1, 1, 0), (2, -1, 0.5), (3, 0, 0), (3.5, 1, 0), (3.5, 2, 0), (3, 3, 0)]


def curves(shot: Shot, path: str = "/Curves", points: Any = ZIGZAG, **tokens: str) -> UsdGeom.BasisCurves:
    prim = UsdGeom.BasisCurves.Define(shot.stage, path)
    prim.CreatePointsAttr([Gf.Vec3f(*p) for p in points])
    prim.CreateCurveVertexCountsAttr([len(points)])
    prim.CreateTypeAttr(tokens.get("type", "cubic"))
    prim.CreateBasisAttr(tokens.get("basis", "bezier"))
    prim.CreateWrapAttr(tokens.get("wrap", "nonperiodic"))
    prim.CreateWidthsAttr([0.25])
    prim.SetWidthsInterpolation("constant")
    return prim


def cloud(shot: Shot, path: str = "/Points", points: Any = ZIGZAG) -> UsdGeom.Points:
    prim = UsdGeom.Points.Define(shot.stage, path)
    prim.CreatePointsAttr([Gf.Vec3f(*p) for p in points])
    prim.CreateWidthsAttr([0.25] * len(points))
    return prim


def moved(points: Any, by: tuple[float, float, float]) -> Vt.Vec3fArray:
    return Vt.Vec3fArray([Gf.Vec3f(*p) + Gf.Vec3f(*by) for p in points])


def alpha(shot: Shot, folder: Path, *options: str) -> np.ndarray:
    scene, image = folder / "scene.usda", folder / "out.exr"
    shot.stage.Export(str(scene))
    arguments = ["record", str(scene), str(image), "--imageWidth", "96", "--spp", "64", "--frames", "10", *options]
    assert main(arguments) == 0
    pixels = oiio.ImageBuf(str(image)).get_pixels(oiio.FLOAT)
    return pixels[:, :, 3]


def square_camera(shot: Shot, size: float) -> None:
    """Orthographic, `size` units wide and high."""
    shot.camera.CreateProjectionAttr("orthographic")
    shot.camera.CreateHorizontalApertureAttr(size * 10)
    shot.camera.CreateVerticalApertureAttr(size * 10)
    shot.camera.CreateClippingRangeAttr(Gf.Vec2f(1, 100))


def area(shot: Shot, folder: Path, size: float = 8.0) -> float:
    """What is covered on the average over the shutter, in square units."""
    square_camera(shot, size)
    return float(alpha(shot, folder).mean()) * size * size


def oriented(shot: Shot, normals: Any, interpolation: str = "vertex") -> UsdGeom.BasisCurves:
    """A straight ribbon of 6 x 1, of two spans, across its normals."""
    prim = curves(shot, points=[(-3, 0, 0), (0, 0, 0), (3, 0, 0)], type="linear")
    prim.GetWidthsAttr().Set([1.0])
    prim.CreateNormalsAttr([Gf.Vec3f(*n) for n in normals])
    prim.SetNormalsInterpolation(interpolation)
    return prim


TILT = (0.0, 0.8, 0.6)
"""Of a ribbon along x: seen along z it is 0.6 times as wide."""


def hermite(shot: Shot, points: Any, tangents: Any, counts: list[int]) -> UsdGeom.HermiteCurves:
    prim = UsdGeom.HermiteCurves.Define(shot.stage, "/Curves")
    prim.CreatePointsAttr([Gf.Vec3f(*p) for p in points])
    prim.CreateTangentsAttr([Gf.Vec3f(*t) for t in tangents])
    prim.CreateCurveVertexCountsAttr(counts)
    prim.CreateWidthsAttr([0.25])
    prim.SetWidthsInterpolation("constant")
    return prim


def bezier_points(result: Any, path: str = "/Curves", time01: float = 0.5) -> np.ndarray:
    return np.asarray(result.scene.points(path, time01))


def nurbs(shot: Shot, points: Any, order: int, knots: list[float]) -> UsdGeom.NurbsCurves:
    prim = UsdGeom.NurbsCurves.Define(shot.stage, "/Curves")
    prim.CreatePointsAttr([Gf.Vec3f(*p) for p in points])
    prim.CreateCurveVertexCountsAttr([len(points)])
    prim.CreateOrderAttr([order])
    prim.CreateKnotsAttr(knots)
    prim.CreateWidthsAttr([0.25])
    prim.SetWidthsInterpolation("constant")
    return prim
