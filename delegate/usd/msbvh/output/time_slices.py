"""Pictures whose shutter is kept in equal slices, and pictures of other shutters made of them.

Slice i of N holds the light of the samples whose times lie in it, as a mean over all samples of the pixel: the slices sum up
to the picture of the whole shutter. A shutter weights them; docs/design/time_resolved.md says what that is worth.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence

import numpy as np

from .._core import MOST_SHUTTER_SLICES

MOST_SLICES = MOST_SHUTTER_SLICES
SLICES = "msbvh:shutterSlices"
"""The attribute of a file that says how many there are."""
OUTSIDE = 1e-6
"""Frames by which a shutter may lie beyond the one that was rendered: a rounding of its numbers as text and as floats."""


def layer_name(index: int) -> str:
    """Of the layer that holds a slice; its channels are R, G, B, A."""
    return f"shutter{index:02d}"


def channel_names(index: int) -> list[str]:
    return [f"{layer_name(index)}.{letter}" for letter in "RGBA"]


def slice_weights(
    count: int,
    rendered: tuple[float, float],
    wanted: tuple[float, float],
    area: Callable[[float, float], float],
) -> np.ndarray:
    """What each of `count` slices of the shutter that was rendered counts for in the one that is wanted: float64[count], 1 in
    the mean. Shutters are open and close, in frames; `area(a, b)` is the integral of the curve of the wanted one from a to b,
    shares of it.

    A slice that a shutter cuts counts by the part of it that lies in it.
    """
    length = rendered[1] - rendered[0]
    edges = rendered[0] + length * np.arange(count + 1) / count
    open_frames = wanted[1] - wanted[0]
    shares = np.clip((edges - wanted[0]) / open_frames, 0.0, 1.0)
    weights = np.array([area(float(a), float(b)) for a, b in itertools.pairwise(shares)])
    return np.asarray(weights * (count / weights.sum()))


def combined(slices: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """float32[height, width, 4] of float32[count, height, width, 4]: the weighted sum, in double precision, as a balanced
    tree over the slices; count is a power of two."""
    sums = [each.astype(np.float64) * weight for each, weight in zip(slices, weights, strict=True)]
    while len(sums) > 1:
        sums = [a + b for a, b in zip(sums[::2], sums[1::2], strict=True)]
    return np.ascontiguousarray(sums[0], np.float32)


def covers(rendered: Sequence[float], wanted: Sequence[float]) -> bool:
    """Whether a shutter lies in the one that was rendered."""
    return rendered[0] - OUTSIDE <= wanted[0] < wanted[1] <= rendered[1] + OUTSIDE
