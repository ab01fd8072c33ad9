"""How different two pictures look: HDR-FLIP, as OpenImageIO has it.

P. Andersson, J. Nilsson, P. Shirley, T. Akenine-Möller, "Visualizing Errors in Rendered High Dynamic Range Images",
Eurographics 2021.
"""

from __future__ import annotations

import numpy as np
import OpenImageIO as oiio


def flip_map(reference: np.ndarray, test: np.ndarray) -> np.ndarray:
    """float32[height, width] in [0, 1]: 0 where nobody would see a difference. Both are float[height, width, 3] of linear
    colours; what is below 0 counts as 0. Raises ValueError where their shapes differ."""
    if reference.shape != test.shape or reference.ndim != 3 or reference.shape[2] != 3:
        raise ValueError(
            f"found pictures of shapes {reference.shape} and {test.shape}, expected two of [height, width, 3]"
        )
    first, second = (
        oiio.ImageBuf(np.ascontiguousarray(np.maximum(pixels, 0.0), np.float32)) for pixels in (reference, test)
    )
    found = oiio.ImageBufAlgo.FLIP_diff(first, second)
    if found.has_error:
        raise ValueError(f"FLIP: {found.geterror()}")
    return np.asarray(found.get_pixels(oiio.FLOAT), np.float32)[..., 0]
