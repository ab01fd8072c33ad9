"""UsdPreviewSurface's constants, as far as a diffuse surface shows them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from pxr import Usd, UsdShade

from .context import FrameContext

PREVIEW_SURFACE = "UsdPreviewSurface"


@dataclass(frozen=True)
class Input:
    """A shader input: its constant, and what drives it."""

    value: Any
    primvar: str = ""
    """Name of the primvar that a connected reader reads."""


class Materials:
    """Hands each material down once."""

    def __init__(self, translator: Any, context: FrameContext) -> None:
        self._translator = translator
        self._context = context
        self._ids: dict[str, int | None] = {}

    def bound_to(self, prim: Usd.Prim) -> int | None:
        """The translator's id of the material that a prim or subset is bound to; None: displayColor shows."""
        material, _ = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial(UsdShade.Tokens.full)
        if not material:
            return None
        path = str(material.GetPath())
        if path not in self._ids:
            self._ids[path] = self._read(material)
        return self._ids[path]

    def _read(self, material: UsdShade.Material) -> int | None:
        path = str(material.GetPath())
        shader, _, _ = material.ComputeSurfaceSource()
        identifier = shader.GetShaderId() if shader else None
        if identifier != PREVIEW_SURFACE:
            found = "no surface shader that can be read"
            if shader:
                found = f"a surface shader {identifier or 'of no known type'}"
            message = f"found {found}, expected {PREVIEW_SURFACE}; displayColor shows instead"
            self._context.diagnostics.group(path, "outputs:surface", message)
            return None
        diffuse = self._input(shader, "diffuseColor", (0.18, 0.18, 0.18))
        opacity = self._input(shader, "opacity", 1.0)
        return self._translator.add_material(
            name=path,
            diffuse_color=tuple(map(float, diffuse.value)),
            diffuse_from_display_color=diffuse.primvar == "displayColor",
            emissive_color=tuple(map(float, self._input(shader, "emissiveColor", (0.0, 0.0, 0.0)).value)),
            opacity=float(opacity.value),
            opacity_from_display_opacity=opacity.primvar == "displayOpacity",
            opacity_threshold=float(self._input(shader, "opacityThreshold", 0.0).value),
        )

    def _input(self, shader: UsdShade.Shader, name: str, default: Any) -> Input:
        """An input's constant at the frame, followed through node graphs and material interfaces."""
        shader_input = shader.GetInput(name)
        if not shader_input:
            return Input(default)
        sources = shader_input.GetValueProducingAttributes()
        if not sources:
            return Input(default)
        source = sources[0]
        if UsdShade.Utils.GetType(source.GetName()) != UsdShade.AttributeType.Output:
            value = source.Get(self._context.code)
            return Input(default if value is None else value)
        return self._connected(shader_input, UsdShade.Shader(source.GetPrim()), default)

    def _connected(self, shader_input: UsdShade.Input, node: UsdShade.Shader, default: Any) -> Input:
        """An input that another node drives: readers of displayColor and displayOpacity are drawn, others
        fall back."""
        identifier = node.GetShaderId() or "node of no known type"
        fallback = self._constant(node, "fallback", default)
        if identifier.startswith("UsdPrimvarReader"):
            primvar = str(self._constant(node, "varname", ""))
            if (shader_input.GetBaseName(), primvar) in (
                ("diffuseColor", "displayColor"),
                ("opacity", "displayOpacity"),
            ):
                return Input(fallback, primvar)
            identifier = f"{identifier} of '{primvar}'"
        if not isinstance(default, float):
            fallback = tuple(fallback)[:3]
        elif not isinstance(fallback, float):
            fallback = fallback[3] if len(fallback) > 3 else default
        message = f"connected to a {identifier}, which is not evaluated yet; drawn as {_text(fallback)}"
        shader = str(shader_input.GetPrim().GetPath())
        self._context.diagnostics.group(shader, shader_input.GetFullName(), message)
        return Input(fallback)

    def _constant(self, node: UsdShade.Shader, name: str, default: Any) -> Any:
        node_input = node.GetInput(name)
        sources = node_input.GetValueProducingAttributes() if node_input else ()
        value = sources[0].Get(self._context.code) if sources else None
        return default if value is None else value


def _text(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else "(" + ", ".join(f"{part:g}" for part in value) + ")"
