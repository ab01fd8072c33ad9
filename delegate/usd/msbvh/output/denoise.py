"""Intel's Open Image Denoise over a picture. The package pyoidn is optional: its wheel carries the library."""

from __future__ import annotations

import importlib.util

import numpy as np

from ..base.errors import SceneError

AUXILIARIES = ("albedo", "normal")
"""AOVs that it looks at beside colour."""
LAYER = "denoised"


def is_installed() -> bool:
    return importlib.util.find_spec("pyoidn") is not None


def denoised(rgba: np.ndarray, albedo: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """float32[height, width, 4]: linear colours without most of their noise, premultiplied like those that come in; alpha as it
    was. `albedo` and `normal`: float32[height, width, 3], as noisy as the picture. Raises SceneError where
    the library cannot."""
    try:
        import pyoidn

        color = np.maximum(rgba[..., :3], np.float32(0.0))
        found = pyoidn.denoise(color, np.clip(albedo, 0.0, 1.0), np.clip(normal, -1.0, 1.0), hdr=True)
    except (ImportError, OSError, RuntimeError) as error:
        raise SceneError(f"--denoise: pyoidn: {' '.join(str(error).split())}") from error
    return np.concatenate([found, rgba[..., 3:]], axis=-1)
