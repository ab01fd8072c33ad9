"""How large implicit shapes are seen, and how many sides they need."""

from __future__ import annotations

import numpy as np

from .._core import PixelSize, radii_in_pixels
from ..motion.boxes import Box
from .implicit import ImplicitShape, sides_for


def sides_in_pixels(
    matrices: np.ndarray, kind: str, radius: float, box: Box, pixel_size: PixelSize, silhouette_pixels: float
) -> np.ndarray:
    """int[N]: the sides of a shape of that radius in that box under each of float64[T, N, 4, 4] matrices."""
    radii = radii_in_pixels(kind, radius, box.ends(), np.ascontiguousarray(matrices), pixel_size)
    return sides_for(radii, silhouette_pixels)


def sides_of(shape: ImplicitShape, matrices: np.ndarray, pixel_size: PixelSize, silhouette_pixels: float) -> int:
    """Of a single shape, under float64[T, 4, 4] matrices."""
    found = sides_in_pixels(matrices[:, None], shape.kind, shape.radius, shape.box, pixel_size, silhouette_pixels)
    return int(found[0])
