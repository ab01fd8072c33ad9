"""Displacement from a stage to points: constants, primvars, textures, and what they are read on."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from displaced_stages import ROUNDING, SIDE, TYPES, Displaced, corners, flat, primvar, ramp, slope, square, write
from msbvh import _core
from msbvh.scene.reader import ReadSettings, read_frame
from pxr import Gf, Sdf, UsdGeom, UsdShade, Vt
from recording import messages
from subdivision_stages import CORNERS, FACES, cube, sheet


@pytest.mark.parametrize("amount", [0.5, -0.25])
def test_a_plane_moves_along_its_normal(amount: float) -> None:
    shot = Displaced(amount)
    flat(shot)
    result = shot.read(displacement="tessellate")
    found, before = result.scene.points("/Sheet", 0.5), shot.undisplaced("/Sheet")
    assert messages(result, "warning") == []
    assert np.abs(found - before - (0, 0, amount)).max() < ROUNDING
    assert np.ptp(before[:, 2]) == 0.0 and len(found) > 1000


def test_distances_are_in_the_objects_own_units() -> None:
    shot = Displaced(0.5)
    flat(shot).AddScaleOp().Set(Gf.Vec3f(0.5, 0.5, 3.0))
    assert np.abs(shot.points("/Sheet")[:, 2] - 1.5).max() < ROUNDING


def test_left_handed_surfaces_go_the_other_way() -> None:
    shot = Displaced(0.5)
    flat(shot).CreateOrientationAttr("leftHanded")
    assert np.abs(shot.points("/Sheet")[:, 2] + 0.5).max() < ROUNDING


def round_cage(shot: Displaced, count: int = 8) -> UsdGeom.Mesh:
    """A sphere of radius 1: the faces of a cube, cut into quads, drawn to the sphere."""
    steps = np.linspace(-1.0, 1.0, count + 1)
    points: dict[tuple, int] = {}
    faces = []
    for axis in range(3):
        for side in (-1.0, 1.0):

            def index(i: int, j: int, axis: int = axis, side: float = side) -> int:
                place = np.roll((side, steps[i], steps[j]), axis)
                return points.setdefault(tuple(np.round(place, 9)), len(points))

            for i in range(count):
                for j in range(count):
                    face = [index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)]
                    faces.append(face if side > 0 else face[::-1])
    places = np.array(list(points))
    places /= np.linalg.norm(places, axis=1, keepdims=True)
    mesh = shot.bound(shot.mesh("/Round", places))
    mesh.GetFaceVertexCountsAttr().Set([4] * len(faces))
    mesh.GetFaceVertexIndicesAttr().Set(np.ravel(faces).tolist())
    mesh.CreateSubdivisionSchemeAttr("catmullClark")
    return mesh


@pytest.mark.parametrize("amount", [0.5, -0.3])
def test_a_sphere_grows_by_the_distance(amount: float) -> None:
    shot = Displaced(amount)
    round_cage(shot)
    before, after = shot.undisplaced("/Round"), shot.points("/Round")
    radius = np.linalg.norm(before, axis=1)
    assert radius.min() > 0.97 and radius.max() < 1.0
    assert np.abs(np.linalg.norm(after - before, axis=1) - abs(amount)).max() < ROUNDING
    outwards = np.einsum("ij,ij->i", after - before, before) / radius / amount
    assert outwards.min() > np.cos(0.03)  # As round as the limit of such a cage is.


@pytest.mark.parametrize("interpolation", ["constant", "uniform", "varying", "vertex", "faceVarying"])
def test_primvars_of_every_interpolation(interpolation: str) -> None:
    """Of a linear function the surface has its values, by whatever masks both are refined."""
    shot = Displaced()
    shot.read_primvar("height")
    mesh = flat(shot, "catmullClark" if interpolation == "vertex" else "bilinear")
    points = np.array(mesh.GetPointsAttr().Get())
    middles = corners(mesh, lambda p: p).reshape(-1, 4, 3).mean(axis=1)
    values = {
        "constant": [0.75],
        "uniform": slope(middles),
        "varying": slope(points),
        "vertex": slope(points),
        "faceVarying": corners(mesh, slope),
    }[interpolation]
    primvar(mesh, "height", values, interpolation)
    result = shot.read(displacement="tessellate")
    assert messages(result, "warning") == []
    found = result.scene.points("/Sheet", 0.5)
    if interpolation == "constant":
        expected = np.full(len(found), 0.75)
    elif interpolation == "uniform":  # At edges the mean of the faces around.
        x, y = found[:, :2].T
        inside = (np.abs(x - np.round(x)) > 1e-4) & (np.abs(y - np.round(y)) > 1e-4)
        centres = np.stack([np.floor(x) + 0.5, np.floor(y) + 0.5, 0 * x], axis=1)
        expected = np.where(inside, slope(centres), found[:, 2])
        assert inside.sum() > 500
    else:
        expected = slope(found)
    assert np.abs(found[:, 2] - expected).max() < ROUNDING


def test_where_faces_disagree_a_point_has_their_mean() -> None:
    shot = Displaced()
    shot.read_primvar("height")
    mesh = flat(shot, "bilinear")
    primvar(mesh, "height", np.arange(SIDE * SIDE), "uniform")
    found = shot.points("/Sheet")
    at = {tuple(np.round(p[:2], 5)): p[2] for p in found.tolist()}
    assert at[0.0, 0.0] == pytest.approx((5 + 6 + 9 + 10) / 4)
    assert at[-2.0, -2.0] == pytest.approx(0.0)
    assert at[-1.0, -1.5] == pytest.approx(0.5)


def test_indexed_and_inherited_primvars() -> None:
    shot = Displaced()
    shot.read_primvar("height")
    parent = shot.stage.DefinePrim("/Group", "Xform")
    UsdGeom.PrimvarsAPI(parent).CreatePrimvar("height", TYPES.FloatArray, "constant").Set([0.25])
    mesh = shot.bound(sheet(shot, SIDE, "/Group/Sheet"))
    assert np.abs(shot.points("/Group/Sheet")[:, 2] - 0.25).max() < ROUNDING
    primvar(mesh, "height", [0.5, 1.5], "uniform").SetIndices(Vt.IntArray([1] * SIDE * SIDE))
    assert np.abs(shot.points("/Group/Sheet")[:, 2] - 1.5).max() < ROUNDING


@pytest.mark.parametrize("interpolation", ["vertex", "faceVarying"])
def test_a_ramp_of_a_texture(tmp_path: Path, interpolation: str) -> None:
    shot = Displaced()
    file = write(tmp_path / "ramp.exr", np.stack([ramp(), 2 * ramp(), 3 * ramp()], axis=-1))
    shot.read_texture(
        file, "g", scale=Gf.Vec4f(9, 0.25, 9, 9), bias=Gf.Vec4f(9, -0.5, 9, 9), sourceColorSpace="raw", wrapS="clamp"
    )
    mesh = flat(shot, "catmullClark" if interpolation == "vertex" else "bilinear")
    points = np.array(mesh.GetPointsAttr().Get())
    primvar(mesh, "st", square(points) if interpolation == "vertex" else corners(mesh, square), interpolation)
    result = shot.read(displacement="tessellate")
    assert messages(result, "warning") == []
    found = result.scene.points("/Sheet", 0.5)
    st = square(found)
    inside = (np.abs(st - 0.5) < 0.45).all(axis=1)  # Beside the edge there is half a texel without a slope.
    assert inside.sum() > 1000
    expected = 0.25 * 2.0 * (st[:, 0] + 2.0 * st[:, 1]) - 0.5
    assert np.abs(found[inside, 2] - expected[inside]).max() < 1e-5


def test_texture_coordinates_are_transformed(tmp_path: Path) -> None:
    shot = Displaced()
    texture = shot.read_texture(write(tmp_path / "ramp.exr", ramp()), wrapS="clamp", wrapT="clamp")
    turn = shot.shader("Turn", "UsdTransform2d")
    for name, kind, value in (
        ("scale", TYPES.Float2, Gf.Vec2f(0.5, 0.25)),
        ("rotation", TYPES.Float, 90.0),
        ("translation", TYPES.Float2, Gf.Vec2f(0.7, 0.2)),
    ):
        turn.CreateInput(name, kind).Set(value)
    reader = UsdShade.Shader.Get(shot.stage, "/Look/Coordinates")
    turn.CreateInput("in", TYPES.Float2).ConnectToSource(reader.GetOutput("result"))
    texture.GetInput("st").ConnectToSource(turn.CreateOutput("result", TYPES.Float2))
    mesh = flat(shot, "bilinear")
    primvar(mesh, "st", square(np.array(mesh.GetPointsAttr().Get())), "vertex")
    found = shot.points("/Sheet")
    s, t = square(found).T
    expected = (-0.25 * t + 0.7) + 2.0 * (0.5 * s + 0.2)
    assert np.abs(found[:, 2] - expected).max() < 1e-5


def test_the_file_may_say_how_it_wraps_else_it_is_black_outside(tmp_path: Path) -> None:
    found = []
    for metadata in ({}, {"wrapS": "repeat", "wrapT": "repeat"}):
        shot = Displaced()
        shot.read_texture(write(tmp_path / f"one{len(metadata)}.exr", np.ones((4, 4)), **metadata))
        mesh = flat(shot, "bilinear")
        primvar(mesh, "st", 3 * square(np.array(mesh.GetPointsAttr().Get())), "vertex")
        found.append(shot.points("/Sheet"))
    outside = (3 * square(found[0]) > 1.0001).any(axis=1)
    assert (found[0][outside, 2] == 0.0).all() and (found[0][~outside, 2] == 1.0).all()
    assert 0.5 < outside.mean() < 1.0
    assert (found[1][:, 2] == 1.0).all()


def test_tiles_of_a_udim_texture(tmp_path: Path) -> None:
    shot = Displaced()
    for number, value in ((1001, 0.25), (1002, 0.5), (1012, 1.0)):
        write(tmp_path / f"tile.{number}.exr", np.full((4, 4), value))
    shot.read_texture(str(tmp_path / "tile.<UDIM>.exr"))
    mesh = flat(shot, "bilinear")
    primvar(mesh, "st", 2 * square(np.array(mesh.GetPointsAttr().Get())), "vertex")
    result = shot.read(displacement="tessellate")
    assert messages(result, "warning") == []
    x, y, z = result.scene.points("/Sheet", 0.5).T
    beside = (np.abs(x) > 1e-4) & (np.abs(y) > 1e-4)
    expected = np.where(y < 0, np.where(x < 0, 0.25, 0.5), np.where(x < 0, 0.0, 1.0))
    assert np.abs(z - expected)[beside].max() < ROUNDING


def test_a_fine_texture_is_filtered_at_the_dicing_rate(tmp_path: Path) -> None:
    """Noise of one texel that is far finer than the edges averages out."""
    noise = np.random.default_rng(1).random((1024, 1024)).astype(np.float32)
    spreads = []
    for pixels in (16.0, 1.0):
        shot = Displaced()
        shot.read_texture(write(tmp_path / "noise.exr", noise), wrapS="repeat", wrapT="repeat")
        mesh = flat(shot, "bilinear")
        primvar(mesh, "st", square(np.array(mesh.GetPointsAttr().Get())), "vertex")
        found = shot.points("/Sheet", edge_length=pixels, width=240)
        assert found[:, 2].mean() == pytest.approx(0.5, abs=0.02)
        spreads.append(found[:, 2].std())
    assert spreads[0] < 0.02 and spreads[1] > 4 * spreads[0]


def test_a_seam_of_texture_coordinates_leaves_no_crack(tmp_path: Path) -> None:
    """Each face of a cube has the whole texture: at its edges two faces disagree by up to the whole range."""
    shot = Displaced()
    shot.read_texture(write(tmp_path / "ramp.exr", ramp()), wrapS="clamp", wrapT="clamp", scale=Gf.Vec4f(0.1))
    mesh = shot.bound(cube(shot))
    primvar(mesh, "st", [(0, 0), (1, 0), (1, 1), (0, 1)] * 6, "faceVarying")
    found, before = shot.points("/Cube"), shot.undisplaced("/Cube")
    assert len(found) == len(before)  # One point for all faces.
    moved = np.linalg.norm(found - before, axis=1)
    assert moved.max() > 0.25 and moved.min() < 0.05


def test_parts_with_materials_of_their_own() -> None:
    shot = Displaced(0.5)
    mesh = sheet(shot, SIDE)
    mesh.CreateSubdivisionSchemeAttr("bilinear")
    subset = UsdGeom.Subset.CreateGeomSubset(
        mesh, "Left", "face", Vt.IntArray([0, 1, 4, 5, 8, 9, 12, 13]), "materialBind"
    )
    shot.bound(subset)
    found = shot.points("/Sheet")
    x = found[:, 0]
    assert np.abs(found[x < -1e-5, 2] - 0.5).max() < ROUNDING
    assert np.abs(found[x > 1e-5, 2]).max() == 0.0
    assert np.abs(found[np.abs(x) < 1e-5, 2] - 0.25).max() < ROUNDING


def test_polygons_move_at_their_vertices_with_one_warning() -> None:
    shot = Displaced(0.5)
    mesh = shot.bound(cube(shot, scheme="none"))
    mesh.GetPointsAttr().Set(Vt.Vec3fArray.FromNumpy(CORNERS.astype(np.float32)))
    result = shot.read(displacement="tessellate")
    found = result.scene.points("/Cube", 0.5)
    # A corner has one or two of the triangles of each of its three faces, and goes by the sum of their normals.
    fans = [[face[0], face[i], face[i + 1]] for face in FACES for i in (1, 2)]
    normals = np.zeros((8, 3))
    for fan in fans:
        a, b, c = CORNERS[fan]
        normals[fan] += np.cross(b - a, c - a)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    assert np.abs(found - CORNERS - 0.5 * normals).max() < ROUNDING
    assert messages(result, "warning") == [
        "/Cube.subdivisionScheme: displacement moves the vertices of polygons alone; a subdivided mesh shows all of it"
    ]


def test_off_by_option() -> None:
    shot = Displaced(0.5)
    flat(shot)
    assert (shot.undisplaced("/Sheet")[:, 2] == 0.0).all()


def test_instances_of_a_displaced_prototype() -> None:
    shot = Displaced(0.5)
    prototype = shot.stage.DefinePrim("/Proto", "Xform")
    shot.bound(sheet(shot, SIDE, "/Proto/Sheet"))
    instancer = UsdGeom.PointInstancer.Define(shot.stage, "/Many")
    instancer.CreatePrototypesRel().AddTarget(prototype.GetPath())
    instancer.CreateProtoIndicesAttr([0, 0])
    instancer.CreatePositionsAttr([Gf.Vec3f(0, 0, -10), Gf.Vec3f(0, 0, 0)])
    instancer.CreateScalesAttr([Gf.Vec3f(1, 1, 1), Gf.Vec3f(1, 1, 2)])
    prototype.SetSpecifier(Sdf.SpecifierOver)
    heights = np.unique(np.round(shot.read().scene.instance_points(0.5)[:, 2], 5))
    assert heights.tolist() == [-9.5, 1.0]


def test_a_displaced_surface_is_shaded_as_it_lies() -> None:
    """A sheet that rises by a slope of 1: its normal leans back by 45 degrees."""
    shot = Displaced()
    shot.read_primvar("height")
    mesh = flat(shot, "bilinear")
    primvar(mesh, "height", np.array(mesh.GetPointsAttr().Get())[:, 0], "vertex")
    result = read_frame(shot.stage, 10.0, ReadSettings(width=48))
    size = {"width": result.camera.width, "height": result.camera.height}
    renderer = _core.Renderer(result.scene, spp=16, max_bounces=0, aovs=["normal"], **size)
    normal = renderer.render_with_aovs()[1]["normal"]
    middle = normal[size["height"] // 2, size["width"] // 2]
    assert np.abs(middle - np.array([-1, 0, 1]) / np.sqrt(2.0)).max() < 1e-3


def test_the_plan_names_it() -> None:
    shot = Displaced(0.5)
    flat(shot)
    for kept, why in (
        ("tessellate", "up to 0.5 along the normal"),
        ("patches", "up to 0.5 along the normal, as patches"),
    ):
        result = read_frame(shot.stage, 10.0, ReadSettings(displacement=kept))
        renderer = _core.Renderer(result.scene, width=16, height=16, spp=1, max_bounces=0)
        assert ("displacement", "/Sheet", why) in renderer.plan
