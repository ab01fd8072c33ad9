"""UsdPreviewSurface's constants, as far as a diffuse surface shows them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from pxr import Gf, Sdf, Tf, Usd, UsdShade

from ..motion.context import FrameContext
from ..motion.held_values import any_but, warn_of_change
from ..stage.opening import tf_reason
from ..stage.value_types import TOKEN
from ..stage.values import raw, value
from .texture_mean import texture_mean

PREVIEW_SURFACE = "UsdPreviewSurface"
TEXTURE = "UsdUVTexture"
CHANNELS = {"r": 0, "g": 1, "b": 2, "a": 3}
"""Of a texture's outputs that are numbers."""

Number = float | tuple[float, float, float]
"""What an input takes: a number or a colour."""


@dataclass(frozen=True)
class Input:
    """A shader input: its constant, and what drives it."""

    value: Number
    primvar: str = ""
    """Name of the primvar that a connected reader reads."""
    is_mean: bool = False
    """Of a texture, which stands in for it."""


class Materials:
    """Hands each material down once."""

    def __init__(self, translator: Any, context: FrameContext) -> None:
        self._translator = translator
        self._context = context
        self._ids: dict[str, int | None] = {}

    def bound_to(self, prim: Usd.Prim) -> int | None:
        """The translator's id of the material that a prim or subset is bound to; None: displayColor shows."""
        try:
            material, _ = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial(UsdShade.Tokens.full)
            return self._id(material)
        except (Tf.ErrorException, UnicodeDecodeError) as error:
            message = f"USD cannot evaluate the material: {tf_reason(error)}; displayColor shows instead"
            self._context.diagnostics.warning(str(prim.GetPath()), "material:binding", message)
            return None

    def bound_to_each(self, prims: list[Usd.Prim]) -> list[int | None]:
        """Likewise of many prims, which is quicker together."""
        try:
            materials, _ = UsdShade.MaterialBindingAPI.ComputeBoundMaterials(prims, UsdShade.Tokens.full)
            return [self._id(material) for material in materials]
        except (Tf.ErrorException, UnicodeDecodeError):
            return [self.bound_to(prim) for prim in prims]

    def _id(self, material: UsdShade.Material) -> int | None:
        if not material:
            return None
        path = str(material.GetPath())
        if path not in self._ids:
            self._ids[path] = self._read(material)
        return self._ids[path]

    def _read(self, material: UsdShade.Material) -> int | None:
        path = str(material.GetPath())
        shader, _, _ = material.ComputeSurfaceSource()
        identifier = _shader_id(shader) if shader else None
        if identifier != PREVIEW_SURFACE:
            found = "no surface shader that can be read"
            if shader:
                found = f"a surface shader {identifier or 'of no known type'}"
            message = f"found {found}, expected {PREVIEW_SURFACE}; displayColor shows instead"
            self._context.diagnostics.group(path, "outputs:surface", message)
            return None
        self._tell_of_the_rest(shader)
        diffuse = self._input(shader, "diffuseColor", (0.18, 0.18, 0.18))
        emissive = self._input(shader, "emissiveColor", (0.0, 0.0, 0.0))
        opacity = self._input(shader, "opacity", 1.0)
        # The mean of a cutout is how much of it is there: a threshold would make it all or nothing.
        threshold = Input(0.0) if opacity.is_mean else self._input(shader, "opacityThreshold", 0.0)
        return self._translator.add_material(
            name=path,
            diffuse_color=diffuse.value,
            diffuse_from_display_color=diffuse.primvar == "displayColor",
            emissive_color=emissive.value,
            emissive_from_display_color=emissive.primvar == "displayColor",
            opacity=opacity.value,
            opacity_from_display_opacity=opacity.primvar == "displayOpacity",
            opacity_threshold=threshold.value,
        )

    def _tell_of_the_rest(self, shader: UsdShade.Shader) -> None:
        """Names what a diffuse surface does not show. Every UsdPreviewSurface has a specular part: one note
        for all of them."""
        path, diagnostics = str(shader.GetPath()), self._context.diagnostics
        message = "UsdPreviewSurface is drawn as diffuse; specular, metallic and clearcoat are not supported yet"
        diagnostics.group(path, "", message, "note")
        for name, neutral in (("normal", Gf.Vec3f(0, 0, 1)), ("displacement", 0.0)):
            unsupported = shader.GetInput(name)
            sources = unsupported.GetValueProducingAttributes() if unsupported else ()
            if sources and (_is_output(sources[0]) or any_but(neutral, sources[0], self._context.shutter)):
                diagnostics.group(path, unsupported.GetFullName(), "not supported yet; drawn without it")

    def _input(self, shader: UsdShade.Shader, name: str, default: Number) -> Input:
        """An input's constant at the frame, followed through node graphs and material interfaces."""
        shader_input = shader.GetInput(name)
        if not shader_input:
            return Input(default)
        sources = shader_input.GetValueProducingAttributes()
        if not sources:
            return Input(default)
        source = sources[0]
        if not _is_output(source):
            why = ", as Hydra does"
            warn_of_change(source, why, self._context.shutter, self._context.diagnostics)
            value = raw(source, self._context.code)
            return Input(default if value is None else self._number(value, default, source))
        return self._connected(shader_input, source, default)

    def _connected(self, shader_input: UsdShade.Input, source: Usd.Attribute, default: Number) -> Input:
        """An input that another node's output drives: readers of displayColor and displayOpacity are drawn, others
        fall back."""
        node = UsdShade.Shader(source.GetPrim())
        identifier = _shader_id(node) or "node of no known type"
        if identifier == TEXTURE:
            return self._textured(shader_input, node, source.GetName().split(":")[-1], default)
        fallback = self._fallback(node, default, None)
        if identifier.startswith("UsdPrimvarReader"):
            primvar = self._name(node, "varname")
            if (shader_input.GetBaseName(), primvar) in (
                ("diffuseColor", "displayColor"),
                ("emissiveColor", "displayColor"),
                ("opacity", "displayOpacity"),
            ):
                return Input(fallback, primvar)
            identifier = f"{identifier} of '{primvar}'"
        message = f"connected to a {identifier}, which is not evaluated yet; drawn as {_text(fallback)}"
        shader = str(shader_input.GetPrim().GetPath())
        self._context.diagnostics.group(shader, shader_input.GetFullName(), message)
        return Input(fallback)

    def _textured(self, shader_input: UsdShade.Input, node: UsdShade.Shader, output: str, default: Number) -> Input:
        """What stands in for a texture: its mean, else its fallback, else the input's default."""
        file, mean = self._constant(node, "file", None), None
        if isinstance(file, Sdf.AssetPath) and file.path:
            attribute = node.GetInput("file").GetValueProducingAttributes()[0]
            mean = texture_mean(file, attribute, str(self._constant(node, "sourceColorSpace", "auto")))
        if mean is not None:
            mean = mean * self._four(node, "scale", 1.0) + self._four(node, "bias", 0.0)
            found = Input(_channel(mean, output, default), is_mean=True)
            drawn = "drawn as the mean of its texture"
        else:
            authored = self._constant(node, "fallback", None)
            found = Input(default if authored is None else self._fallback(node, default, output))
            name = file.path if isinstance(file, Sdf.AssetPath) else ""
            why = f"@{name}@ cannot be read" if name else "it names no file"
            source = "and it has no fallback: drawn as" if authored is None else "drawn as its fallback,"
            drawn = f"{why}, {source} {_text(found.value)}"
        message = f"connected to a {TEXTURE}, which is not evaluated yet; {drawn}"
        shader = str(shader_input.GetPrim().GetPath())
        self._context.diagnostics.group(shader, shader_input.GetFullName(), message)
        return found

    def _four(self, node: UsdShade.Shader, name: str, default: float) -> np.ndarray:
        """scale or bias: float64[4]. What is not four finite numbers leaves the texture as it is, like its scale."""
        try:
            values = np.array(self._constant(node, name, (default,) * 4), np.float64)
        except (TypeError, ValueError):
            values = np.zeros(0)
        return values if values.shape == (4,) and np.isfinite(values).all() else np.full(4, default)

    def _fallback(self, node: UsdShade.Shader, default: Number, output: str | None) -> Number:
        """What a node says is drawn in its place. Those of textures have four channels; None for what is no
        texture."""
        value = self._constant(node, "fallback", default)
        if isinstance(value, (Gf.Vec4f, Gf.Vec4d, Gf.Vec4h)) and output is not None:
            value = _channel(np.array(value, np.float64), output, default)
        return self._number(value, default, node.GetPrim().GetAttribute("inputs:fallback"))

    def _number(self, value: Any, default: Number, source: Usd.Attribute) -> Number:
        """A value as the kind of number that `default` is; `default`, with a warning, where it is none."""
        try:
            number = () if isinstance(value, (bool, str)) else self._converted(value, default)
        except (TypeError, ValueError):
            number = ()
        if isinstance(number, float) or len(number) == 3:
            return number
        expected = "a number" if isinstance(default, float) else "three numbers"
        message = f"found {value!r}, expected {expected}; drawn as {_text(default)}"
        self._context.diagnostics.warning(str(source.GetPrimPath()), source.GetName(), message)
        return default

    @staticmethod
    def _converted(value: Any, default: Number) -> Number:
        if isinstance(default, float):
            return float(value)
        red, green, blue = map(float, value)
        return red, green, blue

    def _name(self, node: UsdShade.Shader, name: str) -> str:
        node_input = node.GetInput(name)
        sources = node_input.GetValueProducingAttributes() if node_input else ()
        return (value(sources[0], self._context.code, TOKEN) if sources else None) or ""

    def _constant(self, node: UsdShade.Shader, name: str, default: Any) -> Any:
        node_input = node.GetInput(name)
        sources = node_input.GetValueProducingAttributes() if node_input else ()
        value = raw(sources[0], self._context.code) if sources else None
        return default if value is None else value


def _shader_id(shader: UsdShade.Shader) -> str | None:
    """shader.GetShaderId(), and a report where its type is what is wrong with it."""
    attribute = shader.GetIdAttr()
    if attribute and attribute.HasAuthoredValue():
        value(attribute, Usd.TimeCode.Default(), TOKEN)
    return shader.GetShaderId()


def _is_output(attribute: Usd.Attribute) -> bool:
    """Whether a node computes the attribute, so that it holds no value itself."""
    return UsdShade.Utils.GetType(attribute.GetName()) == UsdShade.AttributeType.Output


def _channel(values: np.ndarray, output: str, default: Number) -> Number:
    """What an output of a texture gives an input of `default`'s kind: three channels are a colour, the last is an
    opacity; one channel is grey."""
    if output in CHANNELS:
        value = float(values[CHANNELS[output]])
        return value if isinstance(default, float) else (value, value, value)
    red, green, blue, alpha = values.tolist()
    return alpha if isinstance(default, float) else (red, green, blue)


def _text(value: Number) -> str:
    return f"{value:g}" if isinstance(value, float) else "(" + ", ".join(f"{part:g}" for part in value) + ")"
