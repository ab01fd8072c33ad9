"""UsdGeomMotionAPI: how much a prim blurs. Inherited down the namespace by the prims that have the schema."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from pxr import Usd, UsdGeom

from .._core import checked_scale
from ..base.errors import Diagnostics
from ..stage.value_types import FLOAT
from ..stage.values import value
from .held_values import warn_of_change
from .times import Shutter

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

    def below(self, prim: Usd.Prim, shutter: Shutter, diagnostics: Diagnostics) -> MotionScales:
        """What holds at a child. A value that is no scale is left out with a warning. Scales are the frame's: they say
        how long a prim's shutter is. `shutter`: the camera's."""
        if not prim.HasAPI(UsdGeom.MotionAPI):
            return self
        api = UsdGeom.MotionAPI(prim)
        blur = _scale(api.GetMotionBlurScaleAttr(), self.blur, 0.0, shutter, diagnostics)
        velocity = _scale(api.GetVelocityScaleAttr(), self.velocity, -math.inf, shutter, diagnostics)
        return self if (blur, velocity) == (self.blur, self.velocity) else replace(self, blur=blur, velocity=velocity)


def scales_at(prim: Usd.Prim, shutter: Shutter, diagnostics: Diagnostics) -> MotionScales:
    """What holds at a prim that no traversal has come by."""
    scales = MotionScales()
    for path in prim.GetPath().GetPrefixes():
        scales = scales.below(prim.GetStage().GetPrimAtPath(path), shutter, diagnostics)
    return scales


def _scale(
    attribute: Usd.Attribute, inherited: float, least: float, shutter: Shutter, diagnostics: Diagnostics
) -> float:
    if not attribute or not attribute.HasAuthoredValue():
        return inherited
    warn_of_change(attribute, "", shutter, diagnostics)
    found = value(attribute, shutter.frame_code, FLOAT)
    if found is None:
        return inherited
    scale, said = checked_scale(str(attribute.GetPrimPath()), attribute.GetName(), found, inherited, least)
    diagnostics.take(said)
    return scale
