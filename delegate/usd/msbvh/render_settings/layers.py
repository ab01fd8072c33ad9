"""Which layers a product's render vars make of a file, and what of several products is not written."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from ..base.errors import Diagnostics
from .asked import Asked


@dataclass(frozen=True)
class Layer:
    """An AOV under a name of its own."""

    name: str
    aov: str
    half: bool = False
    """16 bits a number in place of 32."""


@dataclass(frozen=True)
class FileLayers:
    """What a file holds beside colour."""

    layers: tuple[Layer, ...] = ()
    color_half: bool | None = None
    """None: the file's own default."""

    @property
    def aovs(self) -> tuple[str, ...]:
        """That have to be rendered."""
        return tuple(dict.fromkeys(layer.aov for layer in self.layers))


def file_layers(asked: Asked, aovs: Sequence[str], diagnostics: Diagnostics) -> FileLayers:
    """The product's vars in their order, and behind them what --aov asks for under its own name."""
    colors = [var for var in asked.product.vars if var.aov is None]
    layers = [Layer(var.name, var.aov, var.format == "half") for var in asked.product.vars if var.aov is not None]
    if layers and not colors:
        diagnostics.note(asked.product.path, "orderedVars", "names no colour, which is written all the same")
    taken = {layer.name: layer.aov for layer in layers}
    for aov in aovs:
        if aov not in taken:
            layers.append(Layer(aov, aov))
        elif taken[aov] != aov:
            message = f"{aov}: not written: a render var of that name is {taken[aov]}, expected another name"
            diagnostics.warning(asked.product.path, "orderedVars", message)
    known = [color.format == "half" for color in colors if color.format is not None]
    return FileLayers(tuple(layers), known[0] if known else None)


def tell_unwritten(asked: Asked, outputs: Sequence[str], diagnostics: Diagnostics) -> None:
    """What of the products goes elsewhere, or nowhere."""
    product, others = asked.product, asked.spec.products[1:]
    if product.name:
        message = f"found '{product.name}'; written to {', '.join(outputs)} instead"
        diagnostics.note(product.path, "productName", message)
    for other in others:
        message = f"not rendered: of several products the first is, {product.path}"
        diagnostics.warning(other.path, "", message)
    held = any(Path(output).suffix.lower() == ".exr" for output in outputs)
    for var in () if held else product.vars:
        if var.aov is not None:
            diagnostics.warning(var.path, "", "not written: only .exr files hold AOVs, and no OUT is one")
