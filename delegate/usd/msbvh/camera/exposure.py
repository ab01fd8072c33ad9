"""How much a camera brightens its picture: UsdGeomCamera's exposure attributes."""

from __future__ import annotations

import numpy as np
from pxr import Usd

from .. import _core
from ..base.errors import Diagnostics
from ..motion.held_values import warn_of_change
from ..motion.times import Shutter
from ..stage.value_types import FLOAT
from ..stage.values import value

_ATTRIBUTES = {
    "exposure": 0.0,
    "exposure:time": 1.0,
    "exposure:iso": 100.0,
    "exposure:fStop": 1.0,
    "exposure:responsivity": 1.0,
}
"""With the schema's values, in the order of _core.exposure_scale()."""


def exposure_scale(prim: Usd.Prim, shutter: Shutter, diagnostics: Diagnostics) -> float:
    """By the frame's values (UsdGeom.Camera.ComputeLinearExposureScale), in single precision as there. One that is not
    finite or negative counts as 1, with a warning."""
    found = []
    for name, standard in _ATTRIBUTES.items():
        attribute = prim.GetAttribute(name)
        given = value(attribute, shutter.frame_code, FLOAT) if attribute else None
        if given is not None:
            warn_of_change(attribute, "", shutter, diagnostics)
        found.append(standard if given is None else float(given))
    scale = float(np.float32(_core.exposure_scale(*found)))
    if 0.0 <= scale < float("inf"):
        return scale
    values = ", ".join(f"{name} {given:g}" for name, given in zip(_ATTRIBUTES, found, strict=True))
    message = f"found {values}: an exposure scale of {scale:g}; expected a finite scale of at least 0; took 1"
    diagnostics.warning(str(prim.GetPath()), "exposure", message)
    return 1.0
