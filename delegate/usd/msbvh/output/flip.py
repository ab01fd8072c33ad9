"""How different two pictures look: HDR-FLIP, as OpenImageIO has it.

P. Andersson, J. Nilsson, P. Shirley, T. Akenine-Möller, "Visualizing Errors in Rendered High Dynamic Range Images",
Eurographics 2021.
"""

from __future__ import annotations

import numpy as np
import OpenImageIO as oiio

LUMINANCE = (0.2126, 0.7152, 0.0722)
"""Of linear Rec.709."""
BRIGHTEST = 65504.0
"""Larger colours, infinite ones too, count as this, and what is no number as black: one such pixel decides over itself alone."""


def flip_map(reference: np.ndarray, test: np.ndarray) -> np.ndarray:
    """float32[height, width] in [0, 1]: 0 where nobody would see a difference. Both are float[height, width, 3] of linear
    colours; what is below 0 counts as 0. Raises ValueError where their shapes differ.

    As the paper has it, the exposures at which the two are compared follow from the reference's largest luminance and its
    median; here the median of what is not black. With black pixels counted, a mostly black picture would have a median of 0,
    and an exposure without a bound.
    """
    if reference.shape != test.shape or reference.ndim != 3 or reference.shape[2] != 3:
        raise ValueError(
            f"found pictures of shapes {reference.shape} and {test.shape}, expected two of [height, width, 3]"
        )
    shown = [np.clip(np.nan_to_num(pixels), 0.0, BRIGHTEST) for pixels in (reference, test)]
    largest, median = _luminances(shown[0])
    first, second = (oiio.ImageBuf(np.ascontiguousarray(pixels, np.float32)) for pixels in shown)
    found = oiio.ImageBufAlgo.FLIP_diff(first, second, maxluminance=largest, medianluminance=median)
    if found.has_error:
        raise ValueError(f"FLIP: {found.geterror()}")
    return np.asarray(found.get_pixels(oiio.FLOAT), np.float32)[..., 0]


def _luminances(pixels: np.ndarray) -> tuple[float, float]:
    """The largest, and the median of those above 0; of a black picture, 1 and 1."""
    found = pixels @ np.array(LUMINANCE)
    seen = found[found > 0.0]
    return (float(seen.max()), float(np.median(seen))) if seen.size else (1.0, 1.0)
