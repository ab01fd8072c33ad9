"""How far what is drawn strays from the true surface, as the reader reports it where it is asked for.

The measure itself is held against brute force in C++ (tests/translate/test_stray.cpp).
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from displaced_stages import Displaced
from limit_surface import Cage
from msbvh import _core
from msbvh.base.reporter import Reporter
from msbvh.render.record import record
from msbvh.render.settings import RecordSettings, RenderSettings
from msbvh.scene.implicit import IMPLICIT_TYPES
from msbvh.scene.reader import ReadSettings
from pxr import Gf, Sdf, UsdGeom
from recording import Shot
from subdivision_stages import CORNERS, FACES, cube, sheet

WIDTH = 400
PIXELS_PER_UNIT = WIDTH * 50.0 / 20.955
"""Of the shot's camera at unit distance, in the middle of the picture."""


def errors(shot: Shot, **settings: Any) -> dict[str, float | None]:
    """shape_error_pixels by prim."""
    settings = {"width": WIDTH, "measure_shape": True, **settings}
    return {track.path: track.shape_error_pixels for track in shot.read(**settings).tracks}


def corner_stretch(result: Any) -> float:
    """By which ScreenMeasure counts a deviation as more than in the picture's middle."""
    left, _, _, top = result.camera.windows[0]
    return 1.0 + left**2 + top**2


def test_a_cube_drawn_as_its_cage_strays_by_its_corners() -> None:
    """They are the farthest from the surface, which is known by Catmull-Clark's rules after 4 steps."""
    shot = Shot((0.0, 0.0))
    cube(shot)
    refined = Cage.of(FACES, 8).refined(4)
    surface = refined.weights @ CORNERS
    eye = np.array([0.0, 0.0, 20.0])
    distances = np.linalg.norm(CORNERS[:, None] - surface[None], axis=-1).min(axis=1)
    pixels = distances * PIXELS_PER_UNIT / np.linalg.norm(CORNERS - eye, axis=1)
    result = shot.read(width=WIDTH, edge_length=0.0, measure_shape=True)
    found = result.tracks[-1].shape_error_pixels
    assert found == pytest.approx(pixels.max() * corner_stretch(result), rel=0.03)


def test_shorter_edges_stray_less_and_high_is_under_a_tenth_of_a_pixel() -> None:
    shot = Shot((0.0, 0.0))
    cube(shot)
    found = [errors(shot, complexity=name)["/Cube"] for name in ("low", "medium", "high", "veryhigh")]
    assert found == sorted(found, reverse=True)
    assert found[0] > 5.0 > 1.0 > found[1]
    assert 0.0 < found[2] < 0.1


def test_it_is_off_unless_asked_for() -> None:
    shot = Shot((0.0, 0.0))
    cube(shot)
    assert not ReadSettings().measure_shape
    assert set(errors(shot, measure_shape=False).values()) == {None}


def test_polygons_curves_and_points_are_what_they_are() -> None:
    shot = Shot((-0.5, 0.5))
    shot.mesh("/Square")
    cube(shot, "/Polygons", "none").AddTranslateOp().Set(Gf.Vec3d(1, 0, 0), 10.0)
    curves = UsdGeom.BasisCurves.Define(shot.stage, "/Curves")
    curves.CreateCurveVertexCountsAttr([4])
    curves.CreatePointsAttr([(0, 0, 0), (1, 1, 0), (2, 0, 0), (3, 1, 0)])
    points = UsdGeom.Points.Define(shot.stage, "/Points")
    points.CreatePointsAttr([(0, 0, 0)])
    points.CreateWidthsAttr([0.5])
    UsdGeom.Cube.Define(shot.stage, "/Box")
    found = errors(shot)
    assert found.pop("/Camera") is None
    assert found == {"/Square": 0.0, "/Polygons": 0.0, "/Curves": 0.0, "/Points": 0.0, "/Box": 0.0}


def test_what_is_not_measured_says_so() -> None:
    """NURBS patches come as polygons that only stand for them."""
    shot = Shot((0.0, 0.0))
    patch = UsdGeom.NurbsPatch.Define(shot.stage, "/Patch")
    patch.CreatePointsAttr([(x, y, x * y) for y in range(4) for x in range(4)])
    for create in (
        patch.CreateUVertexCountAttr,
        patch.CreateVVertexCountAttr,
        patch.CreateUOrderAttr,
        patch.CreateVOrderAttr,
    ):
        create(4)
    for knots in (patch.CreateUKnotsAttr, patch.CreateVKnotsAttr):
        knots([0, 0, 0, 0, 1, 1, 1, 1])
    assert errors(shot)["/Patch"] is None


@pytest.mark.parametrize("kind", sorted(IMPLICIT_TYPES))
@pytest.mark.parametrize("complexity", ["low", "high"])
def test_implicit_shapes_stray_by_less_than_their_sides_are_chosen_for(kind: str, complexity: str) -> None:
    shot = Shot((0.0, 0.0))
    shape = UsdGeom.Gprim(shot.stage.DefinePrim("/Shape", kind))
    shape.AddRotateXYZOp().Set(Gf.Vec3f(30, 40, 50))
    found = errors(shot, complexity=complexity)["/Shape"]
    assert found is not None
    if IMPLICIT_TYPES[kind].smooth:
        # The measure of motion counts a deviation by the corner's stretch and where it is seen largest.
        assert 0.0 < found < 1.25 * _core.SILHOUETTES[complexity]
    else:
        assert found == 0.0


