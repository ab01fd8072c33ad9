"""Shading networks on their way from a stage: which values count, and which nodes there are."""

from __future__ import annotations

from typing import Any

import pytest
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
