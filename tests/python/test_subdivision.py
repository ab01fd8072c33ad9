"""Subdivision surfaces from a stage to triangles of their limit surface: rules, motion, primvars, rates, bad input.

The limit itself is held against Catmull-Clark's rules in C++ (tests/unit/test_subdivision.cpp, test_refined_mesh.cpp).
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from msbvh import _core
from msbvh.scene.reader import ReadSettings, read_frame
from pxr import Gf, Sdf, UsdGeom, UsdLux, UsdShade, Vt
from recording import DENSE_TIMES01, Shot, messages, worst_deviation
from test_subsets import material

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


@pytest.mark.parametrize(("rule", "reach"), [("none", 0.0), ("edgeOnly", 1.0), ("edgeAndCorner", 1.0)])
def test_boundaries(rule: str, reach: float) -> None:
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


def test_a_left_handed_cage_faces_the_same_way() -> None:
    colours = []
    for left in (False, True):
        shot = Shot((0.0, 0.0))
        mesh = cube(shot)
        if left:
            mesh.CreateOrientationAttr("leftHanded")
            mesh.GetFaceVertexIndicesAttr().Set([v for face in FACES for v in reversed(face)])
        sun = UsdLux.DistantLight.Define(shot.stage, "/Sun")
        sun.CreateIntensityAttr(30000.0)
        colours.append(picture(shot))
    assert colours[0][..., 3].max() == 1.0
    assert np.abs(colours[0] - colours[1])[..., :3].mean() < 0.02


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


@pytest.mark.parametrize(
    ("interpolation", "values", "indices"),
    [
        ("constant", [RED], None),
        ("uniform", [RED, GREEN, BLUE, WHITE], None),
        ("uniform", [WHITE, BLUE, GREEN, RED], [3, 2, 1, 0]),
        ("varying", [RED] * 9, None),
        ("vertex", [RED] * 9, None),
        ("vertex", [RED, GREEN], [0] * 9),
        ("faceVarying", [RED] * 4 + [GREEN] * 4 + [BLUE] * 4 + [WHITE] * 4, None),
        ("faceVarying", [WHITE, RED, GREEN, BLUE], [1] * 4 + [2] * 4 + [3] * 4 + [0] * 4),
    ],
)
def test_colours_of_every_interpolation(interpolation: str, values: list, indices: list[int] | None) -> None:
    shot = Shot((0.0, 0.0))
    colour(sheet(shot, 2), values, interpolation, indices)
    shot.camera.CreateFocalLengthAttr(150.0)
    UsdLux.DomeLight.Define(shot.stage, "/Dome")
    image = picture(shot)
    height, width = image.shape[:2]
    quarters = [image[height * 5 // 8, width * 7 // 16], image[height * 5 // 8, width * 9 // 16]]
    quarters += [image[height * 3 // 8, width * 7 // 16], image[height * 3 // 8, width * 9 // 16]]
    by_face = interpolation in ("uniform", "faceVarying")
    for found, expected in zip(quarters, (RED, GREEN, BLUE, WHITE) if by_face else (RED,) * 4, strict=True):
        assert found[:3] == pytest.approx(expected, abs=0.02)


def test_vertex_colours_are_smooth_and_varying_ones_linear() -> None:
    """Along a row whose values are 0, 0, 1, 0, 0: a B-spline's top is 2 / 3, a line's 1."""
    tops = {}
    for interpolation in ("vertex", "varying"):
        shot = Shot((0.0, 0.0))
        values = [WHITE if i % 5 == 2 else (0, 0, 0) for i in range(25)]
        colour(sheet(shot, 4), values, interpolation)
        shot.camera.CreateFocalLengthAttr(100.0)
        UsdLux.DomeLight.Define(shot.stage, "/Dome")
        image = picture(shot, width=192)
        tops[interpolation] = image[image.shape[0] // 2, 48:144, 0].max()
    assert tops["vertex"] == pytest.approx(2 / 3, abs=0.02)
    assert tops["varying"] == pytest.approx(1.0, abs=0.05)


def test_animated_colours_are_refined_at_every_key() -> None:
    shot = Shot((-0.5, 0.5))
    mesh = sheet(shot, 2)
    colour(mesh, [RED] * 9, "vertex")
    primvar = UsdGeom.PrimvarsAPI(mesh).GetPrimvar("displayColor")
    primvar.Set([Gf.Vec3f(0, 0, 0)] * 9, 9.5)
    primvar.Set([Gf.Vec3f(1, 0, 0)] * 9, 10.5)
    shot.camera.CreateFocalLengthAttr(150.0)
    UsdLux.DomeLight.Define(shot.stage, "/Dome")
    image = picture(shot)
    assert image[image.shape[0] // 2, image.shape[1] // 2, 0] == pytest.approx(0.5, abs=0.05)


def test_parts_keep_their_materials() -> None:
    shot = Shot((0.0, 0.0))
    mesh = sheet(shot, 2)
    subset = UsdGeom.Subset.CreateGeomSubset(mesh, "Part", "face", Vt.IntArray([1]), "materialBind")
    UsdShade.MaterialBindingAPI.Apply(subset.GetPrim()).Bind(material(shot.stage, "/Looks/Green", GREEN))
    shot.camera.CreateFocalLengthAttr(150.0)
    UsdLux.DomeLight.Define(shot.stage, "/Dome")
    image = picture(shot)
    height, width = image.shape[:2]
    assert image[height * 5 // 8, width * 9 // 16, :3] == pytest.approx(GREEN, abs=0.02)
    assert image[height * 5 // 8, width * 7 // 16, :3] == pytest.approx((0.18,) * 3, abs=0.02)


BAD: list[tuple[Callable[[UsdGeom.Mesh], object], str, int]] = [
    (
        lambda m: m.CreateSubdivisionSchemeAttr("doo"),
        'subdivisionScheme: found "doo"; expected catmullClark, loop or bilinear, or none; the cage is drawn as polygons',
        12,
    ),
    (
        lambda m: m.CreateSubdivisionSchemeAttr("loop"),
        "faceVertexCounts: face 0 has 4 vertices; expected 3, for the scheme loop; the cage is drawn as polygons",
        12,
    ),
    (
        lambda m: m.CreateInterpolateBoundaryAttr("edges"),
        'interpolateBoundary: found "edges"; expected edgeAndCorner, edgeOnly or none; took edgeAndCorner',
        0,
    ),
    (
        lambda m: (m.CreateCornerIndicesAttr([8]), m.CreateCornerSharpnessesAttr([1.0])),
        "cornerIndices: index 0 is 8; expected 0 to 7; it is left out",
        0,
    ),
    (
        lambda m: (m.CreateCornerIndicesAttr([1]), m.CreateCornerSharpnessesAttr([float("nan")])),
        "cornerSharpnesses: value 0 is nan; expected 0 (smooth) to 10 (sharp); it is left out",
        0,
    ),
    (
        lambda m: (
            m.CreateCreaseLengthsAttr([3]),
            m.CreateCreaseIndicesAttr([0, 1]),
            m.CreateCreaseSharpnessesAttr([1]),
        ),
        "creaseLengths: the lengths add up to 3; expected 2, the number of creaseIndices; it is left out",
        0,
    ),
    (
        lambda m: (
            m.CreateCreaseLengthsAttr([3]),
            m.CreateCreaseIndicesAttr([0, 1, 3]),
            m.CreateCreaseSharpnessesAttr([1, 2, 3]),
        ),
        "creaseSharpnesses: found 3 values; expected 1 (one a crease) or 2 (one an edge); it is left out",
        0,
    ),
    (
        lambda m: m.GetFaceVertexIndicesAttr().Set([0, 1, 1, 1, *np.ravel(FACES[1:]).tolist()]),
        "subdivisionScheme: ",
        12,
    ),
]


@pytest.mark.parametrize(("spoil", "said", "count"), BAD, ids=range(len(BAD)))
def test_bad_input_is_one_warning_and_the_rest_is_drawn(
    spoil: Callable[[UsdGeom.Mesh], object], said: str, count: int
) -> None:
    """`count`: the triangles of a cage that is drawn as polygons; 0: it is subdivided all the same."""
    shot = Shot((0.0, 0.0))
    spoil(cube(shot))
    result = read_frame(shot.stage, 10.0, ReadSettings())
    found = messages(result, "warning")
    if found or not said.endswith(": "):
        assert len(found) == 1
        assert found[0].startswith(f"/Cube.{said}")
    size = result.scene.statistics()["triangles"]
    assert size == count if count and found else size > 1000


def test_faces_without_an_area_are_left_out_and_the_others_keep_their_numbers() -> None:
    shot = Shot((0.0, 0.0))
    mesh = sheet(shot, 2)
    mesh.GetFaceVertexCountsAttr().Set([2, 4, 4, 4, 4])
    mesh.GetFaceVertexIndicesAttr().Set([0, 1, *mesh.GetFaceVertexIndicesAttr().Get()])
    colour(mesh, [WHITE, RED, GREEN, BLUE, WHITE], "uniform")
    shot.camera.CreateFocalLengthAttr(150.0)
    UsdLux.DomeLight.Define(shot.stage, "/Dome")
    image = picture(shot)
    height, width = image.shape[:2]
    assert image[height * 5 // 8, width * 7 // 16, :3] == pytest.approx(RED, abs=0.02)
    assert image[height * 5 // 8, width * 9 // 16, :3] == pytest.approx(GREEN, abs=0.02)


def test_a_million_sided_face_ends_soon() -> None:
    shot = Shot((0.0, 0.0))
    angle = np.linspace(0.0, 2.0 * np.pi, 10**6, endpoint=False)
    mesh = UsdGeom.Mesh.Define(shot.stage, "/Disc")
    mesh.CreatePointsAttr(
        Vt.Vec3fArray.FromNumpy(np.stack([np.cos(angle), np.sin(angle), 0 * angle], 1).astype(np.float32))
    )
    mesh.CreateFaceVertexCountsAttr([10**6])
    mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(np.arange(10**6, dtype=np.int32)))
    result = read_frame(shot.stage, 10.0, ReadSettings())
    assert result.scene.statistics()["triangles"] > 0
    assert len(messages(result, "warning")) <= 1


def test_more_points_than_fit_are_a_warning_and_coarser() -> None:
    shot = Shot((0.0, 0.0))
    sheet(shot, 64)
    shot.camera.CreateFocalLengthAttr(5000.0)
    result = read_frame(shot.stage, 10.0, ReadSettings(width=4096, edge_length=0.01))
    (warning,) = messages(result, "warning")
    assert "edges of 0.01 pixels take more than" in warning
    assert result.scene.statistics()["triangles"] < 2**26


def test_a_changing_topology_or_scheme_holds_the_frame() -> None:
    shot = Shot((-0.5, 0.5))
    mesh = cube(shot)
    mesh.CreateCreaseLengthsAttr([2])
    mesh.CreateCreaseIndicesAttr([0, 1])
    mesh.CreateCreaseSharpnessesAttr().Set([1.0], 9.5)
    mesh.GetCreaseSharpnessesAttr().Set([5.0], 10.5)
    found = messages(shot.read(), "warning")
    assert len(found) == 1
    assert found[0].startswith("/Cube.creaseSharpnesses: ")


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
