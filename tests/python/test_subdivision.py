"""Subdivision surfaces from a stage to triangles of their limit surface: rules, motion, rates.

The limit itself is held against Catmull-Clark's rules in C++ (tests/unit/test_subdivision.cpp, test_refined_mesh.cpp).
"""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
import pytest
from msbvh import _core
from msbvh.scene.reader import ReadSettings, read_frame
from pxr import Gf, Sdf, UsdGeom, Vt
from recording import DENSE_TIMES01, Shot, messages, worst_deviation
from subdivision_stages import CORNERS, FACES, VERTEX_LIMIT, cube, points, sheet, triangles


def test_a_cube_becomes_its_limit() -> None:
    shot = Shot()
    cube(shot)
    found = points(shot, width=200)
    # Vertices go half way to the middle, and nothing goes farther out than the middles of faces.
    corners = np.linalg.norm(found[:, None] - VERTEX_LIMIT * CORNERS[None], axis=-1).min(axis=0)
    assert corners.max() < 1e-6
    assert np.abs(found).max() < 0.9
    assert len(found) > 1000
    assert messages(shot.read(), "warning") == []


@pytest.mark.parametrize("scheme", [None, "catmullClark", "loop", "bilinear"])
def test_every_scheme_is_drawn_without_a_word(scheme: str | None) -> None:
    shot = Shot()
    mesh = shot.mesh("/Mesh", [(0, 0, 1), (1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, 0), (0, 0, -1)])
    rim = [1, 2, 3, 4, 1]
    mesh.GetFaceVertexCountsAttr().Set([3] * 8)
    upper = [v for a, b in itertools.pairwise(rim) for v in (0, a, b)]
    lower = [v for a, b in itertools.pairwise(rim) for v in (5, b, a)]
    mesh.GetFaceVertexIndicesAttr().Set([*upper, *lower])
    if scheme is None:
        mesh.GetPrim().RemoveProperty("subdivisionScheme")
    else:
        mesh.CreateSubdivisionSchemeAttr(scheme)
    result = shot.read()
    assert messages(result) == []
    size = np.abs(result.scene.points("/Mesh", 0.5)).max()
    assert size == pytest.approx(1.0, abs=1e-6) if scheme == "bilinear" else 0.4 < size < 0.9


def test_complexity_and_edge_length_say_how_fine() -> None:
    shot = Shot((0.0, 0.0))
    cube(shot)
    counts = [triangles(shot, complexity=name) for name in ("low", "medium", "high", "veryhigh")]
    assert counts[0] == 12
    assert counts[2] == pytest.approx(16 * counts[1], rel=0.1)
    assert counts[3] == pytest.approx(4 * counts[2], rel=0.1)
    assert triangles(shot, complexity="low", edge_length=4.0) == counts[1]
    assert triangles(shot, complexity="veryhigh", edge_length=0.0) == 12
    assert triangles(shot) == counts[2]


def test_edges_are_about_as_long_as_asked_for() -> None:
    shot = Shot((0.0, 0.0))
    cube(shot)
    result = read_frame(shot.stage, 10.0, ReadSettings(width=200, edge_length=5.0))
    (found,) = [p[0] for _, _, p in result.scene.poses(0.5)]
    pixels_per_unit = 200 * 50.0 / 20.955 / (20.0 - np.abs(found).max())
    nearest = np.sort(np.linalg.norm(found[:, None] - found[None], axis=-1), axis=1)[:, 1]
    assert np.median(nearest) * pixels_per_unit >= 1.5
    assert nearest.max() * pixels_per_unit <= 2.0 * 5.0  # inside of a face it bulges


