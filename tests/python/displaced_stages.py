"""Stages with displaced surfaces, and what is drawn of them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio
from pxr import Sdf, Usd, UsdGeom, UsdShade, Vt
from recording import Shot
from subdivision_stages import sheet

TYPES = Sdf.ValueTypeNames


class Displaced(Shot):
    """A stage whose material /Look displaces."""

    def __init__(self, amount: float | None = None, shutter: tuple[float, float] = (0.0, 0.0)) -> None:
        super().__init__(shutter)
        self.material = UsdShade.Material.Define(self.stage, "/Look")
        self.surface = self.shader("Surface", "UsdPreviewSurface")
        self.material.CreateSurfaceOutput().ConnectToSource(self.surface.ConnectableAPI(), "surface")
        self.material.CreateDisplacementOutput().ConnectToSource(self.surface.ConnectableAPI(), "displacement")
        self.displacement = self.surface.CreateInput("displacement", TYPES.Float)
        if amount is not None:
            self.displacement.Set(amount)

    def shader(self, name: str, identifier: str) -> UsdShade.Shader:
        shader = UsdShade.Shader.Define(self.stage, f"/Look/{name}")
        shader.CreateIdAttr(identifier)
        return shader

    def bound(self, mesh: UsdGeom.Gprim) -> Any:
        UsdShade.MaterialBindingAPI.Apply(mesh.GetPrim()).Bind(self.material)
        return mesh

    def read_primvar(self, name: str, fallback: float | None = None) -> None:
        reader = self.shader("Height", "UsdPrimvarReader_float")
        reader.CreateInput("varname", TYPES.String).Set(name)
        if fallback is not None:
            reader.CreateInput("fallback", TYPES.Float).Set(fallback)
        self.displacement.ConnectToSource(reader.CreateOutput("result", TYPES.Float))

    def read_texture(self, file: str, output: str = "r", **inputs: Any) -> UsdShade.Shader:
        """By the primvar st."""
        texture = self.shader("Texture", "UsdUVTexture")
        texture.CreateInput("file", TYPES.Asset).Set(Sdf.AssetPath(file))
        for name, value in inputs.items():
            kind = TYPES.Token if isinstance(value, str) else TYPES.Float4
            texture.CreateInput(name, kind).Set(value)
        reader = self.shader("Coordinates", "UsdPrimvarReader_float2")
        reader.CreateInput("varname", TYPES.String).Set("st")
        texture.CreateInput("st", TYPES.Float2).ConnectToSource(reader.CreateOutput("result", TYPES.Float2))
        self.displacement.ConnectToSource(texture.CreateOutput(output, TYPES.Float))
        return texture

    def points(self, path: str, time01: float = 0.5, displacement: str = "tessellate", **settings: Any) -> np.ndarray:
        return self.read(displacement=displacement, **settings).scene.points(path, time01)

    def undisplaced(self, path: str, time01: float = 0.5, **settings: Any) -> np.ndarray:
        """The same points where they would be."""
        return self.points(path, time01, displacement="none", **settings)


def primvar(
    mesh: UsdGeom.Mesh, name: str, values: Any, interpolation: str, time: float | None = None
) -> UsdGeom.Primvar:
    values = np.asarray(values, np.float32)
    pairs = values.ndim == 2
    kind = TYPES.TexCoord2fArray if pairs else TYPES.FloatArray
    made = UsdGeom.PrimvarsAPI(mesh).CreatePrimvar(name, kind, interpolation)
    array = (Vt.Vec2fArray if pairs else Vt.FloatArray).FromNumpy(values)
    made.Set(array, Usd.TimeCode.Default() if time is None else time)
    return made


def write(path: Path, texels: np.ndarray, **metadata: str) -> str:
    """float32[H, W] or [H, W, C], the uppermost row first."""
    texels = np.ascontiguousarray(texels, np.float32)
    texels = texels.reshape(*texels.shape[:2], -1)
    height, width, channels = texels.shape
    spec = oiio.ImageSpec(width, height, channels, oiio.FLOAT)
    for name, value in metadata.items():
        spec.attribute(name, value)
    output = oiio.ImageOutput.create(str(path))
    assert output.open(str(path), spec) and output.write_image(texels) and output.close()
    return str(path)


def ramp(width: int = 64, height: int = 32) -> np.ndarray:
    """float32[H, W]: s + 2 t in the middles of texels."""
    s = (np.arange(width) + 0.5) / width
    t = 1.0 - (np.arange(height) + 0.5) / height
    return (s[None] + 2.0 * t[:, None]).astype(np.float32)


ROUNDING = 4e-6
"""Points are single precision, relative to the camera, 20 units away: two steps there."""
SIDE = 4
"""Quads along the sides of the sheet, which reaches from -2 to 2."""


def flat(shot: Displaced, scheme: str = "catmullClark") -> UsdGeom.Mesh:
    mesh = shot.bound(sheet(shot, SIDE))
    mesh.CreateSubdivisionSchemeAttr(scheme)
    return mesh


def corners(mesh: UsdGeom.Mesh, values: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """Values at the corners of the faces."""
    points = np.array(mesh.GetPointsAttr().Get())
    return values(points[np.array(mesh.GetFaceVertexIndicesAttr().Get())])


def slope(points: np.ndarray) -> np.ndarray:
    return 0.5 + 0.25 * points[:, 0] - 0.125 * points[:, 1]


def square(points: np.ndarray) -> np.ndarray:
    """Texture coordinates that cover the sheet once."""
    return points[:, :2] / SIDE + 0.5


def turning(degrees: float) -> np.ndarray:
    """Row vectors, about z."""
    a = np.radians(degrees)
    return np.array([[np.cos(a), np.sin(a), 0], [-np.sin(a), np.cos(a), 0], [0, 0, 1]])
