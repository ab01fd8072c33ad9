"""How large implicit shapes are seen, and how many sides they need."""

from __future__ import annotations

import numpy as np

from .._core import PixelSize
from ..motion.boxes import Box, corners_of
from .implicit import SIDES, ImplicitShape, sides_for


def stretches(matrices: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Bounds of what float64[..., 4, 4] stretch a length by, from above and below.

    Gershgorin's circles of A A^T: exact where the rows are orthogonal, as those of rotations and scales are.
    """
    linear = matrices[..., :3, :3]
    products = linear @ np.swapaxes(linear, -1, -2)
    diagonal = np.einsum("...ii->...i", products)
    beside = np.abs(products).sum(axis=-1) - diagonal
    most, least = (diagonal + beside).max(axis=-1), (diagonal - beside).min(axis=-1)
    return np.sqrt(np.maximum(most, 0.0)), np.sqrt(np.maximum(least, 0.0))


def sides_in_pixels(
    matrices: np.ndarray, radius: float, box: Box, is_sphere: bool, pixel_size: PixelSize, silhouette_pixels: float
) -> np.ndarray:
    """int[N]: the sides of a shape of that radius in that box under each of float64[T, N, 4, 4] matrices."""
    most, least = stretches(matrices)
    if is_sphere:  # The eye may be inside of one that stands for the sky.
        size = pixel_size.at_shells(np.ascontiguousarray(matrices[..., 3, :3]), most * radius, least * radius)
    else:
        size = pixel_size.at_boxes(corners_of([box]) @ matrices[..., :3])
    return sides_for(most.max(axis=0) * radius / size, silhouette_pixels)


def sides_of(
    shape: ImplicitShape, matrices: np.ndarray, is_sphere: bool, pixel_size: PixelSize, silhouette_pixels: float
) -> int:
    """Of a single shape, under float64[T, 4, 4] matrices."""
    if shape.radius == 0.0 or not np.isfinite(matrices).all():
        return SIDES
    found = sides_in_pixels(matrices[:, None], shape.radius, shape.box, is_sphere, pixel_size, silhouette_pixels)
    return int(found[0])
