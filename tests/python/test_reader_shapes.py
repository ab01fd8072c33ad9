"""What the reader hands down of a mesh beside its motion: topology, normals, primvars, materials, and what is
left out."""

from __future__ import annotations

import numpy as np
import pytest
from msbvh.scene.implicit import IMPLICIT_TYPES
from pxr import Gf, Sdf, Tf, Usd, UsdGeom, UsdShade
from recording import Shot, messages


def signed_volume(mesh: dict) -> float:
    """Of a closed mesh whose faces turn outward: positive."""
    points = np.asarray(mesh["points"][0][1], np.float64)
    volume, first = 0.0, 0
    for count in mesh["face_vertex_counts"]:
        face = points[mesh["face_vertex_indices"][first : first + count]]
        volume += sum(np.dot(face[0], np.cross(face[i], face[i + 1])) for i in range(1, count - 1)) / 6
        first += count
    return volume


@pytest.mark.parametrize("axis", ["X", "Y", "Z"])
@pytest.mark.parametrize(
    ("kind", "volume", "extent"),
    [
        ("Sphere", 4 / 3 * np.pi, (1, 1, 1)),
        ("Cube", 8.0, (1, 1, 1)),
        ("Cone", np.pi * 2 / 3, (1, 1, 1)),
        ("Cylinder", np.pi * 2, (1, 1, 1)),
        ("Cylinder_1", np.pi * 2 * (0.25 + 0.5 + 1) / 3, (1, 1, 1)),
        ("Capsule", np.pi * 0.25 * 1 + np.pi / 6, (0.5, 0.5, 1)),
    ],
)
def test_implicit_shapes_have_their_volume_size_and_orientation(kind, volume, extent, axis):
    shot = Shot()
    prim = shot.stage.DefinePrim("/Shape", kind)
    if kind == "Cylinder_1":
        prim.GetAttribute("radiusBottom").Set(1.0)
        prim.GetAttribute("radiusTop").Set(0.5)
    if prim.GetAttribute("axis"):
        prim.GetAttribute("axis").Set(axis)
    mesh = shot.read().scene.meshes["/Shape"]
    assert signed_volume(mesh) == pytest.approx(volume, rel=0.01)
    assert not mesh["left_handed"]
    found = np.abs(mesh["points"][0][1]).max(axis=0)
    shift = {"X": 1, "Y": 2, "Z": 0}[axis]
    assert found == pytest.approx(np.roll(extent, shift), abs=1e-6)


def test_implicit_shapes_agree_with_usds_extents():
    shot = Shot()
    for kind in IMPLICIT_TYPES:
        prim = shot.stage.DefinePrim(f"/{kind}", kind)
        for axis in ("X", "Y", "Z"):
            if prim.GetAttribute("axis"):
                prim.GetAttribute("axis").Set(axis)
            for parameter, value in (("width", 3.0), ("length", 5.0), ("height", 7.0)):
                if prim.GetAttribute(parameter):
                    prim.GetAttribute(parameter).Set(value)
            points = shot.read().scene.meshes[f"/{kind}"]["points"][0][1]
            extent = np.array(UsdGeom.Boundable.ComputeExtentFromPlugins(UsdGeom.Boundable(prim), 10.0))
            # Capsule_1 of USD bounds its caps by the larger radius: equal here, both are 0.5.
            assert np.abs(points.min(axis=0) - extent[0]).max() < 1e-5, (kind, axis)
            assert np.abs(points.max(axis=0) - extent[1]).max() < 1e-5, (kind, axis)


def test_topology_orientation_and_holes_arrive_as_authored():
    shot = Shot()
    mesh = shot.mesh("/Mesh")
    mesh.CreateOrientationAttr("leftHanded")
    mesh.CreateHoleIndicesAttr([0])
    recorded = shot.read().scene.meshes["/Mesh"]
    assert recorded["left_handed"] and recorded["hole_indices"].tolist() == [0]
    assert recorded["face_vertex_counts"].tolist() == [4]


def test_vt_arrays_are_not_copied():
    shot = Shot()
    shot.mesh("/Mesh")
    assert not shot.read().scene.meshes["/Mesh"]["points"][0][1].flags.owndata


