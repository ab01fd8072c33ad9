"""Looks of benchmarks' scenes: UsdPreviewSurfaces that Cycles has an equal of, a Principled BSDF (cycles_looks.py)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
from pxr import Gf, Sdf, Usd, UsdGeom, UsdShade, Vt

from ..base.errors import SceneError
from .scene_parts import Colour


@dataclass(frozen=True)
class Look:
    """A surface. Images lie beside the scene's file and are read at the primvar st, repeated."""

    colour: Colour | None = None
    """Linear; None: displayColor."""
    image: str = ""
    """Of the colour, in sRGB, instead."""
    metallic: float = 0.0
    roughness: float = 0.5
    ior: float = 1.5
    coat: float = 0.0
    coat_roughness: float = 0.01
    emission: Colour = (0.0, 0.0, 0.0)
    normal: str = ""
    """An image of normals."""
    cutout: str = ""
    """An image of opacity: what is below a half is not there."""

    @property
    def textured(self) -> bool:
        return bool(self.image or self.normal or self.cutout)

    def plain(self, folder: Path) -> Mapping[str, object]:
        """As cycles_looks reads it; images by their path."""
        images = {name: str(folder / file) for name in ("image", "normal", "cutout") if (file := getattr(self, name))}
        return {**asdict(self), **images}

    def define(self, stage: Usd.Stage, path: str) -> UsdShade.Material:
        material = UsdShade.Material.Define(stage, path)
        surface = UsdShade.Shader.Define(stage, f"{path}/surface")
        surface.CreateIdAttr("UsdPreviewSurface")
        material.CreateSurfaceOutput().ConnectToSource(surface.ConnectableAPI(), "surface")
        numbers = {
            "metallic": self.metallic,
            "roughness": self.roughness,
            "ior": self.ior,
            "clearcoat": self.coat,
            "clearcoatRoughness": self.coat_roughness,
        }
        for name, number in numbers.items():
            surface.CreateInput(name, Sdf.ValueTypeNames.Float).Set(number)
        surface.CreateInput("emissiveColor", Sdf.ValueTypeNames.Color3f).Set(Gf.Vec3f(*self.emission))
        self._colour(surface)
        if self.normal:
            texture = _texture(surface, self.normal, "raw")
            texture.CreateInput("scale", Sdf.ValueTypeNames.Float4).Set(Gf.Vec4f(2, 2, 2, 1))
            texture.CreateInput("bias", Sdf.ValueTypeNames.Float4).Set(Gf.Vec4f(-1, -1, -1, 0))
            _connect(surface, "normal", Sdf.ValueTypeNames.Normal3f, texture, "rgb")
        if self.cutout:
            texture = _texture(surface, self.cutout, "raw")
            _connect(surface, "opacity", Sdf.ValueTypeNames.Float, texture, "r")
            surface.CreateInput("opacityThreshold", Sdf.ValueTypeNames.Float).Set(0.5)
        return material

    def _colour(self, surface: UsdShade.Shader) -> None:
        if self.image:
            _connect(surface, "diffuseColor", Sdf.ValueTypeNames.Color3f, _texture(surface, self.image, "sRGB"), "rgb")
        elif self.colour is None:
            reader = _node(surface, "displayColor", "UsdPrimvarReader_float3")
            reader.CreateInput("varname", Sdf.ValueTypeNames.String).Set("displayColor")
            _connect(surface, "diffuseColor", Sdf.ValueTypeNames.Color3f, reader, "result")
        else:
            surface.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).Set(Gf.Vec3f(*self.colour))


def _node(surface: UsdShade.Shader, name: str, kind: str) -> UsdShade.Shader:
    prim = surface.GetPrim()
    node = UsdShade.Shader.Define(prim.GetStage(), prim.GetParent().GetPath().AppendChild(name))
    node.CreateIdAttr(kind)
    return node


def _texture(surface: UsdShade.Shader, file: str, space: str) -> UsdShade.Shader:
    reader = _node(surface, "st", "UsdPrimvarReader_float2")
    reader.CreateInput("varname", Sdf.ValueTypeNames.String).Set("st")
    texture = _node(surface, Path(file).stem, "UsdUVTexture")
    texture.CreateInput("file", Sdf.ValueTypeNames.Asset).Set(Sdf.AssetPath(f"./{file}"))
    texture.CreateInput("sourceColorSpace", Sdf.ValueTypeNames.Token).Set(space)
    for axis in ("wrapS", "wrapT"):
        texture.CreateInput(axis, Sdf.ValueTypeNames.Token).Set("repeat")
    _connect(texture, "st", Sdf.ValueTypeNames.Float2, reader, "result")
    return texture


def _connect(shader: UsdShade.Shader, name: str, kind: Sdf.ValueTypeName, source: UsdShade.Shader, output: str) -> None:
    kinds = {"rgb": Sdf.ValueTypeNames.Float3, "r": Sdf.ValueTypeNames.Float}
    source.CreateOutput(output, kinds.get(output, kind))
    shader.CreateInput(name, kind).ConnectToSource(source.ConnectableAPI(), output)


def bind(mesh: UsdGeom.Mesh, material: UsdShade.Material) -> None:
    UsdShade.MaterialBindingAPI.Apply(mesh.GetPrim()).Bind(material)


def set_st(mesh: UsdGeom.Mesh, st: np.ndarray) -> None:
    """Coordinates, one a corner of a face: float[C, 2]."""
    primvar = UsdGeom.PrimvarsAPI(mesh).CreatePrimvar(
        "st", Sdf.ValueTypeNames.TexCoord2fArray, UsdGeom.Tokens.faceVarying
    )
    primvar.Set(Vt.Vec2fArray.FromNumpy(np.ascontiguousarray(st, np.float32)))


def write_image(path: Path, pixels: np.ndarray) -> None:
    """8 bits, or half floats for EXR: float[height, width, channels], top row first. Raises SceneError."""
    spec = oiio.ImageSpec(
        pixels.shape[1], pixels.shape[0], pixels.shape[2], "half" if path.suffix == ".exr" else "uint8"
    )
    out = oiio.ImageOutput.create(str(path))
    if not out or not out.open(str(path), spec) or not out.write_image(np.ascontiguousarray(pixels, np.float32)):
        raise SceneError(f"'{path}': {oiio.geterror() or (out and out.geterror())}")
    out.close()


def checker(side: int, cells: int) -> np.ndarray:
    """Squares in colours that run through the picture; float64[side, side, 3]."""
    x, y = np.meshgrid((np.arange(side) + 0.5) / side, (np.arange(side) + 0.5) / side)
    light = (np.floor(x * cells) + np.floor(y * cells)) % 2 == 0
    colours = np.stack([0.55 + 0.3 * x, 0.75 - 0.25 * y, 0.45 + 0.3 * x * y], axis=-1)
    return np.where(light[..., None], colours, 0.45 * colours[..., ::-1])
