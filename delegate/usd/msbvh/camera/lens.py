"""The camera's thin lens over the shutter, from f-number and focus distance."""

from __future__ import annotations

import numpy as np
from pxr import Gf

from .. import _core
from ..base.errors import Diagnostics
from .aspect import optics_of


def read_lenses(path: str, at_frame: Gf.Camera, cameras: list[Gf.Camera], diagnostics: Diagnostics) -> np.ndarray:
    """float32[T, 2]: radius and focus distance of each camera, in the camera's space. `path` is the prim's.

    UsdGeom.Camera: an fStop of 0 turns depth of field off, and so does a focusDistance of 0, which is what it
    is where nobody has authored one. What makes no sense is a pinhole too, with a warning. A lens that is
    there for a part of the shutter only is taken at the frame: from a pinhole to an f-number there is no way
    that would not pass the widest of all lenses.
    """
    lenses, said = _core.lenses_of(path, optics_of(at_frame), [optics_of(camera) for camera in cameras])
    diagnostics.take(said)
    return lenses
