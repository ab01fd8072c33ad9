"""The matrix that a texture was rendered through, where its metadata has one: what cards from textures are made of."""

from __future__ import annotations

import numpy as np
import OpenImageIO as oiio

_NAMES = ("worldtoscreen", "worldToNDC")
"""Of the metadata, as UsdImaging looks for them: some writers have confused the two."""


def screen_from_world(path: str) -> np.ndarray | None:
    """float64[4, 4], row vectors, to [-1, 1] in the picture; None where there is none that can be inverted."""
    image = oiio.ImageInput.open(path)
    if image is None:
        oiio.geterror()
        return None
    spec = image.spec()
    image.close()
    for name in _NAMES:
        found = spec.getattribute(name)
        if found is None:
            continue
        matrix = np.asarray(found, np.float64)
        if matrix.size == 16 and np.isfinite(matrix).all() and np.linalg.matrix_rank(matrix.reshape(4, 4)) == 4:
            return matrix.reshape(4, 4)
    return None
