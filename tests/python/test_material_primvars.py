"""The primvars that materials read: on every kind of prim, of every interpolation, inherited, moving, of instances."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from material_stage import TYPES, LookShot, add_primvar
from pxr import Gf, Sdf, UsdGeom, UsdShade
from recording import messages

SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]


class Reading(LookShot):
    """Whose material reads a primvar of two numbers for its diffuseColor, and others that a test asks for."""

    def __init__(self, **camera: Any) -> None:
        super().__init__(**camera)
        self.reader("st", "float2", "diffuseColor")


@pytest.mark.parametrize(
    ("interpolation", "values", "kept", "count"),
    [
        ("constant", [(0.5, 0.25)], "constant", 1),
        ("uniform", [(0.5, 0.25)], "triangle", 2),
        ("varying", SQUARE, "vertex", 4),
        ("vertex", SQUARE, "vertex", 4),
        ("faceVarying", SQUARE, "faceVarying", 6),
    ],
)
def test_every_interpolation_of_a_mesh(interpolation: str, values: list, kept: str, count: int) -> None:
    shot = Reading()
    mesh = shot.bind(shot.mesh("/Mesh"))
    add_primvar(mesh, "st", TYPES.TexCoord2fArray, interpolation, values)
    add_primvar(mesh, "unread", TYPES.FloatArray, "constant", [1.0])
    result = shot.read()
    found = result.scene.primvars("/Mesh")
    assert found.keys() == {"st"}
    assert found["st"][:2] == (kept, 0) and found["st"][2].shape == (count, 3)
    assert found["st"][2][0, :2] == pytest.approx(values[0]) and not found["st"][2][:, 2].any()
    assert messages(result) == []


@pytest.mark.parametrize(
    ("kind", "value", "read_as", "expected"),
    [
        (TYPES.FloatArray, [0.5], "float", (0.5, 0, 0)),
        (TYPES.Float, 0.5, "float", (0.5, 0, 0)),
        (TYPES.IntArray, [3], "int", (3, 0, 0)),
        (TYPES.DoubleArray, [0.5], "float", (0.5, 0, 0)),
        (TYPES.Color3fArray, [(0.25, 0.5, 1)], "float3", (0.25, 0.5, 1)),
        (TYPES.Color3h, Gf.Vec3h(0.25, 0.5, 1), "float3", (0.25, 0.5, 1)),
        (TYPES.Normal3fArray, [(0, 0, 1)], "normal", (0, 0, 1)),
        (TYPES.Point3dArray, [(1, 2, 3)], "point", (1, 2, 3)),
        (TYPES.Vector3fArray, [(1, 2, 3)], "vector", (1, 2, 3)),
        (TYPES.Color4fArray, [(0.25, 0.5, 0.75, 1)], "float4", (0.25, 0.5, 0.75)),
        (TYPES.Color4fArray, [(0.25, 0.5, 0.75, 1)], "float3", (0.25, 0.5, 0.75)),
        (TYPES.TexCoord3fArray, [(0.25, 0.5, 0.75)], "float2", (0.25, 0.5, 0.75)),
    ],
)
def test_every_type_of_numbers(kind: Sdf.ValueTypeName, value: Any, read_as: str, expected: tuple) -> None:
    shot = LookShot()
    shot.reader("wet", read_as, "diffuseColor")
    add_primvar(shot.bind(shot.mesh("/Mesh")), "wet", kind, "constant", value)
    result = shot.read()
    assert result.scene.primvars("/Mesh")["wet"][2][0] == pytest.approx(expected)
    assert messages(result) == []


@pytest.mark.parametrize(
    ("kind", "value", "said"),
    [
        (TYPES.StringArray, ["a"], "found string[], expected 3 numbers"),
        (TYPES.Matrix4dArray, [Gf.Matrix4d(1)], "found matrix4d[], expected 3 numbers"),
        (TYPES.FloatArray, [0.5], "found float[], expected 3 numbers"),
        (TYPES.Float2Array, [(0.5, 1)], "found float2[], expected 3 numbers"),
        (TYPES.Color3fArray, [], "is not there, or empty"),
        (TYPES.Color3fArray, [(1, 1, 1)] * 3, "found 3 values; expected 1 for the interpolation constant"),
        (TYPES.Color3fArray, [(np.nan, 1, 1)], "not finite"),
    ],
)
def test_what_does_not_fit_is_named_and_left_out(kind: Sdf.ValueTypeName, value: Any, said: str) -> None:
    shot = LookShot()
    shot.reader("wet", "float3", "diffuseColor")
    add_primvar(shot.bind(shot.mesh("/Mesh")), "wet", kind, "constant", value)
    result = shot.read()
    assert result.scene.primvars("/Mesh") == {}
    (warning,) = messages(result, "warning")
    assert warning.startswith("/Mesh.primvars:wet: ") and said in warning


def test_indexed_inherited_and_missing_primvars() -> None:
    shot = Reading()
    parent = UsdGeom.Xform.Define(shot.stage, "/Group")
    add_primvar(parent, "st", TYPES.TexCoord2fArray, "constant", [(0.25, 0.75)])
    shot.bind(shot.mesh("/Group/Inherits"))
    own = shot.bind(shot.mesh("/Group/Own"))
    add_primvar(own, "st", TYPES.TexCoord2fArray, "faceVarying", [(0, 0), (1, 1)], [0, 1, 1, 0])
    shot.bind(shot.mesh("/Missing"))
    shot.bind(shot.mesh("/Missing_too"))
    result = shot.read()
    assert result.scene.primvars("/Group/Inherits")["st"][2].tolist() == [[0.25, 0.75, 0]]
    assert result.scene.primvars("/Group/Own")["st"][2][:, 0].tolist() == [0, 1, 1, 0, 1, 0]
    assert result.scene.primvars("/Missing") == {}
    (note,) = messages(result)
    assert note.startswith("/Missing.primvars:st: is not there; drawn as what its reader falls back to")
    assert note.endswith("(and 1 more prims)")


def test_values_that_move_have_keys_and_indices_that_change_are_held() -> None:
    shot = Reading()
    moving = shot.bind(shot.mesh("/Moving"))
    primvar = add_primvar(moving, "st", TYPES.TexCoord2fArray, "vertex", SQUARE)
    for time in (9.5, 10.5):
        primvar.Set([(s + time, t) for s, t in SQUARE], time)
    stepping = shot.bind(shot.mesh("/Stepping"))
    primvar = add_primvar(stepping, "st", TYPES.TexCoord2fArray, "vertex", SQUARE, [0, 1, 2, 3])
    primvar.GetIndicesAttr().Set([0, 1, 2, 3], 9.0)
    primvar.GetIndicesAttr().Set([3, 2, 1, 0], 10.25)
    result = shot.read()
    interpolation, segments, values = result.scene.primvars("/Moving")["st"]
    assert (interpolation, segments) == ("vertex", 1)
    assert values[0, 0] == 9.5 and values[4, 0] == 10.5
    assert result.scene.primvars("/Stepping")["st"][2][:, :2].tolist() == [list(st) for st in SQUARE]
    assert messages(result, "warning") == [
        "/Stepping.primvars:st: changes in steps within the shutter; drawn by the frame's values"
    ]


def test_a_subdivided_mesh_refines_them() -> None:
    shot = Reading()
    mesh = shot.mesh("/Mesh")
    mesh.GetSubdivisionSchemeAttr().Set("catmullClark")
    add_primvar(shot.bind(mesh), "st", TYPES.TexCoord2fArray, "faceVarying", SQUARE)
    result = shot.read()
    interpolation, _, values = result.scene.primvars("/Mesh")["st"]
    assert interpolation == "faceVarying" and len(values) > 6
    assert values.min() >= 0 and values.max() <= 1


def test_materials_of_faces_ask_for_theirs() -> None:
    shot = Reading()
    mesh = shot.mesh("/Mesh")
    mesh.GetFaceVertexCountsAttr().Set([3, 3])
    mesh.GetFaceVertexIndicesAttr().Set([0, 1, 2, 0, 2, 3])
    add_primvar(mesh, "st", TYPES.TexCoord2fArray, "vertex", SQUARE)
    assert shot.read().scene.primvars("/Mesh") == {}
    subset = UsdGeom.Subset.CreateGeomSubset(mesh, "part", "face", [1], "materialBind")
    shot.bind(subset)
    assert shot.read().scene.primvars("/Mesh").keys() == {"st"}


def test_curves_and_points() -> None:
    shot = Reading()
    curves = UsdGeom.BasisCurves.Define(shot.stage, "/Curves")
    curves.CreateTypeAttr("linear")
    curves.CreateCurveVertexCountsAttr([3, 3])
    curves.CreatePointsAttr([(0, 0, 0), (1, 0, 0), (2, 0, 0), (0, 1, 0), (1, 1, 0), (2, 1, 0)])
    points = UsdGeom.Points.Define(shot.stage, "/Points")
    points.CreatePointsAttr([(0, 3, 0), (1, 3, 0)])
    for shape in (curves, points):
        shape.CreateWidthsAttr([0.1])
        UsdGeom.PointBased(shape).GetPrim().GetAttribute("widths").SetMetadata("interpolation", "constant")
        shot.bind(shape)
    add_primvar(curves, "st", TYPES.TexCoord2fArray, "uniform", [(0, 0), (1, 0)])
    add_primvar(points, "st", TYPES.TexCoord2fArray, "vertex", [(0, 0), (1, 0)])
    result = shot.read()
    assert result.scene.primvars("/Curves")["st"][0] == "triangle"
    assert result.scene.primvars("/Curves")["st"][2][:, 0].tolist() == [0, 0, 1, 1]
    assert result.scene.primvars("/Points")["st"][2][:, 0].tolist() == [0, 1]


@pytest.mark.parametrize("count", [1, 40])
def test_implicit_shapes_have_constant_ones_alone_or_in_a_crowd(count: int) -> None:
    shot = Reading()
    for index in range(count):
        ball = UsdGeom.Sphere.Define(shot.stage, f"/Ball_{index}")
        UsdGeom.XformCommonAPI(ball).SetTranslate((index, 0, 0))
        shot.bind(ball)
        add_primvar(ball, "st", TYPES.TexCoord2fArray, "constant", [(index, 0)])
    scene = shot.read().scene
    assert [scene.primvars(f"/Ball_{index}")["st"][2][0, 0] for index in range(count)] == list(range(count))


def test_a_nurbs_patch_carries_them_to_its_polygons() -> None:
    shot = Reading()
    patch = UsdGeom.NurbsPatch.Define(shot.stage, "/Patch")
    for axis in "UV":
        getattr(patch, f"Create{axis}VertexCountAttr")(2)
        getattr(patch, f"Create{axis}OrderAttr")(2)
        getattr(patch, f"Create{axis}KnotsAttr")([0.0, 0.0, 1.0, 1.0])
        getattr(patch, f"Create{axis}RangeAttr")(Gf.Vec2d(0, 1))
    patch.CreatePointsAttr([(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)])
    add_primvar(shot.bind(patch), "st", TYPES.TexCoord2fArray, "vertex", [(0, 0), (1, 0), (0, 1), (1, 1)])
    result = shot.read()
    interpolation, _, values = result.scene.primvars("/Patch")["st"]
    assert interpolation == "vertex" and len(values) >= 4
    assert sorted(map(tuple, values[:, :2].tolist()))[0] == (0, 0) and values[:, :2].max() == 1


def instancer(shot: LookShot, count: int = 3) -> UsdGeom.PointInstancer:
    made = UsdGeom.PointInstancer.Define(shot.stage, "/Instancer")
    shot.bind(shot.mesh("/Instancer/Proto"))
    made.CreatePrototypesRel().AddTarget("/Instancer/Proto")
    made.CreateProtoIndicesAttr([0] * count)
    made.CreatePositionsAttr([(index, 0, 0) for index in range(count)])
    return made


@pytest.mark.parametrize("interpolation", ["vertex", "uniform", "varying"])
def test_each_instance_of_an_instancer_has_its_own(interpolation: str) -> None:
    shot = Reading()
    made = instancer(shot)
    add_primvar(made, "st", TYPES.TexCoord2fArray, interpolation, [(0, 5), (1, 5)], [1, 0, 1])
    add_primvar(made, "unread", TYPES.FloatArray, interpolation, [0, 1, 2])
    add_primvar(made, "displayOpacity", TYPES.FloatArray, interpolation, [0.25, 0.5, 1])
    result = shot.read()
    found = result.scene.instance_primvars("/Instancer")
    assert found["st"].tolist() == [[1, 5, 0], [0, 5, 0], [1, 5, 0]]
    assert found["displayOpacity"] == [0.25, 0.5, 1] and "unread" not in found
    assert messages(result, "warning") == []


def test_values_of_instances_that_do_not_fit_or_move_are_named() -> None:
    shot = Reading()
    primvar = add_primvar(instancer(shot), "st", TYPES.TexCoord2fArray, "vertex", [(0, 0), (1, 0)])
    result = shot.read()
    assert result.scene.instance_primvars("/Instancer") == {}
    assert messages(result, "warning") == [
        "/Instancer.primvars:st: found 2 indices into 2 values, expected one valid index an instance; ignored"
    ]
    for time in (9.0, 11.0):
        primvar.Set([(time, 0)] * 3, time)
    result = shot.read()
    assert result.scene.instance_primvars("/Instancer")["st"][:, 0].tolist() == [10, 10, 10]
    assert messages(result, "warning") == [
        "/Instancer.primvars:st: changes within the shutter; each instance has the frame's value"
    ]


def test_what_is_instanced_more_than_once_has_the_values_of_the_innermost_that_has_some() -> None:
    shot = Reading()
    made = instancer(shot, 2)
    add_primvar(made, "st", TYPES.TexCoord2fArray, "vertex", [(1, 0), (2, 0)])
    outer = UsdGeom.PointInstancer.Define(shot.stage, "/Outer")
    outer.CreatePrototypesRel().AddTarget("/Instancer")
    outer.CreateProtoIndicesAttr([0, 0])
    outer.CreatePositionsAttr([(0, 5, 0), (0, 9, 0)])
    add_primvar(outer, "st", TYPES.TexCoord2fArray, "vertex", [(7, 0), (8, 0)])
    scene = shot.read()
    every = [found["st"][:, 0].tolist() for _, found in scene.scene._scene.instance_primvars if "st" in found]
    assert [1, 2, 1, 2] in every


def test_native_instances_hand_on_what_their_prototypes_read_and_share_the_rest() -> None:
    shot = Reading()
    shot.stage.CreateClassPrim("/Asset")
    shot.bind(shot.mesh("/Asset/Mesh"))
    for index in range(4):
        prim = shot.stage.DefinePrim(f"/Instance_{index}", "Xform")
        prim.GetReferences().AddInternalReference("/Asset")
        prim.SetInstanceable(True)
        add_primvar(prim, "unread", TYPES.FloatArray, "constant", [float(index)])
        if index >= 2:
            add_primvar(prim, "st", TYPES.TexCoord2fArray, "constant", [(index, 0)])
    scene = shot.read().scene
    found = [primvars["st"][2][0, 0] if primvars else None for _, primvars in scene._scene.primvars]
    assert sorted(found, key=lambda each: -1 if each is None else each) == [None, 2, 3]


def test_bindings_that_ask_for_nothing_read_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    from msbvh.scene import material_primvars

    def fail(*_: Any) -> None:
        raise AssertionError("a primvar was looked for")

    monkeypatch.setattr(material_primvars, "find_primvar", fail)
    shot = LookShot()
    add_primvar(shot.bind(shot.mesh("/Mesh")), "st", TYPES.TexCoord2fArray, "vertex", SQUARE)
    assert shot.read().scene.primvars("/Mesh") == {}


def test_the_same_through_a_material_of_another_purpose() -> None:
    shot = Reading()
    other = UsdShade.Material.Define(shot.stage, "/Other")
    mesh = shot.mesh("/Mesh").GetPrim()
    add_primvar(mesh, "st", TYPES.TexCoord2fArray, "vertex", SQUARE)
    api = UsdShade.MaterialBindingAPI.Apply(mesh)
    api.Bind(other, UsdShade.Tokens.fallbackStrength, UsdShade.Tokens.preview)
    api.Bind(shot.material, UsdShade.Tokens.fallbackStrength, UsdShade.Tokens.full)
    assert shot.read(material_purpose="full").scene.primvars("/Mesh").keys() == {"st"}
    assert shot.read(material_purpose="preview").scene.primvars("/Mesh") == {}


def test_patches_of_a_displaced_surface_have_one_value_a_point() -> None:
    shot = Reading()
    shot.surface.CreateInput("displacement", TYPES.Float).Set(0.1)
    shot.material.CreateDisplacementOutput().ConnectToSource(shot.surface.ConnectableAPI(), "displacement")
    mesh = shot.mesh("/Mesh")
    mesh.GetSubdivisionSchemeAttr().Set("catmullClark")
    add_primvar(shot.bind(mesh), "st", TYPES.TexCoord2fArray, "faceVarying", SQUARE)
    as_triangles = shot.read(displacement="tessellate").scene.primvars("/Mesh")["st"]
    as_patches = shot.read(displacement="patches").scene.primvars("/Mesh")["st"]
    assert (as_triangles[0], as_patches[0]) == ("faceVarying", "vertex")
    assert as_patches[2].min() >= 0 and as_patches[2].max() <= 1
