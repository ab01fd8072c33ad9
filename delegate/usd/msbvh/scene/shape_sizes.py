"""How large implicit shapes are seen, and how many sides they need."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..motion.boxes import Box, Pixels, corners_of
from .implicit import SIDES, sides_for


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
    matrices: np.ndarray, radius: float, box: Box, is_sphere: bool, pixels: Pixels, silhouette_pixels: float
) -> np.ndarray:
    """int[N]: the sides of a shape of that radius in that box under each of float64[T, N, 4, 4] matrices."""
    most, least = stretches(matrices)
    if is_sphere:  # The eye may be inside of one that stands for the sky.
        size = pixels.at_spheres(matrices[..., 3, :3], most * radius, least * radius)
    else:
        size = pixels(corners_of([box]) @ matrices[..., :3])
    return sides_for(most.max(axis=0) * radius / size, silhouette_pixels)


def side_chooser(
    matrices: Callable[[], np.ndarray], is_sphere: bool, pixels: Pixels, silhouette_pixels: float
) -> Callable[[float, Box], int]:
    """Of a single shape, at float64[T, 4, 4] matrices."""

    def choose(radius: float, box: Box) -> int:
        found = matrices()[:, None]
        if radius == 0.0 or not np.isfinite(found).all():
            return SIDES
        return int(sides_in_pixels(found, radius, box, is_sphere, pixels, silhouette_pixels)[0])

    return choose
