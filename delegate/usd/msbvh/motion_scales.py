"""UsdGeomMotionAPI: how much a prim blurs. Inherited down the namespace by the prims that have the schema."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from pxr import Usd, UsdGeom

from .errors import Diagnostics
from .value_types import FLOAT
from .values import value

MOTION_PROPERTIES = frozenset(("motion:blurScale", "motion:velocityScale"))


@dataclass(frozen=True)
class MotionScales:
    """What holds at a prim.

    motion:nonlinearSampleCount is not among them: it says how often renderers sample that cannot take
    accelerations and angular velocities as they are. This one can.
    """

    blur: float = 1.0
    """Scales the shutter about the frame."""
    velocity: float = 1.0
    """Multiplies velocities and angular velocities. Deprecated in USD, but authored."""

    def below(self, prim: Usd.Prim, code: Usd.TimeCode, diagnostics: Diagnostics) -> MotionScales:
        """What holds at a child. A value that is no scale is left out with a warning."""
        if not prim.HasAPI(UsdGeom.MotionAPI):
            return self
        api = UsdGeom.MotionAPI(prim)
        blur = _scale(api.GetMotionBlurScaleAttr(), self.blur, 0.0, code, diagnostics)
        velocity = _scale(api.GetVelocityScaleAttr(), self.velocity, -math.inf, code, diagnostics)
        return self if (blur, velocity) == (self.blur, self.velocity) else replace(self, blur=blur, velocity=velocity)


def scales_at(prim: Usd.Prim, code: Usd.TimeCode, diagnostics: Diagnostics) -> MotionScales:
    """What holds at a prim that no traversal has come by."""
    scales = MotionScales()
    for path in prim.GetPath().GetPrefixes():
        scales = scales.below(prim.GetStage().GetPrimAtPath(path), code, diagnostics)
    return scales


def _scale(
    attribute: Usd.Attribute, inherited: float, least: float, code: Usd.TimeCode, diagnostics: Diagnostics
) -> float:
    if not attribute or not attribute.HasAuthoredValue():
        return inherited
    found = value(attribute, code, FLOAT)
    if found is None:
        return inherited
    if math.isfinite(found) and found >= least:
        return float(found)
    expected = "a finite number" + (" of at least 0" if least == 0.0 else "")
    message = f"found {found:g}, expected {expected}; took {inherited:g}"
    diagnostics.warning(str(attribute.GetPrimPath()), attribute.GetName(), message)
    return inherited