def test_subdivision_is_handed_down_as_it_is_authored():
    shot = Shot()
    mesh = shot.mesh("/Mesh")
    mesh.CreateSubdivisionSchemeAttr("catmullClark")
    mesh.CreateInterpolateBoundaryAttr("edgeOnly")
    mesh.CreateCreaseLengthsAttr([2])
    mesh.CreateCreaseIndicesAttr([0, 1])
    mesh.CreateCreaseSharpnessesAttr([3.5])
    mesh.CreateNormalsAttr([(0, 0, 1)] * 4)
    shot.mesh("/Polygons")
    result = shot.read()
    assert messages(result, "warning") == []
    found, polygons = result.scene.meshes["/Mesh"], result.scene.meshes["/Polygons"]
    assert (found["subdivision_scheme"], polygons["subdivision_scheme"]) == ("catmullClark", "none")
    assert (found["interpolate_boundary"], found["triangle_rule"]) == ("edgeOnly", None)
    assert [found[f"crease_{name}"].tolist() for name in ("lengths", "indices", "sharpnesses")] == [[2], [0, 1], [3.5]]
    assert found["normals"] is None  # The surface has its own.


def test_authored_normals_and_the_primvar_before_them():
    shot = Shot()
    mesh = shot.mesh("/Mesh")
    mesh.CreateNormalsAttr([(0, 0, 1)] * 4)
    mesh.SetNormalsInterpolation("vertex")
    recorded = shot.read().scene.meshes["/Mesh"]
    assert recorded["normals_interpolation"] == "vertex" and len(recorded["normals"][0][1]) == 4
    primvar = UsdGeom.PrimvarsAPI(mesh).CreatePrimvar("normals", Sdf.ValueTypeNames.Normal3fArray, "faceVarying")
    primvar.Set([(0, 1, 0), (1, 0, 0)])
    primvar.SetIndices([0, 1, 1, 0])
    recorded = shot.read().scene.meshes["/Mesh"]
    assert recorded["normals_interpolation"] == "faceVarying"
    assert recorded["normals_indices"].tolist() == [0, 1, 1, 0]


@pytest.mark.parametrize("interpolation", ["constant", "uniform", "varying", "vertex", "faceVarying"])
def test_primvars_of_every_interpolation_indexed_and_inherited(interpolation):
    shot = Shot()
    mesh = shot.mesh("/Parent/Mesh")
    colour = UsdGeom.PrimvarsAPI(mesh).CreatePrimvar("displayColor", Sdf.ValueTypeNames.Color3fArray, interpolation)
    colour.Set([(1, 0, 0), (0, 1, 0)])
    colour.SetIndices([1])
    opacity = UsdGeom.PrimvarsAPI(shot.stage.GetPrimAtPath("/Parent"))
    opacity.CreatePrimvar("displayOpacity", Sdf.ValueTypeNames.FloatArray, "constant").Set([0.5])
    recorded = shot.read().scene.meshes["/Parent/Mesh"]
    name, values, indices = recorded["display_color"]
    assert (name, values.tolist(), indices.tolist()) == (interpolation, [[1, 0, 0], [0, 1, 0]], [1])
    name, values, indices = recorded["display_opacity"]
    assert (name, values.tolist(), indices) == ("constant", [0.5], None)


def test_values_are_read_at_the_frame_not_at_default():
    shot = Shot()
    colour = shot.mesh("/Mesh").CreateDisplayColorAttr([(1, 0, 0)])
    colour.Set([(0, 1, 0)], 10.0)
    assert shot.read().scene.meshes["/Mesh"]["display_color"][1].tolist() == [[0, 1, 0]]


def test_purposes_are_those_of_usdrecord():
    shot = Shot()
    for purpose in ("default", "render", "proxy", "guide"):
        UsdGeom.Xform.Define(shot.stage, f"/{purpose}").CreatePurposeAttr(purpose)
        shot.mesh(f"/{purpose}/Mesh")
    shot.mesh("/render/Own").CreatePurposeAttr("proxy")
    assert set(shot.read().scene.meshes) == {"/default/Mesh", "/proxy/Mesh", "/render/Own"}
    assert set(shot.read(purposes=("render",)).scene.meshes) == {"/default/Mesh", "/render/Mesh"}


def test_visibility_at_the_frame():
    shot = Shot()
    parent = UsdGeom.Xform.Define(shot.stage, "/Parent")
    shot.mesh("/Parent/Mesh")
    visibility = parent.CreateVisibilityAttr()
    visibility.Set("invisible", 0.0)
    visibility.Set("inherited", 10.0)
    visibility.Set("invisible", 12.0)
    assert "/Parent/Mesh" in shot.read(11.0).scene.meshes
    assert shot.read(9.0).scene.meshes == {}


def preview_material(shot: Shot, path: str = "/Material") -> UsdShade.Shader:
    material = UsdShade.Material.Define(shot.stage, path)
    shader = UsdShade.Shader.Define(shot.stage, f"{path}/Surface")
    shader.CreateIdAttr("UsdPreviewSurface")
    material.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "surface")
    return shader


