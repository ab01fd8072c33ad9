"""How far the joints of an animation turn within the shutter, bounded by its authored samples."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from pxr import UsdSkel

from .. import _core
from .._core import Turns
from ..motion.times import Shutter
from ..motion.turns import NO_TURNS


def joint_turns(animation: UsdSkel.AnimQuery, shutter: Shutter) -> Turns:
    """The most that a joint turns together with its parents. NO_TURNS where the rotations are no usable numbers, which
    others report."""
    first, last = shutter.interval.min, shutter.interval.max
    inside = animation.GetJointTransformTimeSamplesInInterval(shutter.interval)
    times = np.unique([first, *inside, last]).tolist()
    if len(times) < 2:  # The shutter's ends cannot be told apart.
        return NO_TURNS
    parents = _parents([str(name) for name in animation.GetJointOrder()])
    rotations = [_rotations(animation, time) for time in times]
    if any(len(each) != len(parents) for each in rotations):
        return NO_TURNS
    times01 = [0.0, *map(shutter.time01, times[1:-1]), 1.0]
    return _core.joint_turns(times01, np.array(rotations), parents)


def _rotations(animation: UsdSkel.AnimQuery, time: float) -> np.ndarray:
    """float64[J, 4]: i, j, k, real."""
    components = animation.ComputeJointLocalTransformComponents(time)
    if not components:
        return np.zeros((0, 4))
    return np.array([(*q.GetImaginary(), q.GetReal()) for q in components[1]], np.float64).reshape(-1, 4)


def _parents(names: Sequence[str]) -> list[int]:
    """The nearest joint above each; -1 for none. Names are paths."""
    index_of = {name: index for index, name in enumerate(names)}
    parents = []
    for name in names:
        above = name.rpartition("/")[0]
        while above and above not in index_of:
            above = above.rpartition("/")[0]
        parents.append(index_of[above] if above else -1)
    return parents