def test_farther_is_coarser_and_so_is_what_the_picture_does_not_show() -> None:
    near, far, behind, beside = (Shot((0.0, 0.0)) for _ in range(4))
    cube(near)
    cube(far).AddTranslateOp().Set(Gf.Vec3d(0, 0, -60))
    cube(behind).AddTranslateOp().Set(Gf.Vec3d(0, 0, 40))
    cube(beside).AddTranslateOp().Set(Gf.Vec3d(20, 0, 0))
    count = triangles(near)
    assert triangles(far) == pytest.approx(count / 16, rel=0.1)
    assert triangles(behind) == pytest.approx(count / 64, rel=0.1)
    assert triangles(beside) < count / 64


def test_what_comes_into_the_picture_within_the_shutter_is_fine() -> None:
    shot = Shot((-0.5, 0.5))
    move = cube(shot).AddTranslateOp()
    move.Set(Gf.Vec3d(0, 0, 0), 10.5)
    move.Set(Gf.Vec3d(60, 0, 0), 9.5)
    still = Shot((0.0, 0.0))
    cube(still)
    assert triangles(shot) == triangles(still)


def moving(shot: Shot, pose: Callable[[float], np.ndarray]) -> UsdGeom.Mesh:
    mesh = cube(shot)
    for time in (9.0, 9.8, 10.1, 11.0):
        mesh.GetPointsAttr().Set(Vt.Vec3fArray.FromNumpy(pose(time).astype(np.float32)), time)
    return mesh


def test_the_surface_moves_as_its_cage_does() -> None:
    """Limit points are linear in the cage, so that a cage that is scaled takes its surface along, exactly."""
    shot = Shot((-1.0, 1.0))
    moving(shot, lambda time: CORNERS * (1.0 + 0.3 * (time - 10.0) ** 2) + (0.2 * time, 0, 0))
    still = Shot((0.0, 0.0))
    cube(still)
    scene = shot.read(motion_tolerance=0.01).scene
    samples = [9.0, 9.8, 10.1, 11.0]
    middle = scene.points("/Cube", 0.0)
    for time01 in DENSE_TIMES01:
        time = 9.0 + 2.0 * time01
        size = np.interp(time, samples, [1.0 + 0.3 * (t - 10.0) ** 2 for t in samples])
        shift = 0.2 * time
        first = 1.3
        expected = (middle - (0.2 * 9.0, 0, 0)) / first * size + (shift, 0, 0)
        assert np.abs(scene.points("/Cube", time01) - expected).max() < 2e-4


@pytest.mark.parametrize("carried", [False, True])
def test_velocities_and_transforms_carry_the_surface(carried: bool) -> None:
    shot = Shot((-0.5, 0.5))
    mesh = cube(shot)
    if carried:
        mesh.CreateVelocitiesAttr([Gf.Vec3f(48, 0, 0)] * 8)
        mesh.GetPointsAttr().Clear()
        mesh.GetPointsAttr().Set(Vt.Vec3fArray.FromNumpy(CORNERS.astype(np.float32)), 10.0)
        mesh.GetVelocitiesAttr().Clear()
        mesh.GetVelocitiesAttr().Set([Gf.Vec3f(48, 0, 0)] * 8, 10.0)
    else:
        move = mesh.AddTranslateOp()
        move.Set(Gf.Vec3d(-2, 0, 0), 9.0)
        move.Set(Gf.Vec3d(2, 0, 0), 11.0)
    scene = shot.read().scene
    place = next(place for _, place, _ in scene.poses(0.5))
    at = {time01: next(p[0] for _, _, p in scene.poses(time01)) for time01 in (0.0, 0.37, 1.0)}
    assert place == "/Cube"
    assert np.abs(at[1.0] - at[0.0] - (2, 0, 0)).max() < 1e-4
    assert np.abs(at[0.37] - at[0.0] - (0.74, 0, 0)).max() < 1e-4


def test_cages_are_followed_by_low_complexity_as_ever() -> None:
    shot = Shot((-1.0, 1.0))
    mesh = moving(shot, lambda time: CORNERS * (1.0 + 0.1 * time))
    assert worst_deviation(shot.read(complexity="low"), mesh.GetPrim()) < 1e-3


