"""Which material a prim is bound to, and which of a material's surfaces counts."""

from __future__ import annotations

from typing import Any

import pytest
from material_stage import TYPES, LookShot
from pxr import Gf, Sdf, Usd, UsdGeom, UsdShade
from recording import Shot, messages

STRONGER, WEAKER = UsdShade.Tokens.strongerThanDescendants, UsdShade.Tokens.weakerThanDescendants


class Bound(Shot):
    """With materials /Red and /Blue, and /Group/Mesh."""

    def __init__(self) -> None:
        super().__init__()
        self.red, self.blue = self.look("/Red", (1, 0, 0)), self.look("/Blue", (0, 0, 1))
        self.group = UsdGeom.Xform.Define(self.stage, "/Group").GetPrim()
        self.square = self.mesh("/Group/Mesh")

    def look(self, path: str, colour: tuple[float, float, float]) -> UsdShade.Material:
        material = UsdShade.Material.Define(self.stage, path)
        surface = UsdShade.Shader.Define(self.stage, f"{path}/Surface")
        surface.CreateIdAttr("UsdPreviewSurface")
        surface.CreateInput("diffuseColor", TYPES.Color3f).Set(Gf.Vec3f(*colour))
        material.CreateSurfaceOutput().ConnectToSource(surface.ConnectableAPI(), "surface")
        return material

    def drawn(self, **settings: Any) -> list[str | None]:
        """The names of the materials of each mesh and of its faces."""
        scene = self.read(**settings).scene
        names = [material["name"] for material in scene.materials]
        found: list[str | None] = []
        for mesh in scene.meshes.values():
            numbers = [mesh["material"]] if mesh["face_materials"] is None else mesh["face_materials"].tolist()
            found += [None if number is None or number < 0 else names[number] for number in numbers]
        return found


def api(prim: Any) -> UsdShade.MaterialBindingAPI:
    return UsdShade.MaterialBindingAPI.Apply(prim.GetPrim())


def test_the_nearest_binding_counts_unless_one_above_is_stronger() -> None:
    shot = Bound()
    assert shot.drawn() == [None]
    api(shot.group).Bind(shot.red)
    assert shot.drawn() == ["/Red"]
    api(shot.square).Bind(shot.blue)
    assert shot.drawn() == ["/Blue"]
    api(shot.group).Bind(shot.red, STRONGER)
    assert shot.drawn() == ["/Red"]
    UsdShade.MaterialBindingAPI.SetMaterialBindingStrength(api(shot.group).GetDirectBindingRel(), WEAKER)
    assert shot.drawn() == ["/Blue"]


@pytest.mark.parametrize("strength", [WEAKER, STRONGER])
def test_collections_bind_what_they_include(strength: str) -> None:
    shot = Bound()
    other = shot.mesh("/Group/Other")
    collection = Usd.CollectionAPI.Apply(shot.group, "some")
    collection.CreateIncludesRel().AddTarget(other.GetPath())
    api(shot.group).Bind(shot.red)
    api(shot.group).Bind(collection, shot.blue, "some", strength)
    assert shot.drawn() == ["/Red", "/Blue"]
    api(other).Bind(shot.red)
    assert shot.drawn() == ["/Red", "/Blue" if strength == STRONGER else "/Red"]


def test_bindings_of_a_purpose() -> None:
    shot = Bound()
    api(shot.square).Bind(shot.red, WEAKER, UsdShade.Tokens.full)
    api(shot.square).Bind(shot.blue, WEAKER, UsdShade.Tokens.preview)
    assert shot.drawn(material_purpose="full") == ["/Red"]
    assert shot.drawn(material_purpose="preview") == ["/Blue"]
    api(shot.square).UnbindDirectBinding(UsdShade.Tokens.full)
    api(shot.group).Bind(shot.blue)
    assert shot.drawn(material_purpose="full") == ["/Blue"]  # The general one, from above.


