"""Errors of pictures that several seeds were rendered of, bias and noise apart.

A picture's mean square error is bias squared plus variance. With two or more seeds both have estimates that do not depend
on how many seeds there are: the variance from how the seeds differ, and bias squared from products of the differences of
two seeds, whose noise is not the same. Such an estimate may come out below 0 where there is no bias to be seen.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..bench.frame_noise import DARK
from ..output.flip import flip_map

Pictures = Sequence[np.ndarray]
"""float64[height, width, 3] each: linear colours, one a seed."""


@dataclass(frozen=True)
class PictureError:
    """How far pictures are from a reference."""

    rmse: float
    """Root of the mean square error over pixels and channels, without what the reference's own noise adds."""
    relative_mse: float
    """Mean of (x - r)^2 / (r^2 + DARK), likewise."""
    bias_relative_mse: float
    """The part that more samples would not mend."""
    noise_relative_mse: float
    """The part that they would."""
    flip: float
    """Mean HDR-FLIP of the first seed's picture."""
    bias_flip: float
    """Of the seeds' mean: less of it is noise."""


def picture_error(pictures: Pictures, references: Pictures) -> PictureError:
    """Of pictures that share no noise with the references; at least two of either."""
    reference = np.mean(references, axis=0)
    reference_variance = np.var(references, axis=0, ddof=1) / len(references)
    scale = reference**2 + DARK
    squares = np.mean([(picture - reference) ** 2 for picture in pictures], axis=0) - reference_variance
    noise = float((np.var(pictures, axis=0, ddof=1) / scale).mean())
    relative = float((squares / scale).mean())
    mean = np.mean(pictures, axis=0)
    return PictureError(
        rmse=float(np.sqrt(max(squares.mean(), 0.0))),
        relative_mse=relative,
        bias_relative_mse=relative - noise,
        noise_relative_mse=noise,
        flip=float(flip_map(reference, pictures[0]).mean()),
        bias_flip=float(flip_map(reference, mean).mean()),
    )


def noise_flip(pictures: Pictures) -> float:
    """Mean HDR-FLIP of a picture beside a converged one, by pictures of two seeds and more: A - B has twice the variance of A,
    so that A is as far from A + (B - A) / sqrt(2) as it is from the truth."""
    pairs = zip(pictures, [*pictures[1:], pictures[0]], strict=True)
    return float(np.mean([flip_map(one + (other - one) / np.sqrt(2.0), one).mean() for one, other in pairs]))


def own_noise(references: Pictures) -> float:
    """The relative MSE of the references' mean itself, by how they differ."""
    variance = np.var(references, axis=0, ddof=1) / len(references)
    return float((variance / (np.mean(references, axis=0) ** 2 + DARK)).mean())


@dataclass(frozen=True)
class PairedError:
    """What one cause alone changes: two series of pictures by the same seeds, one with the cause and one without."""

    rmse: float
    relative_mse: float
    """Without the noise that the cause has moved."""
    flip: float
    """Mean HDR-FLIP of the means of the seeds."""


def paired_error(pictures: Pictures, without: Pictures) -> PairedError:
    """pictures[i] and without[i] have the same seed; at least two of either."""
    differences = np.asarray(pictures) - np.asarray(without)
    count = len(differences)
    # Products of two seeds' differences alone: a square would keep the noise in.
    products = (differences.sum(axis=0) ** 2 - (differences**2).sum(axis=0)) / (count * (count - 1))
    means = np.mean(pictures, axis=0), np.mean(without, axis=0)
    scale = means[1] ** 2 + DARK
    return PairedError(
        rmse=float(np.sqrt(max(products.mean(), 0.0))),
        relative_mse=float((products / scale).mean()),
        flip=float(flip_map(means[1], means[0]).mean()),
    )
