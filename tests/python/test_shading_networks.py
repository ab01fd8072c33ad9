"""Shading networks on their way from a stage: which values count, and which nodes there are."""

from __future__ import annotations

from typing import Any

import pytest
from msbvh.base.errors import Diagnostics
from msbvh.look.networks import surface_network
from msbvh.motion.context import FrameContext
from msbvh.motion.times import Shutter
from pxr import Gf, Sdf, UsdShade
from recording import Shot, messages

TYPES = Sdf.ValueTypeNames


class Look(Shot):
    """A mesh with a material whose surface is a UsdPreviewSurface."""

    def __init__(self) -> None:
        super().__init__()
        self.material = UsdShade.Material.Define(self.stage, "/Look")
        self.surface = self.shader("Surface", "UsdPreviewSurface")
        self.material.CreateSurfaceOutput().ConnectToSource(self.surface.ConnectableAPI(), "surface")
        UsdShade.MaterialBindingAPI.Apply(self.mesh("/Mesh").GetPrim()).Bind(self.material)

    def shader(self, name: str, identifier: str) -> UsdShade.Shader:
        shader = UsdShade.Shader.Define(self.stage, f"/Look/{name}")
        shader.CreateIdAttr(identifier)
        return shader

    def set(self, shader: UsdShade.Shader, name: str, kind: Sdf.ValueTypeName, value: Any) -> None:
        shader.CreateInput(name, kind).Set(value)

    def connect(self, name: str, kind: Sdf.ValueTypeName, source: UsdShade.Shader, output: str) -> None:
        self.surface.CreateInput(name, kind).ConnectToSource(source.CreateOutput(output, kind))


@pytest.mark.parametrize(
    ("name", "text", "expected"),
    [
        ("opacity", "0.5", "a number; drawn as 1"),
        ("opacityThreshold", "nan", "a number; drawn as 0"),
        ("diffuseColor", "123", "three numbers; drawn as (0.18, 0.18, 0.18)"),
    ],
)
def test_text_is_no_number(name: str, text: str, expected: str) -> None:
    look = Look()
    look.set(look.surface, name, TYPES.String, text)
    assert messages(look.read(), "warning") == [f"/Look/Surface.inputs:{name}: found {text!r}, expected {expected}"]


@pytest.mark.parametrize(("kind", "vector"), [(TYPES.Double4, Gf.Vec4d), (TYPES.Half4, Gf.Vec4h)])
def test_a_textures_fallback_may_have_any_precision(kind: Sdf.ValueTypeName, vector: type) -> None:
    look = Look()
    texture = look.shader("Texture", "UsdUVTexture")
    look.set(texture, "fallback", kind, vector(0.5, 0.25, 0, 0.75))
    look.connect("diffuseColor", TYPES.Color3f, texture, "rgb")
    look.connect("opacity", TYPES.Float, texture, "a")
    result = look.read()
    (material,) = result.scene.materials
    assert material["diffuse_color"] == (0.5, 0.25, 0) and material["opacity"] == 0.75
    assert [text for text in messages(result, "warning") if "expected" in text] == []


@pytest.mark.parametrize("samples", [{9.0: None}, {9.0: 0.0, 10.1: None}])
def test_a_blocked_value_is_the_default_and_no_displacement(samples: dict[float, float | None]) -> None:
    look = Look()
    displacement = look.surface.CreateInput("displacement", TYPES.Float)
    for time, value in samples.items():
        displacement.GetAttr().Set(Sdf.ValueBlock() if value is None else value, time)
    assert messages(look.read(), "warning") == []


def test_nodes_in_a_circle_are_collected_once_each() -> None:
    look = Look()
    texture, other = look.shader("Texture", "UsdUVTexture"), look.shader("Other", "UsdUVTexture")
    for node, source in ((texture, other), (other, texture)):
        for name in ("scale", "fallback"):
            node.CreateInput(name, TYPES.Float4).ConnectToSource(source.CreateOutput("rgba", TYPES.Float4))
    look.connect("diffuseColor", TYPES.Color3f, texture, "rgb")
    look.connect("opacity", TYPES.Float, texture, "a")
    look.shader("Unused", "UsdUVTexture")
    look.surface.CreateInput("displacement", TYPES.Float).ConnectToSource(
        look.surface.CreateOutput("surface", TYPES.Token)
    )
    network = surface_network(look.material, FrameContext(look.stage, Shutter(10.0), False, Diagnostics()))
    nodes = {node.path: node for node in network.nodes}
    assert len(network.nodes) == 3 and nodes.keys() == {"/Look/Surface", "/Look/Texture", "/Look/Other"}
    assert network.terminals["surface"].node == "/Look/Surface"
    links = {
        (path, each.name): (each.connections[0].node, each.connections[0].output)
        for path, node in nodes.items()
        for each in node.inputs
    }
    assert links["/Look/Surface", "opacity"] == ("/Look/Texture", "a")
    assert links["/Look/Other", "scale"] == ("/Look/Texture", "rgba")
    assert look.read().scene.materials[0]["opacity"] == 1.0


def test_values_are_handed_down_as_what_they_are() -> None:
    look = Look()
    public = look.material.CreateInput("tint", TYPES.Color3h)
    public.Set(Gf.Vec3h(0.5, 0.25, 1))
    look.surface.CreateInput("diffuseColor", TYPES.Color3h).ConnectToSource(public)
    for name, kind, value in (
        ("emissiveColor", TYPES.Matrix3d, Gf.Matrix3d(1)),
        ("opacity", TYPES.Bool, True),
        ("opacityThreshold", TYPES.Int, 2),
        ("normal", TYPES.FloatArray, [1.0, 2.0, 3.0, 4.0, 5.0]),
        ("displacement", TYPES.StringArray, ["1", "2", "3"]),
    ):
        look.set(look.surface, name, kind, value)
    network = surface_network(look.material, FrameContext(look.stage, Shutter(10.0), False, Diagnostics()))
    inputs = {each.name: each for each in network.nodes[0].inputs}
    data = {name: each.value.data for name, each in inputs.items()}
    assert data == {
        "diffuseColor": [0.5, 0.25, 1.0],
        "emissiveColor": None,
        "opacity": True,
        "opacityThreshold": 2.0,
        "normal": None,
        "displacement": None,
    }
    assert type(data["opacity"]) is bool
    tint = inputs["diffuseColor"]
    assert (tint.origin.path, tint.origin.attribute) == ("/Look", "inputs:tint")
    assert (tint.value.text, tint.value.type) == ("Gf.Vec3h(0.5, 0.25, 1.0)", "color3h")