def bind(shot: Shot, prim, path: str = "/Material") -> None:
    UsdShade.MaterialBindingAPI.Apply(prim).Bind(UsdShade.Material.Get(shot.stage, path))


def test_constants_of_a_preview_surface_through_the_material_interface():
    shot = Shot()
    shader = preview_material(shot)
    public = UsdShade.Material.Get(shot.stage, "/Material").CreateInput("tint", Sdf.ValueTypeNames.Color3f)
    public.Set(Gf.Vec3f(0.25, 0.5, 0.75))
    shader.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).ConnectToSource(public)
    shader.CreateInput("emissiveColor", Sdf.ValueTypeNames.Color3f).Set(Gf.Vec3f(1, 2, 3))
    shader.CreateInput("opacity", Sdf.ValueTypeNames.Float).Set(0.5)
    shader.CreateInput("opacityThreshold", Sdf.ValueTypeNames.Float).Set(0.25)
    for name in ("/A", "/B"):
        bind(shot, shot.mesh(name).GetPrim())
    result = shot.read()
    (material,) = result.scene.materials
    expected = {
        "name": "/Material",
        "diffuse_color": (0.25, 0.5, 0.75),
        "diffuse_from_display_color": False,
        "emissive_color": (1, 2, 3),
        "emissive_from_display_color": False,
        "opacity": 0.5,
        "opacity_from_display_opacity": False,
        "opacity_threshold": 0.25,
        "specular": True,
        "specular_workflow": False,
        "specular_color": (0, 0, 0),
        "metallic": 0,
        "roughness": 0.5,
        "ior": 1.5,
        "clearcoat": 0,
        "clearcoat_roughness": pytest.approx(0.01),
        "transparent_reflects": False,
        "normal": (0, 0, 1),
        "texture_reads": [],
        "driven": {},
    }
    assert material == expected
    assert [mesh["material"] for mesh in result.scene.meshes.values()] == [0, 0]
    assert not messages(result, "warning")


def test_a_reader_of_display_color_is_drawn_and_a_texture_falls_back_with_a_warning():
    shot = Shot()
    shader = preview_material(shot)
    reader = UsdShade.Shader.Define(shot.stage, "/Material/Reader")
    reader.CreateIdAttr("UsdPrimvarReader_float3")
    reader.CreateInput("varname", Sdf.ValueTypeNames.String).Set("displayColor")
    diffuse = shader.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f)
    diffuse.ConnectToSource(reader.CreateOutput("result", Sdf.ValueTypeNames.Float3))
    texture = UsdShade.Shader.Define(shot.stage, "/Material/Texture")
    texture.CreateIdAttr("UsdUVTexture")
    texture.CreateInput("fallback", Sdf.ValueTypeNames.Float4).Set(Gf.Vec4f(0.5, 0.25, 0, 1))
    emissive = shader.CreateInput("emissiveColor", Sdf.ValueTypeNames.Color3f)
    emissive.ConnectToSource(texture.CreateOutput("rgb", Sdf.ValueTypeNames.Float3))
    bind(shot, shot.mesh("/Mesh").GetPrim())
    result = shot.read()
    (material,) = result.scene.materials
    assert material["diffuse_from_display_color"] and material["emissive_color"] == (0.5, 0.25, 0)
    (warning,) = messages(result, "warning")
    assert warning == (
        "/Material/Surface.inputs:emissiveColor: connected to a UsdUVTexture; "
        "it names no file, drawn as its fallback, (0.5, 0.25, 0)"
    )


def test_emission_may_read_display_color():
    shot = Shot()
    shader = preview_material(shot)
    reader = UsdShade.Shader.Define(shot.stage, "/Material/Reader")
    reader.CreateIdAttr("UsdPrimvarReader_float3")
    reader.CreateInput("varname", Sdf.ValueTypeNames.Token).Set("displayColor")
    emissive = shader.CreateInput("emissiveColor", Sdf.ValueTypeNames.Color3f)
    emissive.ConnectToSource(reader.CreateOutput("result", Sdf.ValueTypeNames.Float3))
    bind(shot, shot.mesh("/Mesh").GetPrim())
    result = shot.read()
    (material,) = result.scene.materials
    assert material["emissive_from_display_color"] and not material["diffuse_from_display_color"]
    assert not messages(result, "warning")