def test_creases_and_corners_are_sharp() -> None:
    shot = Shot()
    mesh = cube(shot)
    smooth = points(shot)
    mesh.CreateCreaseLengthsAttr([5])
    mesh.CreateCreaseIndicesAttr([0, 1, 3, 2, 0])
    mesh.CreateCreaseSharpnessesAttr([10.0])
    creased = points(shot)
    assert creased[:, 0].min() == pytest.approx(-1.0, abs=1e-6)  # the face at x = -1 has a sharp rim, and is flat
    assert smooth[:, 0].min() > -0.9
    mesh.CreateCornerIndicesAttr([7])
    mesh.CreateCornerSharpnessesAttr([10.0])
    assert np.linalg.norm(points(shot) - CORNERS[7], axis=1).min() < 1e-6


@pytest.mark.parametrize("rule", ["none", "edgeOnly", "edgeAndCorner"])
def test_boundaries(rule: str) -> None:
    shot = Shot()
    sheet(shot, 4).CreateInterpolateBoundaryAttr(rule)
    found = points(shot, "/Sheet")
    corner = np.linalg.norm(found - (-2, -2, 0), axis=1).min()
    if rule == "edgeAndCorner":
        assert corner < 1e-6
    elif rule == "edgeOnly":
        assert 0.05 < corner < 1.0
    else:  # Faces at the boundary have no surface.
        assert np.abs(found).max() == pytest.approx(1.0, abs=0.1)


def test_a_face_without_a_surface_is_nothing_to_draw() -> None:
    shot = Shot((0.0, 0.0))
    sheet(shot, 1).CreateInterpolateBoundaryAttr("none")
    result = read_frame(shot.stage, 10.0, ReadSettings())
    assert result.scene.statistics()["triangles"] == 0
    assert [text for text in messages(result) if text.startswith("/Sheet")] == []


def normals(shot: Shot) -> np.ndarray:
    """float32[H, W, 3]: the mean normal in each pixel, in the world."""
    result = read_frame(shot.stage, 10.0, ReadSettings(width=48))
    size = {"width": result.camera.width, "height": result.camera.height}
    renderer = _core.Renderer(result.scene, spp=16, max_bounces=0, aovs=["normal"], **size)
    return renderer.render_with_aovs()[1]["normal"]


def test_a_left_handed_cage_is_drawn_alike() -> None:
    """Which way triangles wind is held in C++ (test_refined_mesh.cpp): a picture turns normals towards the viewer."""
    found = []
    for handedness, faces in (("rightHanded", FACES), ("leftHanded", [face[::-1] for face in FACES])):
        shot = Shot((0.0, 0.0))
        mesh = cube(shot)
        mesh.CreateOrientationAttr(handedness)
        mesh.GetFaceVertexIndicesAttr().Set(np.ravel(faces).tolist())
        assert shot.read().scene.meshes["/Cube"]["left_handed"] is (handedness == "leftHanded")
        found.append(normals(shot))
    assert found[0][..., 2].max() > 0.9
    assert np.abs(found[0] - found[1]).max() < 0.05


def test_instances_are_as_fine_as_the_nearest_of_them() -> None:
    shot = Shot((0.0, 0.0))
    prototype = shot.stage.DefinePrim("/Proto", "Xform")
    cube(shot, "/Proto/Cube")
    instancer = UsdGeom.PointInstancer.Define(shot.stage, "/Many")
    instancer.CreatePrototypesRel().AddTarget(prototype.GetPath())
    instancer.CreateProtoIndicesAttr([0, 0])
    instancer.CreatePositionsAttr([Gf.Vec3f(0, 0, -60), Gf.Vec3f(0, 0, 0)])
    prototype.SetSpecifier(Sdf.SpecifierOver)
    single = Shot((0.0, 0.0))
    cube(single)
    result = read_frame(shot.stage, 10.0, ReadSettings())
    alone = triangles(single)
    assert alone <= result.scene.statistics()["triangles"] <= 4 * alone
