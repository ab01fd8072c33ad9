"""How noisy pictures are, and whether two renderers drew the same one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

DARK = 0.01
"""Added to squared colours before errors are divided by them: darker than 0.1, errors count less."""
BLOCK = 8
"""Pixels: pictures are compared by means over squares of this side, in which little noise is left."""
MEAN_LIMIT = 0.01
"""Means of two renderers' pictures differ by less, in each channel. Where both read a scene as USD means it, they differ
by 0.001 at most."""
SHAPE_LIMIT = 0.02
"""The relative difference of squares is less, root mean square and without noise. A wrong shading of facets moves the
mean by as little as 0.0016 but squares by 0.04 (docs/performance.md)."""


@dataclass(frozen=True)
class Picture:
    """A converged picture: the mean of at least two that share no noise."""

    parts: np.ndarray
    """float64[N, H, W, 3]; as many samples in each."""

    @staticmethod
    def of(parts: Sequence[np.ndarray]) -> Picture:
        return Picture(np.stack(parts))

    @property
    def mean(self) -> np.ndarray:
        """float64[H, W, 3]."""
        return np.asarray(self.parts.mean(axis=0))

    @property
    def variance(self) -> np.ndarray:
        """float64[H, W, 3]: of the mean, estimated without bias from how its parts differ."""
        return np.asarray(self.parts.var(axis=0, ddof=1) / len(self.parts))

    def blocks(self) -> Picture:
        """By squares of BLOCK pixels; what is over at the right and at the bottom is left out."""
        count, height, width, channels = self.parts.shape
        rows, columns = max(height // BLOCK, 1), max(width // BLOCK, 1)
        tall, wide = height // rows, width // columns
        whole = self.parts[:, : rows * tall, : columns * wide]
        return Picture(whole.reshape(count, rows, tall, columns, wide, channels).mean(axis=(2, 4)))


@dataclass(frozen=True)
class Noise:
    """The error of a picture."""

    relative_mse: float
    """Mean over pixels and channels of (x - r)^2 / (r^2 + DARK), less what the converged picture r adds."""
    reference_share: float
    """What the converged picture's own noise adds, as a share of the error."""


def noise(pixels: np.ndarray, converged: Picture) -> Noise:
    """Of a picture, beside the same renderer's converged one, with which it shares no samples."""
    scale = converged.mean**2 + DARK
    found = float((((pixels - converged.mean) ** 2) / scale).mean())
    own = float((converged.variance / scale).mean())
    return Noise(found - own, own / found if found else 0.0)


@dataclass(frozen=True)
class Likeness:
    """How two renderers' converged pictures compare."""

    mean: float
    """The largest relative difference of the means of a channel."""
    shape: float
    """Relative difference of squares, root mean square, without noise."""

    @property
    def comparable(self) -> bool:
        """Whether both drew the same picture, so that their times say something."""
        return self.mean <= MEAN_LIMIT and self.shape <= SHAPE_LIMIT


def likeness(ours: Picture, other: Picture) -> Likeness:
    """Of another renderer's picture to ours."""
    means = [picture.mean.mean(axis=(0, 1)) for picture in (ours, other)]
    mean = float((np.abs(means[1] - means[0]) / np.maximum(np.abs(means[0]), DARK)).max())
    first, second = ours.blocks(), other.blocks()
    scale = first.mean**2 + DARK
    square = (second.mean - first.mean) ** 2 - first.variance - second.variance
    return Likeness(mean, float(np.sqrt(max((square / scale).mean(), 0.0))))