def test_every_input_of_a_preview_surface_is_read_and_nothing_is_said():
    shot = Shot()
    kinds = Sdf.ValueTypeNames
    shader = preview_material(shot)
    for name, kind, value in (
        ("useSpecularWorkflow", kinds.Int, 1),
        ("specularColor", kinds.Color3f, (0.5, 0.25, 1)),
        ("metallic", kinds.Float, 1.0),
        ("roughness", kinds.Float, 0.25),
        ("ior", kinds.Float, 1.25),
        ("clearcoat", kinds.Float, 0.75),
        ("clearcoatRoughness", kinds.Float, 0.125),
        ("opacityMode", kinds.Token, "presence"),
        ("normal", kinds.Normal3f, (0, 0.5, 0.5)),
        ("occlusion", kinds.Float, 0.5),
    ):
        shader.CreateInput(name, kind).Set(value)
    mesh = shot.mesh("/Mesh")
    bind(shot, mesh.GetPrim())
    st = UsdGeom.PrimvarsAPI(mesh).CreatePrimvar("st", kinds.TexCoord2fArray, "varying")  # that the normal is along
    st.Set([(0, 0), (1, 0), (1, 1), (0, 1)])
    result = shot.read()
    (material,) = result.scene.materials
    assert material["specular_workflow"] and material["specular_color"] == (0.5, 0.25, 1) and not material["metallic"]
    assert (material["roughness"], material["ior"]) == (0.25, 1.25)
    assert (material["clearcoat"], material["clearcoat_roughness"]) == (0.75, 0.125)
    assert not material["transparent_reflects"] and material["normal"] == (0, 0.5, 0.5)
    assert messages(result) == []


@pytest.mark.parametrize(
    ("name", "kind", "value", "expected"),
    [
        ("diffuseColor", Sdf.ValueTypeNames.Float, 0.5, "three numbers; drawn as (0.18, 0.18, 0.18)"),
        ("diffuseColor", Sdf.ValueTypeNames.String, "red", "three numbers; drawn as (0.18, 0.18, 0.18)"),
        ("opacity", Sdf.ValueTypeNames.Color3f, Gf.Vec3f(1), "a number; drawn as 1"),
    ],
)
def test_an_input_of_the_wrong_type_is_named_and_its_default_drawn(name, kind, value, expected):
    shot = Shot()
    preview_material(shot).CreateInput(name, kind).Set(value)
    bind(shot, shot.mesh("/Mesh").GetPrim())
    message = f"/Material/Surface.inputs:{name}: found {value!r}, expected {expected}"
    assert messages(shot.read(), "warning") == [message]


def test_another_renderers_material_leaves_a_warning_and_display_color():
    shot = Shot()
    preview_material(shot).CreateIdAttr("SomeoneElses")
    bind(shot, shot.mesh("/Mesh").GetPrim())
    result = shot.read()
    assert result.scene.meshes["/Mesh"]["material"] is None
    assert any("found a surface shader SomeoneElses" in message for message in messages(result, "warning"))


def test_what_is_not_supported_is_named_once_a_type():
    shot = Shot()
    for index in range(4):
        shot.stage.DefinePrim(f"/Smoke_{index}", "Volume")
    for kind in ("GenerativeProcedural", "ParticleField3DGaussianSplat"):
        shot.stage.DefinePrim(f"/{kind}_0", kind)
    shot.stage.DefinePrim("/Alien", "ProprietaryThing")
    warnings = messages(shot.read(), "warning")
    assert "/Smoke_0: prims of type Volume are not supported yet; not drawn (and 3 more prims)" in warnings
    for kind in ("GenerativeProcedural", "ParticleField3DGaussianSplat"):
        assert f"/{kind}_0: prims of type {kind} are not supported yet; not drawn" in warnings
    assert "/Alien: prim type 'ProprietaryThing' is unknown; not drawn" in warnings
    assert len(warnings) == 4


def test_what_draws_nothing_is_not_named():
    shot = Shot()
    for kind in ("Scope", "Xform", "SkelRoot", "Skeleton", "OpenVDBAsset", "SpatialAudio", "PhysicsJoint", "Material"):
        shot.stage.DefinePrim(f"/{kind}", kind)
    assert [text for text in messages(shot.read(), "warning") if "not drawn" in text] == []


def test_no_type_that_has_an_extent_goes_without_a_word():
    """By the registry: whatever usd-core knows today, and types that come with another version."""
    registry = Usd.SchemaRegistry()
    types = [each for each in Tf.Type(UsdGeom.Boundable).GetAllDerivedTypes() if registry.IsConcrete(each)]
    for name in (registry.GetSchemaTypeName(each) for each in types):
        if name.endswith("Light") or name in ("PointInstancer", "SkelRoot", "Skeleton"):
            continue
        shot = Shot()
        shot.stage.DefinePrim("/Prim", name)
        result = shot.read()
        said = any(text.startswith("/Prim") for text in messages(result))
        assert said or "/Prim" in result.scene.meshes, name
