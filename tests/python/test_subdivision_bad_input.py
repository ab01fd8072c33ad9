"""Subdivision surfaces whose rules, features or cages are wrong, or too large."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from msbvh import _core
from msbvh.scene.reader import ReadResult, ReadSettings, read_frame
from pxr import Gf, Sdf, UsdGeom, UsdLux, Vt
from recording import Shot, messages
from sound_neighbour import retype
from subdivision_stages import BLUE, FACES, GREEN, RED, WHITE, colour, cube, picture, sheet


def creases(mesh: UsdGeom.Mesh, edges: list[tuple[int, int]], sharpness: float) -> None:
    mesh.CreateCreaseLengthsAttr([2] * len(edges))
    mesh.CreateCreaseIndicesAttr(np.ravel(edges).tolist())
    mesh.CreateCreaseSharpnessesAttr([sharpness] * len(edges))


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
        lambda m: creases(m, [(0, 7), (0, 1), (3, 3)], 10.0),
        "creaseIndices: 2 of 3 pairs of vertices are left out (the first is 0, 7); expected edges of the mesh",
        0,
    ),
    (
        lambda m: creases(m, [(0, 1)], float("nan")),
        "creaseSharpnesses: value 0 is nan; expected 0 (smooth) to 10 (sharp); it is left out",
        0,
    ),
    (
        lambda m: creases(m, [(0, 1)], -1.0),
        "creaseSharpnesses: value 0 is -1; expected 0 (smooth) to 10 (sharp); it is left out",
        0,
    ),
    (
        lambda m: m.CreateCreaseIndicesAttr([0, 1]),
        "creaseLengths: the lengths add up to 0; expected 2, the number of creaseIndices; it is left out",
        0,
    ),
    (
        lambda m: m.CreateHoleIndicesAttr([-1, 0, 99, 6]),
        "holeIndices: found face -1 and 2 more, which is left out; expected 0 to 5",
        0,
    ),
    (
        lambda m: m.CreateSubdivisionSchemeAttr(""),
        'subdivisionScheme: found ""; expected catmullClark, loop or bilinear, or none; the cage is drawn as polygons',
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
    (found,) = messages(result, "warning")
    assert found.startswith(f"/Cube.{said}")
    size = result.scene.statistics()["triangles"]
    assert size == count if count else size > 1000


@pytest.mark.parametrize("name", ["creaseIndices", "creaseLengths", "creaseSharpnesses", "cornerIndices"])
def test_features_of_another_type_are_one_message(name: str) -> None:
    shot = Shot((0.0, 0.0))
    mesh = cube(shot)
    creases(mesh, [(0, 1)], 3.0)
    mesh.CreateCornerIndicesAttr([1])
    mesh.CreateCornerSharpnessesAttr([2.0])
    retype(mesh.GetPrim(), name, Sdf.ValueTypeNames.String, "sharp")
    result = read_frame(shot.stage, 10.0, ReadSettings())
    (said,) = messages(result, "warning")
    assert said.startswith(f"/Cube.{name}: found string, expected ")
    assert result.scene.statistics()["triangles"] > 1000


@pytest.mark.parametrize(
    ("lengths", "said"),
    [
        ([-2], "creaseLengths: crease 0 has -2 vertices; expected 2 or more; it is left out"),
        ([2**31 - 1, 2**31 - 1, 4], "creaseLengths: the lengths add up to 4294967298; expected 2"),
    ],
)
def test_lengths_of_creases_that_are_none(lengths: list[int], said: str) -> None:
    shot = Shot((0.0, 0.0))
    mesh = cube(shot)
    creases(mesh, [(0, 1)], 3.0)
    mesh.GetCreaseLengthsAttr().Set(lengths)
    (found,) = messages(read_frame(shot.stage, 10.0, ReadSettings()), "warning")
    assert found.startswith(f"/Cube.{said}")


def test_infinitely_sharp_is_as_sharp_as_10() -> None:
    found = []
    for sharpness in (float("inf"), 10.0):
        shot = Shot((0.0, 0.0))
        mesh = cube(shot)
        creases(mesh, [(0, 1), (1, 3)], sharpness)
        mesh.CreateCornerIndicesAttr([5])
        mesh.CreateCornerSharpnessesAttr([sharpness])
        result = read_frame(shot.stage, 10.0, ReadSettings())
        assert messages(result, "warning") == []
        ((_, _, points),) = result.scene.poses(0.5)
        found.append(points)
    assert np.array_equal(*found)


def cube_of(faces: list[tuple[int, ...]]) -> ReadResult:
    shot = Shot((0.0, 0.0))
    mesh = cube(shot)
    mesh.GetFaceVertexCountsAttr().Set([4] * len(faces))
    mesh.GetFaceVertexIndicesAttr().Set(np.ravel(faces).tolist())
    return read_frame(shot.stage, 10.0, ReadSettings())


@pytest.mark.parametrize(
    "faces",
    [[*FACES, FACES[0]], [*FACES, (0, 1, 6, 7), (0, 1, 5, 6)]],
    ids=["a face twice", "four faces at an edge"],
)
def test_cages_that_are_no_manifold_are_drawn(faces: list[tuple[int, ...]]) -> None:
    result = cube_of(faces)
    assert messages(result, "warning") == []
    assert result.scene.statistics()["triangles"] > 1000


@pytest.mark.parametrize(
    ("face", "vertex"), [((0, 1, 1, 1), 1), ((0, 1, 0, 1), 0)], ids=["a vertex repeated", "an edge back and forth"]
)
def test_cages_whose_faces_visit_a_vertex_twice_are_polygons(face: tuple[int, ...], vertex: int) -> None:
    """OpenSubdiv crashes on some of them."""
    result = cube_of([face, *FACES[1:]])
    (warning,) = messages(result, "warning")
    assert f"face 0 has vertex {vertex} twice; expected distinct vertices; the cage is drawn as polygons" in warning
    assert 0 < result.scene.statistics()["triangles"] < 20


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


def disc(shot: Shot, sides: int) -> UsdGeom.Mesh:
    """One face."""
    angle = np.linspace(0.0, 2.0 * np.pi, sides, endpoint=False)
    mesh = UsdGeom.Mesh.Define(shot.stage, "/Disc")
    rim = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1).astype(np.float32)
    mesh.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(rim))
    mesh.CreateFaceVertexCountsAttr([sides])
    mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(np.arange(sides, dtype=np.int32)))
    return mesh


@pytest.mark.parametrize("sides", [257, 10**6])
def test_faces_of_too_many_sides_are_polygons(sides: int, capfd: pytest.CaptureFixture[str]) -> None:
    shot = Shot((0.0, 0.0))
    disc(shot, sides)
    result = read_frame(shot.stage, 10.0, ReadSettings())
    (warning,) = messages(result, "warning")
    assert warning.endswith(f"face 0 has {sides} vertices; expected 3 to 256; the cage is drawn as polygons")
    assert result.scene.statistics()["triangles"] == sides - 2
    assert capfd.readouterr() == ("", "")  # OpenSubdiv has nothing to say of its own


def test_vertices_of_too_many_faces_are_polygons() -> None:
    shot = Shot((0.0, 0.0))
    mesh, sides = disc(shot, 257), np.arange(257)
    mesh.GetFaceVertexCountsAttr().Set([3] * 256)
    fan = np.stack([np.zeros(255, int), sides[1:-1], sides[2:]], axis=1).ravel().tolist()
    mesh.GetFaceVertexIndicesAttr().Set([*fan, 0, 1, 256])
    assert messages(read_frame(shot.stage, 10.0, ReadSettings(width=100)), "warning") == []
    mesh.GetFaceVertexCountsAttr().Set([3] * 257)
    mesh.GetFaceVertexIndicesAttr().Set([*fan, 0, 1, 256, 0, 2, 200])
    (warning,) = messages(read_frame(shot.stage, 10.0, ReadSettings(width=100)), "warning")
    assert warning.endswith("257 faces share vertex 0; expected at most 256; the cage is drawn as polygons")


def test_creases_that_are_all_different_take_bounded_memory() -> None:
    """OpenSubdiv keeps what it prepares for each shape of a face, and here no two are alike: 5 MB each, were all kept."""
    shot = Shot((0.0, 0.0))
    mesh = sheet(shot, 24)
    edges = [(25 * y + x, 25 * y + x + 1) for y in range(25) for x in range(24)]
    creases(mesh, edges, 0.0)
    mesh.GetCreaseSharpnessesAttr().Set(np.random.default_rng(1).uniform(9.0, 9.9, len(edges)).tolist())
    kept = _core.RefinementCache(1 << 30)
    result = read_frame(shot.stage, 10.0, ReadSettings(width=60), refinements=kept)
    assert messages(result, "warning") == []
    assert kept.bytes < 200 << 20


@pytest.mark.parametrize("height", [0.0, 1e-6], ids=["in the surface", "on the surface"])
def test_an_eye_in_the_middle_of_it_takes_bounded_points(height: float) -> None:
    shot = Shot((0.0, 0.0))
    sheet(shot, 1)
    next(iter(shot.camera.GetOrderedXformOps())).Set(Gf.Vec3d(0, 0, height))
    result = read_frame(shot.stage, 10.0, ReadSettings(width=4096))
    assert 1000 < result.scene.statistics()["triangles"] <= 2 * 1024**2


@pytest.mark.parametrize("scale", [1e-6, 1e6])
def test_cages_of_any_size_are_the_same_in_the_picture(scale: float) -> None:
    counts = []
    for size in (1.0, scale):
        shot = Shot((0.0, 0.0))
        cube(shot).AddScaleOp().Set(Gf.Vec3f(size))
        next(iter(shot.camera.GetOrderedXformOps())).Set(Gf.Vec3d(0, 0, 20 * size))
        shot.camera.CreateClippingRangeAttr(Gf.Vec2f(size, 100 * size))
        result = read_frame(shot.stage, 10.0, ReadSettings(width=100))
        counts.append(result.scene.statistics()["triangles"])
        assert messages(result, "warning") == []
    assert counts[0] == counts[1] > 1000


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
    mesh.GetCreaseSharpnessesAttr().Clear()
    scheme = mesh.GetSubdivisionSchemeAttr()
    scheme.Clear()
    scheme.Set("none", 9.0)
    scheme.Set("catmullClark", 10.2)
    result = shot.read()
    (warning,) = messages(result, "warning")
    assert warning.startswith("/Cube.subdivisionScheme: changes within the shutter")
    assert len(result.scene.points("/Cube", 0.5)) == 8
