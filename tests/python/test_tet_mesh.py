"""TetMesh prims: the triangles of their surface, moved as meshes are."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from drawn import apart
from msbvh.scene.reader import ReadSettings, read_frame
from pxr import Gf, Sdf, Usd, UsdGeom, UsdShade, Vt
from recording import DENSE_TIMES01, Shot, messages, usd_points_at, worst_deviation
from skinning_oracle import bind, pixels, spinning_arm, worst_skinned_deviation
from sound_neighbour import CAMERA, GOOD, render, retype, shows_good, stage_of

# A cube of side 2 in five tetrahedra.
CORNERS = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
TETS = [(0, 3, 5, 6), (1, 0, 3, 5), (2, 6, 3, 0), (4, 5, 6, 0), (7, 6, 5, 3)]


def tets(shot: Shot, path: str = "/Tets", surface: bool = True) -> UsdGeom.TetMesh:
    mesh = UsdGeom.TetMesh.Define(shot.stage, path)
    mesh.CreatePointsAttr([Gf.Vec3f(*corner) for corner in CORNERS])
    mesh.CreateTetVertexIndicesAttr([Gf.Vec4i(*element) for element in TETS])
    if surface:
        mesh.CreateSurfaceFaceVertexIndicesAttr(UsdGeom.TetMesh.ComputeSurfaceFaces(mesh))
    return mesh


def volume(mesh: dict) -> float:
    points = mesh["points"][0][1].astype(float)[mesh["face_vertex_indices"].reshape(-1, 3)]
    return float(np.linalg.det(points).sum() / 6) * (-1 if mesh["left_handed"] else 1)


@pytest.mark.parametrize("authored", [True, False])
@pytest.mark.parametrize("orientation", ["rightHanded", "leftHanded"])
def test_the_surface_is_drawn(authored: bool, orientation: str) -> None:
    shot = Shot((0.0, 0.0))
    mesh = tets(shot, surface=False)
    mesh.CreateOrientationAttr(orientation)
    expected = UsdGeom.TetMesh.ComputeSurfaceFaces(mesh)
    if authored:
        mesh.CreateSurfaceFaceVertexIndicesAttr(expected)
    result = shot.read()
    found = result.scene.meshes["/Tets"]
    assert messages(result, "warning") == []
    assert found["face_vertex_counts"].tolist() == [3] * 12
    assert found["face_vertex_indices"].reshape(-1, 3).tolist() == [list(face) for face in expected]
    inverted = len(UsdGeom.TetMesh.FindInvertedElements(mesh)) > 0
    assert volume(found) == pytest.approx(-8.0 if inverted else 8.0)


def test_a_part_of_the_surface_may_be_authored() -> None:
    shot = Shot((0.0, 0.0))
    tets(shot).GetSurfaceFaceVertexIndicesAttr().Set([Gf.Vec3i(0, 1, 3)])
    assert shot.read().scene.meshes["/Tets"]["face_vertex_indices"].tolist() == [0, 1, 3]


def test_it_is_no_subdivision_surface() -> None:
    shot = Shot((0.0, 0.0))
    tets(shot)
    result = read_frame(shot.stage, 10.0, ReadSettings())
    assert result.scene.statistics()["triangles"] == 12
    assert shot.read().scene.meshes["/Tets"]["computed_normals"] in (None, "faceted")


def test_samples_move_it() -> None:
    shot = Shot((-1.0, 1.0))
    mesh = tets(shot)
    for time, size in ((9.0, 1.0), (9.7, 1.5), (11.0, 0.7)):
        mesh.GetPointsAttr().Set(Vt.Vec3fArray.FromNumpy(np.array(CORNERS, np.float32) * size), time)
    mesh.AddRotateYOp().Set(0.0, 9.0)
    mesh.GetOrderedXformOps()[0].Set(70.0, 11.0)
    assert worst_deviation(shot.read(motion_tolerance=0.01), mesh.GetPrim()) < 2e-3


@pytest.mark.parametrize("accelerated", [False, True])
def test_velocities_and_accelerations_carry_it(accelerated: bool) -> None:
    shot = Shot((-0.5, 0.5))
    mesh = tets(shot)
    mesh.GetPointsAttr().Clear()
    mesh.GetPointsAttr().Set([Gf.Vec3f(*corner) for corner in CORNERS], 10.0)
    mesh.CreateVelocitiesAttr().Set([Gf.Vec3f(24, 12 * i, 0) for i in range(8)], 10.0)
    if accelerated:
        mesh.CreateAccelerationsAttr().Set([Gf.Vec3f(0, 0, -600)] * 8, 10.0)
    result = shot.read(motion_tolerance=0.01)
    assert worst_deviation(result, mesh.GetPrim()) < 1e-3
    ends = [result.scene.points("/Tets", time01) for time01 in (0.0, 1.0)]
    assert np.abs(ends[1] - ends[0]).max() > 0.9


def test_a_skeleton_moves_it() -> None:
    arm = spinning_arm()
    mesh = tets(arm.shot, "/Root/Tets")
    bind(arm, mesh.GetPrim(), np.array([(x + 1) / 2 for x, _, _ in CORNERS]))
    result = arm.shot.read()
    assert messages(result, "warning") == []
    assert pixels(result, mesh.GetPrim(), worst_skinned_deviation(result, mesh.GetPrim())) <= 0.05


def test_tetrahedra_that_change_hold_the_frames_pose() -> None:
    shot = Shot((-1.0, 1.0))
    mesh = tets(shot, surface=False)
    for time, elements in ((9.0, TETS), (10.0, TETS[:1]), (11.0, TETS[:2])):
        mesh.GetTetVertexIndicesAttr().Set([Gf.Vec4i(*element) for element in elements], time)
        mesh.GetPointsAttr().Set([Gf.Vec3f(*corner) * time for corner in CORNERS], time)
    result = shot.read()
    message = "/Tets.points: the topology changes within the shutter and no velocities apply; held the frame's pose"
    assert messages(result, "warning") == [message]
    assert len(result.scene.meshes["/Tets"]["face_vertex_counts"]) == 4
    for time01 in DENSE_TIMES01[::8]:
        expected = usd_points_at(mesh.GetPrim(), Usd.TimeCode(10.0), Usd.TimeCode(10.0))
        assert apart(result.scene.points("/Tets", time01), expected) < 1e-4


def test_primvars_normals_and_subsets() -> None:
    shot = Shot((0.0, 0.0))
    mesh = tets(shot)
    mesh.CreateDisplayColorPrimvar("uniform").Set([Gf.Vec3f(i / 12, 0, 0) for i in range(12)])
    mesh.CreateDisplayOpacityPrimvar("vertex").Set([1.0] * 8)
    mesh.CreateNormalsAttr([Gf.Vec3f(0, 0, 1)] * 8)
    mesh.SetNormalsInterpolation("vertex")
    red = UsdShade.Material.Define(shot.stage, "/Red")
    shader = UsdShade.Shader.Define(shot.stage, "/Red/Surface")
    shader.CreateIdAttr("UsdPreviewSurface")
    shader.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).Set(Gf.Vec3f(1, 0, 0))
    red.CreateSurfaceOutput().ConnectToSource(shader.CreateOutput("surface", Sdf.ValueTypeNames.Token))
    subset = UsdGeom.Subset.CreateGeomSubset(mesh, "Part", "face", Vt.IntArray([2, 5]), "materialBind")
    UsdShade.MaterialBindingAPI.Apply(subset.GetPrim()).Bind(red)
    result = shot.read()
    assert messages(result, "warning") == []
    found = result.scene.meshes["/Tets"]
    assert found["display_color"][0] == "uniform" and len(found["normals"][0][1]) == 8
    assert [i for i, material in enumerate(found["face_materials"]) if material >= 0] == [2, 5]


def edit(prim: Usd.Prim, name: str, value: object) -> None:
    prim.GetAttribute(name).Set(value)


BAD: list[tuple[Callable[[Usd.Prim], object], str]] = [
    (
        lambda prim: edit(prim, "surfaceFaceVertexIndices", [Gf.Vec3i(0, 1, 8)]),
        "/Bad.surfaceFaceVertexIndices: index 2 is 8; expected 0 to 7 (8 points); the prim is not drawn",
    ),
    (
        lambda prim: edit(prim, "tetVertexIndices", [Gf.Vec4i(0, 1, 2, 3), Gf.Vec4i(0, 1, -2, 3)]),
        "/Bad.tetVertexIndices: element 1 has the point -2, expected 0 to 7; the prim is not drawn",
    ),
    (
        lambda prim: retype(prim, "tetVertexIndices", Sdf.ValueTypeNames.IntArray, Vt.IntArray([0, 1, 2, 3])),
        "/Bad.tetVertexIndices: found int[], expected int4[]; the prim is not drawn",
    ),
    (
        lambda prim: edit(prim, "points", [Gf.Vec3f(float("nan"))] * 8),
        "/Bad.points: value 0 at shutter time 0 (0 is the opening, 1 the closing) is (nan, nan, nan); expected finite",
    ),
    (
        lambda prim: prim.GetAttribute("points").Clear(),
        "/Bad.tetVertexIndices: element 0 has the point 0, expected those of 0 points; the prim is not drawn",
    ),
]


@pytest.mark.parametrize(("spoil", "message"), BAD, ids=range(len(BAD)))
def test_bad_input_is_one_message(spoil: Callable[[Usd.Prim], object], message: str) -> None:
    stage = stage_of(
        CAMERA
        + GOOD
        + f"""
        def TetMesh "Bad" {{
            point3f[] points = {CORNERS}
            int4[] tetVertexIndices = {TETS}
        }}"""
    )
    spoil(stage.GetPrimAtPath("/Bad"))
    result, picture = render(stage)
    (found,) = messages_of(result)
    assert found.startswith(message)
    assert shows_good(picture)


def messages_of(result: object) -> list[str]:
    return [str(d) for d in result.diagnostics if d.severity in ("warning", "error")]


def test_without_tetrahedra_there_is_nothing_to_draw() -> None:
    stage = stage_of(CAMERA + GOOD + 'def TetMesh "Bad" {}')
    result, picture = render(stage)
    assert messages_of(result) == []
    assert [str(d) for d in result.diagnostics] == ["/Bad: empty: it has neither faces nor points at this frame"]
    assert shows_good(picture)
