"""Images as the command line writes them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenImageIO as oiio


def read_exr(path: Path) -> np.ndarray:
    """float32[H, W, 4]."""
    source = oiio.ImageInput.open(str(path))
    assert source, oiio.geterror()
    pixels = source.read_image(oiio.FLOAT)
    source.close()
    return np.asarray(pixels)
