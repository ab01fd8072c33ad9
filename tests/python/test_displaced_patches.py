"""Displaced surfaces as patches: the points, the picture and the AOVs that their triangles have."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from displaced_stages import Displaced, primvar, ramp, write
from msbvh import _core
from msbvh.scene.reader import ReadSettings, read_frame
from pxr import Gf, Sdf, UsdGeom, Vt
from recording import messages
from subdivision_stages import CORNERS, colour, cube, sheet

KEPT = ("patches", "tessellate")


def rough(shot: Displaced, folder: Path, path: str = "/Cube", scheme: str = "catmullClark") -> UsdGeom.Mesh:
    """A cube whose every face has the same texture, so that texture coordinates have seams at all edges."""
    texels = np.random.default_rng(3).random((8, 8)).astype(np.float32)
    shot.read_texture(write(folder / "rough.exr", texels), wrapS="repeat", wrapT="repeat", scale=Gf.Vec4f(0.4))
    mesh = shot.bound(cube(shot, path, scheme))
    primvar(mesh, "st", [(0, 0), (1, 0), (1, 1), (0, 1)] * 6, "faceVarying")
    return mesh


def rendered(shot: Displaced, kept: str, aovs: list[str], **settings: Any) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    result = read_frame(shot.stage, 10.0, ReadSettings(width=96, displacement=kept, keep_faces=True, **settings))
    assert messages(result, "warning") == []
    size = {"width": result.camera.width, "height": result.camera.height}
    renderer = _core.Renderer(result.scene, spp=16, max_bounces=1, aovs=aovs, **size)
    renderer.verify()
    image, found = renderer.render_with_aovs()
    names = [*result.scene.mesh_names, "background"]  # -1
    found["primId"] = np.array(names)[found["primId"]]
    return image, found


def check_alike(shot: Displaced, **settings: Any) -> None:
    aovs = ["normal", "albedo", "primId", "elementId", "cameraDepth"]
    (patches, of_patches), (triangles, of_triangles) = (rendered(shot, kept, aovs, **settings) for kept in KEPT)
    assert triangles[..., 3].mean() > 0.05
    assert np.array_equal(patches[..., 3], triangles[..., 3])
    assert np.abs(patches - triangles).max() < 1e-4
    assert (of_patches["primId"] == of_triangles["primId"]).all()
    for name in set(aovs) - {"primId"}:
        assert np.allclose(of_patches[name], of_triangles[name], rtol=0.0, atol=1e-4), name  # Infinity is infinity.


@pytest.mark.parametrize("scheme", ["catmullClark", "bilinear"])
def test_a_picture_of_patches_is_that_of_triangles(tmp_path: Path, scheme: str) -> None:
    shot = Displaced()
    mesh = rough(shot, tmp_path, scheme=scheme)
    colour(mesh, np.random.default_rng(1).random((8, 3)).tolist(), "vertex")
    check_alike(shot)


@pytest.mark.parametrize("interpolation", ["uniform", "faceVarying"])
def test_colours_of_faces_and_corners(tmp_path: Path, interpolation: str) -> None:
    shot = Displaced()
    count = 6 if interpolation == "uniform" else 24
    colour(rough(shot, tmp_path), np.random.default_rng(1).random((count, 3)).tolist(), interpolation)
    check_alike(shot)


def test_moving_patches(tmp_path: Path) -> None:
    shot = Displaced(shutter=(-0.5, 0.5))
    mesh = rough(shot, tmp_path)
    for time, degrees in ((9.5, -30.0), (10.5, 30.0)):
        a = np.radians(degrees)
        turn = np.array([[np.cos(a), np.sin(a), 0], [-np.sin(a), np.cos(a), 0], [0, 0, 1]])
        mesh.GetPointsAttr().Set(Vt.Vec3fArray.FromNumpy((CORNERS @ turn).astype(np.float32)), time)
    for interpolation in ("linear", "auto"):
        check_alike(shot, interpolation=interpolation)


def test_instanced_patches_beside_meshes(tmp_path: Path) -> None:
    shot = Displaced()
    prototype = shot.stage.DefinePrim("/Proto", "Xform")
    rough(shot, tmp_path, "/Proto/Cube")
    shot.mesh("/Proto/Polygon", [(-1, -1, -1), (2, -1, -1), (2, 2, -1)])
    instancer = UsdGeom.PointInstancer.Define(shot.stage, "/Many")
    instancer.CreatePrototypesRel().AddTarget(prototype.GetPath())
    instancer.CreateProtoIndicesAttr([0, 0])
    instancer.CreatePositionsAttr([Gf.Vec3f(-1, 0, -3), Gf.Vec3f(1.5, 0, 0)])
    instancer.CreateOrientationsAttr([Gf.Quath(1, 0, 0, 0), Gf.Quath(0.8, 0.6, 0, 0)])
    prototype.SetSpecifier(Sdf.SpecifierOver)
    shot.mesh("/Wall", [(-3, -3, -6), (3, -3, -6), (3, 3, -6), (-3, 3, -6)])
    check_alike(shot)


def test_patches_have_the_points_of_triangles(tmp_path: Path) -> None:
    shot = Displaced()
    rough(shot, tmp_path)
    patches, triangles = ({tuple(p) for p in shot.points("/Cube", displacement=kept).tolist()} for kept in KEPT)
    assert patches == triangles and len(patches) > 500


def test_materials_of_parts(tmp_path: Path) -> None:
    shot = Displaced(0.3)
    mesh = sheet(shot, 4)
    subset = UsdGeom.Subset.CreateGeomSubset(mesh, "Left", "face", Vt.IntArray([0, 1, 4, 5, 8]), "materialBind")
    shot.bound(subset)
    shot.surface.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).Set(Gf.Vec3f(0.8, 0.1, 0.1))
    check_alike(shot)


def test_patches_take_less_memory(tmp_path: Path) -> None:
    shot = Displaced()
    shot.read_texture(write(tmp_path / "ramp.exr", ramp()), wrapS="clamp", wrapT="clamp", scale=Gf.Vec4f(0.1))
    mesh = shot.bound(sheet(shot, 4))
    primvar(mesh, "st", np.array(mesh.GetPointsAttr().Get())[:, :2] / 4 + 0.5, "vertex")
    bytes_of = {}
    for kept in KEPT:
        result = read_frame(shot.stage, 10.0, ReadSettings(width=800, displacement=kept))
        size = {"width": result.camera.width, "height": result.camera.height}
        renderer = _core.Renderer(result.scene, spp=1, max_bounces=0, **size)
        renderer.render(lambda _: True)
        bytes_of[kept] = renderer.statistics["accel"]["total_bytes"]
    assert bytes_of["patches"] < 0.4 * bytes_of["tessellate"]  # With their points.


def test_what_does_not_fit_as_triangles_becomes_patches(tmp_path: Path) -> None:
    """By the default: one surface after the other."""
    shot = Displaced()
    for name in ("/A", "/B", "/C"):
        rough(shot, tmp_path, name)

    def built(**settings: Any) -> dict[str, int]:
        result = read_frame(shot.stage, 10.0, ReadSettings(width=96, **settings))
        size = {"width": result.camera.width, "height": result.camera.height}
        renderer = _core.Renderer(result.scene, spp=1, max_bounces=0, **size)
        renderer.render(lambda _: True)
        return renderer.statistics["accel"]

    every = built(displacement="tessellate")
    room = every["total_bytes"]
    assert built()["triangles"] == every["triangles"]
    assert built(displaced_triangle_bytes=0)["triangles"] == 0
    assert built(displaced_triangle_bytes=2 * room)["triangles"] == every["triangles"]
    some = built(displaced_triangle_bytes=room // 2)
    assert 0 < some["triangles"] < every["triangles"] and some["quads"] > 0