def test_subsets_bind_their_faces_and_the_prim_the_rest() -> None:
    shot = Bound()
    shot.square.GetFaceVertexCountsAttr().Set([3, 3, 3])
    shot.square.GetFaceVertexIndicesAttr().Set([0, 1, 2, 0, 2, 3, 0, 1, 3])
    api(shot.square).Bind(shot.red)
    subset = UsdShade.MaterialBindingAPI(shot.square.GetPrim()).CreateMaterialBindSubset("part", [1])
    assert shot.drawn() == ["/Red", "/Red", "/Red"]
    api(subset).Bind(shot.blue)
    assert shot.drawn() == ["/Red", "/Blue", "/Red"]


def test_a_binding_to_what_is_no_material_leaves_the_next_one() -> None:
    shot = Bound()
    api(shot.group).Bind(shot.red)
    shot.square.GetPrim().CreateRelationship("material:binding").AddTarget("/Nowhere")
    api(shot.square)
    assert shot.drawn() in ([None], ["/Red"])  # USD's own rule, without a crash.


def of_context(context: str, identifier: str = "UsdPreviewSurface") -> LookShot:
    shot = LookShot(identifier, context)
    shot.surface.CreateInput("roughness", TYPES.Float).Set(0.25)
    shot.bind(shot.mesh("/Mesh"))
    return shot


@pytest.mark.parametrize("context", ["", "glslfx", "mtlx", "ri", "arnold"])
def test_a_preview_surface_is_found_in_any_render_context(context: str) -> None:
    result = of_context(context).read()
    assert [material["roughness"] for material in result.scene.materials] == [0.25]
    assert messages(result) == []


def test_of_several_contexts_the_one_that_is_read_counts_and_the_universal_one_before_all() -> None:
    shot = of_context("ri", "PxrSurface")
    preview = shot.node("Preview", "UsdPreviewSurface")
    shot.material.CreateSurfaceOutput("arnold").ConnectToSource(preview.ConnectableAPI(), "surface")
    assert [material["roughness"] for material in shot.read().scene.materials] == [0.5]
    shot.material.CreateSurfaceOutput().ConnectToSource(shot.surface.ConnectableAPI(), "surface")
    result = shot.read()
    assert result.scene.materials == []
    (warning,) = messages(result, "warning")
    assert warning == (
        "/Look.outputs:surface: found a surface shader PxrSurface, expected UsdPreviewSurface; displayColor shows instead"
    )


def test_a_materialx_surface_is_mapped_with_one_line() -> None:
    shot = LookShot("ND_standard_surface_surfaceshader", "mtlx")
    shot.surface.CreateInput("base_color", TYPES.Color3f).Set(Gf.Vec3f(1, 0.5, 0))
    shot.surface.CreateInput("transmission", TYPES.Float).Set(0.5)
    image = shot.node("Image", "ND_image_float", uaddressmode="clamp")
    image.CreateInput("file", TYPES.Asset).Set(Sdf.AssetPath(__file__))
    shot.connect(shot.surface, "specular_roughness", image, "out")
    shot.bind(shot.mesh("/Mesh"))
    result = shot.read()
    (material,) = result.scene.materials
    assert material["diffuse_color"] == (1, 0.5, 0)
    assert material["driven"]["roughness"] == {"texture_read": 0, "channel": 0, "grey": False}
    assert material["texture_reads"][0]["coordinates"] == "st"
    assert result.scene.textures[0]["wrap"] == ("clamp", "repeat")
    assert messages(result, "warning") == [
        "/Look/Surface: ND_standard_surface_surfaceshader is drawn as a UsdPreviewSurface; transmission is left out"
    ]


def test_a_circle_of_node_graphs_ends() -> None:
    shot = LookShot()
    first, second = (UsdShade.NodeGraph.Define(shot.stage, f"/Look/{name}") for name in "AB")
    a, b = first.CreateOutput("out", TYPES.Color3f), second.CreateOutput("out", TYPES.Color3f)
    a.ConnectToSource(b)
    b.ConnectToSource(a)
    shot.surface.CreateInput("diffuseColor", TYPES.Color3f).ConnectToSource(a)
    shot.bind(shot.mesh("/Mesh"))
    (material,) = shot.read().scene.materials
    assert material["diffuse_color"] == pytest.approx((0.18, 0.18, 0.18))
