"""How far the joints of an animation turn within the shutter, bounded by its authored samples."""

from __future__ import annotations

import numpy as np
from pxr import UsdSkel

from .._core import Turns
from ..motion.times import Shutter
from ..motion.turns import NO_TURNS


def joint_turns(animation: UsdSkel.AnimQuery, shutter: Shutter) -> Turns:
    """The most that a joint turns together with its parents, which turn it too: between two samples each turns along
    the shorter arc, by half a turn at most. NO_TURNS where the rotations are no usable numbers, which others report."""
    first, last = shutter.interval.min, shutter.interval.max
    inside = animation.GetJointTransformTimeSamplesInInterval(shutter.interval)
    times = np.unique([first, *inside, last])
    if len(times) < 2:  # The shutter's ends cannot be told apart.
        return NO_TURNS
    rotations = [_rotations(animation, time) for time in times.tolist()]
    if any(len(each) != len(rotations[0]) for each in rotations) or not len(rotations[0]):
        return NO_TURNS
    unit = np.array(rotations)
    cosines = np.clip(np.abs((unit[1:] * unit[:-1]).sum(axis=2)), 0.0, 1.0)
    own = np.arccos(cosines) / np.pi
    if not np.isfinite(own).all():
        return NO_TURNS
    with_parents = _added_to_parents(own, [str(name) for name in animation.GetJointOrder()])
    total = np.concatenate([[0.0], np.cumsum(with_parents.max(axis=1))])
    times01 = np.array([shutter.time01(time) for time in times.tolist()])
    times01[0], times01[-1] = 0.0, 1.0
    return Turns(times01.tolist(), total.tolist()) if total[-1] > 0.0 else NO_TURNS


def _rotations(animation: UsdSkel.AnimQuery, time: float) -> np.ndarray:
    """float64[J, 4] of unit length."""
    components = animation.ComputeJointLocalTransformComponents(time)
    if not components:
        return np.zeros((0, 4))
    values = np.array([(q.GetReal(), *q.GetImaginary()) for q in components[1]], np.float64).reshape(-1, 4)
    lengths = np.linalg.norm(values, axis=1, keepdims=True)
    return values / np.where(lengths > 0.0, lengths, 1.0)


def _added_to_parents(own: np.ndarray, names: list[str]) -> np.ndarray:
    """float64[T, J] with those of all joints above each: names are paths."""
    column = {name: index for index, name in enumerate(names)}
    result = own.copy()
    for index in sorted(range(len(names)), key=lambda joint: names[joint].count("/")):
        above = names[index].rpartition("/")[0]
        while above and above not in column:
            above = above.rpartition("/")[0]
        if above:
            result[:, index] += result[:, column[above]]
    return result
