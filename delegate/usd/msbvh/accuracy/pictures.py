"""The pictures of a report: what was rendered, and where it differs from the reference."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ..base.atomic import check_folder
from ..look.color import ColorCorrection
from ..output.flip import flip_map
from ..output.images import write_display_png

FOLDER = "pictures"
_HEAT = np.array([[0.0, 0.0, 0.02], [0.35, 0.07, 0.43], [0.83, 0.29, 0.26], [0.98, 0.65, 0.04], [0.99, 1.0, 0.64]])
"""From 0 to 1, evenly spaced: dark to bright, also for those who see few colours."""


def write_pictures(data: dict[str, Any], pictures: Mapping[str, np.ndarray], out: Path) -> None:
    """Writes the reference and points as PNG, with error maps, and notes their names in the report's data."""
    check_folder(out / FOLDER)
    color = ColorCorrection("sRGB", None, None)
    reference = pictures["reference"]
    for name, pixels in pictures.items():
        entry = data["reference"] if name == "reference" else data["points"][name]
        entry["picture"] = f"{FOLDER}/{name}.png"
        write_display_png(out / entry["picture"], color.apply(pixels.astype(np.float32)))
        if name != "reference":
            entry["error_map"] = f"{FOLDER}/{name}_flip.png"
            write_display_png(out / entry["error_map"], _heat(flip_map(reference, pixels)))


def _heat(error: np.ndarray) -> np.ndarray:
    """float32[height, width, 3] of an error in [0, 1]."""
    at = np.clip(error, 0.0, 1.0)
    places = np.linspace(0.0, 1.0, len(_HEAT))
    return np.stack([np.interp(at, places, _HEAT[:, channel]) for channel in range(3)], axis=-1).astype(np.float32)