@pytest.mark.parametrize("kind", ["Sphere", "Cylinder"])
def test_shapes_in_crowds_say_it_by_their_places(kind: str) -> None:
    shot = Shot((0.0, 0.0))
    for i in range(24):
        shape = UsdGeom.Gprim(shot.stage.DefinePrim(f"/Crowd/S_{i}", kind))
        shape.AddTranslateOp().Set(Gf.Vec3d(2.0 * (i % 6) - 5.0, 2.0 * (i // 6) - 3.0, 0.0))
        shape.AddScaleOp().Set(Gf.Vec3f(0.5))
    result = shot.read(width=WIDTH, measure_shape=True)
    assert result.scene.prototypes
    prims: dict[str, list[float | None]] = {}
    for track in result.tracks[1:]:
        prims.setdefault(track.path, []).append(track.shape_error_pixels)
    assert len(prims) == 24
    # The mesh itself, under the first one's name, is of no size.
    assert prims["/Crowd/S_0"].pop(0) is None
    assert all(len(found) == 1 and found[0] is not None for found in prims.values())
    assert all(0.0 < found[0] < 1.25 * _core.SILHOUETTES["high"] for found in prims.values() if found[0])


def test_instanced_surfaces_stray_as_where_they_are_seen_largest() -> None:
    alone, instanced = Shot((0.0, 0.0)), Shot((0.0, 0.0))
    cube(alone)
    instanced.stage.CreateClassPrim("/P")
    cube(instanced, "/P/Cube")
    for i, depth in enumerate((0.0, -30.0)):
        prim = UsdGeom.Xform.Define(instanced.stage, f"/I_{i}")
        prim.AddTranslateOp().Set(Gf.Vec3d(0, 0, depth))
        prim.GetPrim().GetReferences().AddInternalReference("/P")
        prim.GetPrim().SetInstanceable(True)
    expected = errors(alone, edge_length=8.0)["/Cube"]
    (found,) = [error for error in errors(instanced, edge_length=8.0).values() if error is not None]
    # As if all of it were as near as the nearest corner of its box.
    assert expected * 0.9 <= found <= expected * 1.3


def bumpy(shot: Shot, heights: np.ndarray) -> tuple[UsdGeom.Mesh, np.ndarray]:
    """A sheet of 3 x 3 unit quads, and its points raised by the heights."""
    mesh = sheet(shot, 3)
    flat = np.array(mesh.GetPointsAttr().Get())
    return mesh, flat + heights[:, None] * (0, 0, 1)


def test_a_displaced_sheet_strays_as_the_same_surface_without_displacement() -> None:
    """Heights by a vertex primvar are subdivided as points are, and the normals of a flat sheet stand upright."""
    heights = np.array([0.0, 0.1, -0.1, 0.2, 0.3, -0.2, 0.2, 0.0, -0.1, 0.3, -0.3, 0.1, 0.2, 0.0, 0.1, -0.2])
    raised, displaced = Shot((0.0, 0.0)), Displaced()
    mesh, points = bumpy(raised, heights)
    mesh.GetPointsAttr().Set([Gf.Vec3f(*point) for point in points])
    mesh, _ = bumpy(displaced, heights)
    displaced.bound(mesh)
    primvar = UsdGeom.PrimvarsAPI(mesh).CreatePrimvar("height", Sdf.ValueTypeNames.FloatArray, "vertex")
    primvar.Set(heights.tolist())
    displaced.read_primvar("height")
    for edge in (16.0, 4.0):
        expected = errors(raised, edge_length=edge)["/Sheet"]
        assert expected and expected > 0.01
        for kept in ("tessellate", "patches"):
            found = errors(displaced, edge_length=edge, displacement=kept)["/Sheet"]
            assert found == pytest.approx(expected, rel=0.05)


def test_displaced_polygons_are_not_measured() -> None:
    shot = Displaced(0.5)
    shot.bound(shot.mesh("/Square"))
    assert errors(shot)["/Square"] is None


def test_statistics_have_null_where_it_is_not_measured(tmp_path: Path) -> None:
    shot = Shot((0.0, 0.0))
    cube(shot)
    stage, stats = tmp_path / "cube.usda", tmp_path / "stats.json"
    shot.stage.Export(str(stage))
    for measure in (False, True):
        settings = RecordSettings(ReadSettings(width=32, measure_shape=measure), RenderSettings(spp=1), stats=stats)
        record(str(stage), [str(tmp_path / f"{measure}.exr")], settings, Reporter())
        frame = json.loads(stats.read_text())["frames"][0]
        tracks = {track["path"]: track["shape_error_pixels"] for track in frame["tracks"]}
        assert tracks["/Camera"] is None
        assert 0.0 < tracks["/Cube"] < 1.0 if measure else tracks["/Cube"] is None
