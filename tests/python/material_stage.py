"""Stages with a material whose surface reads textures and primvars."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio
from pxr import Sdf, Usd, UsdGeom, UsdShade
from recording import Shot

TYPES = Sdf.ValueTypeNames


def write_image(path: Path, pixels: np.ndarray, kind: object = oiio.UINT8) -> str:
    """float[H, W, C] in [0, 1]."""
    height, width, channels = pixels.shape
    output = oiio.ImageOutput.create(str(path))
    spec = oiio.ImageSpec(width, height, channels, kind)
    spec.attribute("oiio:UnassociatedAlpha", 1)
    assert output.open(str(path), spec) and output.write_image(pixels.astype(np.float32)) and output.close()
    return str(path)


class LookShot(Shot):
    """A shot with a material; what is drawn is bound by bind()."""

    def __init__(self, identifier: str = "UsdPreviewSurface", context: str = "", **camera: Any) -> None:
        super().__init__(**camera)
        self.material = UsdShade.Material.Define(self.stage, "/Look")
        self.surface = self.node("Surface", identifier)
        self.material.CreateSurfaceOutput(context).ConnectToSource(self.surface.ConnectableAPI(), "surface")

    def node(self, name: str, identifier: str, **tokens: str) -> UsdShade.Shader:
        shader = UsdShade.Shader.Define(self.stage, f"/Look/{name}")
        shader.CreateIdAttr(identifier)
        for key, token in tokens.items():
            shader.CreateInput(key, TYPES.Token).Set(token)
        return shader

    def connect(self, to: UsdShade.Shader, name: str, source: UsdShade.Shader, output: str = "result") -> None:
        kind = TYPES.Float3 if output in ("rgb", "result", "out") else TYPES.Float
        to.CreateInput(name, kind).ConnectToSource(source.CreateOutput(output, kind))

    def texture(
        self, file: str, name: str = "Texture", output: str = "rgb", to: str = "diffuseColor"
    ) -> UsdShade.Shader:
        """That drives an input of the surface."""
        node = self.node(name, "UsdUVTexture")
        node.CreateInput("file", TYPES.Asset).Set(Sdf.AssetPath(file))
        self.connect(self.surface, to, node, output)
        return node

    def reader(self, varname: str = "st", kind: str = "float2", to: str | None = None) -> UsdShade.Shader:
        """Of a primvar, that drives an input of the surface or, without `to`, nothing yet."""
        node = self.node(f"Read_{varname.replace(':', '_')}", f"UsdPrimvarReader_{kind}")
        node.CreateInput("varname", TYPES.String).Set(varname)
        if to is not None:
            self.connect(self.surface, to, node)
        return node

    def bind(self, prim: Any) -> Usd.Prim:
        """To the material."""
        found: Usd.Prim = prim.GetPrim()
        UsdShade.MaterialBindingAPI.Apply(found).Bind(self.material)
        return found


def add_primvar(
    prim: Any, name: str, kind: Sdf.ValueTypeName, interpolation: str, values: Any, indices: Any = None
) -> UsdGeom.Primvar:
    primvar = UsdGeom.PrimvarsAPI(prim.GetPrim()).CreatePrimvar(name, kind, interpolation)
    primvar.Set(values)
    if indices is not None:
        primvar.SetIndices(indices)
    return primvar
