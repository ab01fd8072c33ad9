"""The showcase's materials: UsdPreviewSurface networks, with textures that make_textures.py paints."""

from __future__ import annotations

from pxr import Gf, Sdf, Usd, UsdShade

FOLDER = "/showcase/looks"
Color = tuple[float, float, float]

METALS: dict[str, tuple[Color, float]] = {
    "chrome": ((0.62, 0.64, 0.66), 0.28),
    "steel": ((0.30, 0.31, 0.33), 0.32),
    "silver": ((0.90, 0.89, 0.86), 0.28),
    "gold": ((0.95, 0.62, 0.22), 0.25),
    "copper": ((0.93, 0.45, 0.29), 0.27),
    "brass": ((0.72, 0.50, 0.20), 0.55),
}
"""Reflectance at normal incidence, roughness."""

PAINTS: dict[str, tuple[Color, float, float]] = {
    "lacquer": ((0.52, 0.02, 0.015), 0.6, 0.3),
    "rubber": ((0.018, 0.018, 0.02), 0.48, 0.0),
}
"""Colour, roughness, clear coat."""

TEXTURED: dict[str, tuple[str, float, float]] = {
    "wall": ("backdrop.jpg", 0.85, 0.0),
    "flag": ("flag.png", 0.75, 0.0),
    "die": ("die.png", 0.5, 0.5),
    "ball": ("ball.png", 0.5, 0.5),
}
"""Texture of the colour, roughness, clear coat."""


def add_looks(stage: Usd.Stage) -> None:
    for name, (color, roughness) in METALS.items():
        surface = _surface(stage, name, roughness)
        _set(surface, "diffuseColor", Sdf.ValueTypeNames.Color3f, Gf.Vec3f(*color))
        _set(surface, "metallic", Sdf.ValueTypeNames.Float, 1.0)
    for name, (color, roughness, coat) in PAINTS.items():
        surface = _surface(stage, name, roughness, coat)
        _set(surface, "diffuseColor", Sdf.ValueTypeNames.Color3f, Gf.Vec3f(*color))
    for name, (file, roughness, coat) in TEXTURED.items():
        _drive(_surface(stage, name, roughness, coat), "diffuseColor", _texture(stage, name, file), "rgb")
    floor = _surface(stage, "floor", 0.2)
    _drive(floor, "diffuseColor", _texture(stage, "floor", "floor.jpg"), "rgb")
    _drive(floor, "roughness", _texture(stage, "floor", "floor_roughness.jpg", raw=True), "r")
    _drive(floor, "normal", _normals(_texture(stage, "floor", "floor_normal.png", raw=True)), "rgb")


def bind(prim: Usd.Prim, look: str) -> None:
    UsdShade.MaterialBindingAPI.Apply(prim).Bind(UsdShade.Material.Get(prim.GetStage(), f"{FOLDER}/{look}"))


def _surface(stage: Usd.Stage, name: str, roughness: float, coat: float = 0.0) -> UsdShade.Shader:
    material = UsdShade.Material.Define(stage, f"{FOLDER}/{name}")
    surface = UsdShade.Shader.Define(stage, f"{FOLDER}/{name}/surface")
    surface.CreateIdAttr("UsdPreviewSurface")
    _set(surface, "roughness", Sdf.ValueTypeNames.Float, roughness)
    if coat:
        _set(surface, "clearcoat", Sdf.ValueTypeNames.Float, coat)
        _set(surface, "clearcoatRoughness", Sdf.ValueTypeNames.Float, 0.15)
    material.CreateSurfaceOutput().ConnectToSource(surface.ConnectableAPI(), "surface")
    return surface


def _texture(stage: Usd.Stage, look: str, file: str, raw: bool = False) -> UsdShade.Shader:
    """Read at the primvar st, repeated."""
    base = f"{FOLDER}/{look}"
    reader = UsdShade.Shader.Define(stage, f"{base}/st")
    reader.CreateIdAttr("UsdPrimvarReader_float2")
    _set(reader, "varname", Sdf.ValueTypeNames.String, "st")
    texture = UsdShade.Shader.Define(stage, f"{base}/{file.partition('.')[0]}")
    texture.CreateIdAttr("UsdUVTexture")
    _set(texture, "file", Sdf.ValueTypeNames.Asset, Sdf.AssetPath(f"./textures/{file}"))
    _set(texture, "sourceColorSpace", Sdf.ValueTypeNames.Token, "raw" if raw else "sRGB")
    for axis in ("wrapS", "wrapT"):
        _set(texture, axis, Sdf.ValueTypeNames.Token, "repeat")
    texture.CreateInput("st", Sdf.ValueTypeNames.Float2).ConnectToSource(reader.ConnectableAPI(), "result")
    return texture


def _normals(texture: UsdShade.Shader) -> UsdShade.Shader:
    """-1 to 1 of what a picture holds."""
    _set(texture, "scale", Sdf.ValueTypeNames.Float4, Gf.Vec4f(2, 2, 2, 1))
    _set(texture, "bias", Sdf.ValueTypeNames.Float4, Gf.Vec4f(-1, -1, -1, 0))
    return texture


def _drive(surface: UsdShade.Shader, name: str, texture: UsdShade.Shader, channels: str) -> None:
    kinds = {"diffuseColor": Sdf.ValueTypeNames.Color3f, "normal": Sdf.ValueTypeNames.Normal3f}
    found = surface.CreateInput(name, kinds.get(name, Sdf.ValueTypeNames.Float))
    kind = Sdf.ValueTypeNames.Float3 if channels == "rgb" else Sdf.ValueTypeNames.Float
    texture.CreateOutput(channels, kind)
    found.ConnectToSource(texture.ConnectableAPI(), channels)


def _set(shader: UsdShade.Shader, name: str, kind: Sdf.ValueTypeName, value: object) -> None:
    shader.CreateInput(name, kind).Set(value)
