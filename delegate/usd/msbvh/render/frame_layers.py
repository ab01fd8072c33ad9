"""A rendered frame as a file holds it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from .._core import aov_channels, aov_merges
from ..output.cryptomatte import attributes
from ..output.denoise import LAYER
from ..output.images import Layers
from ..output.time_slices import SLICES, channel_names, combined, layer_name, slice_weights
from ..render_settings.layers import FileLayers, Layer
from ..scene.reader import ReadResult
from .film import Film
from .shutter_curve import area

MERGES = aov_merges()
Manifest = Callable[[str, np.ndarray], Sequence[tuple[str, int]]]
"""Of _core.Renderer."""


@dataclass(frozen=True)
class Rendered:
    """What a renderer has made of a frame."""

    pixels: np.ndarray
    aovs: Mapping[str, np.ndarray]
    slices: np.ndarray | None = None
    """Of the shutter: float32[count, height, width, 4]."""
    denoised: np.ndarray | None = None
    """float32[height, width, 4]; alpha is that of `pixels`."""


def weighted(pixels: np.ndarray, slices: np.ndarray, film: Film) -> np.ndarray:
    """The picture of the film's shutter curve: `pixels` where the shutter is not kept in slices, else of these, with the same
    bits as `msbvh reshutter` makes."""
    if not len(slices):
        return pixels
    whole = (0.0, 1.0)
    return combined(slices, slice_weights(len(slices), whole, whole, partial(area, film.shutter_curve)))


def frame_layers(rendered: Rendered, result: ReadResult, wanted: FileLayers | None, manifest: Manifest) -> Layers:
    """`wanted`: AOVs under other names than their own; None: under these."""
    window = result.camera.pixels
    aovs = rendered.aovs
    named = wanted.layers if wanted is not None else [Layer(name, name) for name in aovs]
    values = {layer.name: aovs[layer.aov] for layer in named}
    channels = {layer.name: aov_channels(layer.aov, layer.name) for layer in named}
    described: dict[str, str | int] = {}
    for layer in named:
        if MERGES[layer.aov] == "coverage":
            described.update(attributes(layer.name, aovs[layer.aov], partial(manifest, layer.aov)))
    if rendered.slices is not None and len(rendered.slices):
        described[SLICES] = len(rendered.slices)
        for i, slice in enumerate(rendered.slices):
            values[layer_name(i)], channels[layer_name(i)] = slice, channel_names(i)
    if rendered.denoised is not None:
        values[LAYER], channels[LAYER] = rendered.denoised[..., :3], [f"{LAYER}.{letter}" for letter in "RGB"]
    return Layers(
        rendered.pixels,
        values,
        result.scene.mesh_names if "primId" in aovs else [],
        channels=channels,
        attributes=described,
        halves=frozenset(layer.name for layer in named if layer.half),
        origin=(window.x, window.y),
        display=window.display,
        shown=rendered.denoised,
    )
