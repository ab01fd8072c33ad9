"""Stages with subdivision surfaces, and what is drawn of them."""

from __future__ import annotations

from typing import Any

import numpy as np
from msbvh import _core
from msbvh.scene.reader import ReadSettings, read_frame
from pxr import Gf, Sdf, UsdGeom, Vt
from recording import Shot, messages

FACES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
CORNERS = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
VERTEX_LIMIT = 12 / 24
"""Where a corner of a cube goes by Halstead's mask of valence 3: 9 times itself, 4 times its neighbours, which add up to it,
and the opposite corners of its faces, which add up to it the other way round: (9 + 4 - 1) / 24."""


def cube(shot: Shot, path: str = "/Cube", scheme: str = "catmullClark") -> UsdGeom.Mesh:
    mesh = shot.mesh(path, CORNERS)
    mesh.GetFaceVertexCountsAttr().Set([4] * 6)
    mesh.GetFaceVertexIndicesAttr().Set(np.ravel(FACES).tolist())
    mesh.CreateSubdivisionSchemeAttr(scheme)
    return mesh


def sheet(shot: Shot, side: int = 2, path: str = "/Sheet") -> UsdGeom.Mesh:
    """Unit quads in xy around the origin, row by row."""
    points = [(x - side / 2, y - side / 2, 0) for y in range(side + 1) for x in range(side + 1)]
    mesh = shot.mesh(path, points)
    stride = side + 1
    first = [y * stride + x for y in range(side) for x in range(side)]
    mesh.GetFaceVertexCountsAttr().Set([4] * len(first))
    mesh.GetFaceVertexIndicesAttr().Set([i for a in first for i in (a, a + 1, a + 1 + stride, a + stride)])
    mesh.CreateSubdivisionSchemeAttr("catmullClark")
    return mesh


def triangles(shot: Shot, **settings: Any) -> int:
    result = read_frame(shot.stage, 10.0, ReadSettings(**settings))
    assert messages(result, "warning") == []
    return result.scene.statistics()["triangles"]


def points(shot: Shot, path: str = "/Cube", time01: float = 0.5, **settings: Any) -> np.ndarray:
    return shot.read(**settings).scene.points(path, time01)


def picture(shot: Shot, width: int = 96, **settings: Any) -> np.ndarray:
    result = read_frame(shot.stage, 10.0, ReadSettings(width=width, **settings))
    size = result.camera.width, result.camera.height
    renderer = _core.Renderer(result.scene, width=size[0], height=size[1], spp=32, max_bounces=0)
    return renderer.render(lambda _: True)


def colour(mesh: UsdGeom.Mesh, values: list, interpolation: str, indices: list[int] | None = None) -> None:
    primvar = UsdGeom.PrimvarsAPI(mesh).CreatePrimvar("displayColor", Sdf.ValueTypeNames.Color3fArray, interpolation)
    primvar.Set([Gf.Vec3f(*value) for value in values])
    if indices is not None:
        primvar.SetIndices(Vt.IntArray(indices))


RED, GREEN, BLUE, WHITE = (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)
