"""Which instances of a point instancer are neither invisible nor inactive."""

from __future__ import annotations

import numpy as np
from pxr import Usd, UsdGeom

from ..stage.value_types import LONGS
from ..stage.values import value


def instance_mask(instancer: UsdGeom.PointInstancer, count: int, code: Usd.TimeCode) -> np.ndarray:
    """bool[N]: UsdGeom.PointInstancer.ComputeMaskAtTime() from values that come through the gate: N is the number
    of ids, or the `count` of instances where nothing has an id."""
    ids = value(instancer.GetIdsAttr(), code, LONGS)
    hidden = list(value(instancer.GetInvisibleIdsAttr(), code, LONGS) or ())
    inactive = instancer.GetPrim().GetMetadata("inactiveIds")
    if inactive is not None:
        hidden += inactive.GetAppliedItems()
    if not hidden:
        return np.ones(count, bool)
    return ~np.isin(np.asarray(ids) if ids else np.arange(count), np.array(hidden, np.int64))
