"""The camera's thin lens over the shutter, from f-number and focus distance."""

from __future__ import annotations

import math

import numpy as np
from pxr import Gf

from ..base.errors import Diagnostics
from .aspect import optics_of

PINHOLE = (0.0, 1.0)
"""Radius and focus distance of a lens through which everything is in focus."""


def read_lenses(path: str, at_frame: Gf.Camera, cameras: list[Gf.Camera], diagnostics: Diagnostics) -> np.ndarray:
    """float32[T, 2]: radius and focus distance of each camera, in the camera's space. `path` is the prim's.

    UsdGeom.Camera: an fStop of 0 turns depth of field off, and so does a focusDistance of 0, which is what it
    is where nobody has authored one. What makes no sense is a pinhole too, with a warning. A lens that is
    there for a part of the shutter only is taken at the frame: from a pinhole to an f-number there is no way
    that would not pass the widest of all lenses.
    """
    if all(camera.fStop == 0.0 for camera in (at_frame, *cameras)):
        return np.tile(np.array(PINHOLE, np.float32), (len(cameras), 1))
    if at_frame.projection == Gf.Camera.Orthographic:
        message = f"found {at_frame.fStop:g} on an orthographic camera, which has no depth of field"
        diagnostics.note(path, "fStop", message)
        return np.tile(np.array(PINHOLE, np.float32), (len(cameras), 1))
    if not all(_makes_sense(path, camera, diagnostics) for camera in (at_frame, *cameras)):
        return np.tile(np.array(PINHOLE, np.float32), (len(cameras), 1))
    lenses = np.array([optics_of(camera).lens for camera in cameras], np.float32)
    opened = lenses[:, 0] > 0.0
    if opened.any() and not opened.all():
        message = "depth of field is on for a part of the shutter only; taken as at the frame"
        diagnostics.warning(path, "fStop", message)
        lenses[:] = optics_of(at_frame).lens
    if not opened.any():
        message = f"found 0, no distance to focus at; everything is in focus in spite of f/{at_frame.fStop:g}"
        diagnostics.note(path, "focusDistance", message)
    return lenses


def _makes_sense(path: str, camera: Gf.Camera, diagnostics: Diagnostics) -> bool:
    for attribute, value in (("fStop", camera.fStop), ("focusDistance", camera.focusDistance)):
        if not (math.isfinite(value) and value >= 0.0):
            message = f"found {value:g}, expected a finite number of at least 0; everything is in focus"
            diagnostics.warning(path, attribute, message)
            return False
    return True
