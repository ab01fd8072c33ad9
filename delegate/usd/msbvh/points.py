"""Points over the shutter: time samples, or velocities where USD's rule says that they apply."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from pxr import Usd, UsdGeom

from .context import FrameContext, array
from .times import FINEST_LEVEL, bracketing_times, sample_times
from .transforms import Box

CHORD_TOLERANCE = 2.5e-5
"""How far points may stray from their parabolas between samples, relative to the mesh's extent: a twentieth
of a pixel where the mesh fills a 2K image."""


@dataclass
class Samples:
    """Arrays at increasing times; linear between them (`held`: each holds until the next), held outside."""

    values: list[tuple[float, np.ndarray]] = field(default_factory=list)
    """time01 and float32[N, 3] each."""
    held: bool = False

    def box(self) -> Box:
        """Around the values of all samples."""
        box = Box.empty()
        for _, points in self.values:
            box = box.union(Box.around(points))
        return box


def still(samples: list[tuple[float, np.ndarray]]) -> bool:
    """Whether all samples hold the same values, however many there are."""
    first = samples[0][1]
    return all(np.array_equal(first, values) for _, values in samples[1:])


def sample_array(attribute: Usd.Attribute, context: FrameContext) -> Samples | None:
    """The bracketing samples of a float3[] attribute; one sample where it does not change.

    None where the number of elements changes within the shutter: then nothing says how to interpolate.
    """
    shutter = context.shutter
    times = sample_times([attribute], shutter)
    values = [(shutter.time01(time), attribute.Get(time)) for time in times]
    blocked = [time for time, (_, value) in zip(times, values, strict=True) if value is None]
    if blocked:
        message = (
            f"found blocked samples at {', '.join(f'{time:g}' for time in blocked)}; interpolated across them"
        )
        context.diagnostics.warning(str(attribute.GetPrim().GetPath()), attribute.GetName(), message)
    samples = [(time01, array(value, np.float32, 3)) for time01, value in values if value is not None]
    if not samples:
        return Samples([(0.0, array(attribute.Get(context.code), np.float32, 3))])
    if len({len(value) for _, value in samples}) > 1:
        return None
    return Samples(samples[:1] if still(samples) else samples, context.held)


def sample_points(shape: UsdGeom.PointBased, topology_varies: bool, context: FrameContext) -> Samples:
    """How the points of a mesh move over the shutter.

    The pose of the frame is held, with a warning, where the topology changes and no velocities say how to go
    on.
    """
    if context.shutter.moving and velocities_apply(shape, context):
        return _moved_by_velocities(shape, context)
    attribute = shape.GetPointsAttr()
    at_frame = array(attribute.Get(context.code), np.float32, 3)
    samples = None if topology_varies else sample_array(attribute, context)
    if samples is not None and len(samples.values[0][1]) == len(at_frame):
        return samples
    message = "the topology changes within the shutter and no velocities apply; held the frame's pose"
    context.diagnostics.warning(str(shape.GetPath()), attribute.GetName(), message)
    return Samples([(0.0, at_frame)])


def velocities_apply(shape: UsdGeom.PointBased, context: FrameContext) -> bool:
    """Whether the points leave from one base sample by velocities."""
    return rates_apply(shape.GetPointsAttr(), shape.GetVelocitiesAttr(), context)


def rates_apply(points: Usd.Attribute, velocities: Usd.Attribute, context: FrameContext) -> bool:
    """USD's rule (UsdGeomPointBased::ComputePointsAtTimes): as many velocities as points at the sample at or
    before the frame, and the samples around the frame align. Likewise positions and orientations of instancers.

    Says why not where velocities are authored.
    """
    if not velocities.HasAuthoredValue():
        return False
    frame = context.shutter.frame
    count = len(array(velocities.Get(context.code), np.float32, 3))
    path, name = str(points.GetPrimPath()), points.GetName()
    if count == 0:
        return False
    around = points.GetBracketingTimeSamples(frame)
    # On a sample the interval after it counts.
    aligned = all(
        points.GetBracketingTimeSamples(time) == velocities.GetBracketingTimeSamples(time)
        for time in (frame, frame + Usd.TimeCode.SafeStep())
    )
    if not around or not aligned:
        message = f"not used: the samples do not align with those of {name} (USD's rule)"
        context.diagnostics.warning(path, velocities.GetName(), message)
        return False
    point_count = len(points.Get(around[0]) or ())
    count = len(velocities.Get(around[0]) or ())
    if count != point_count:
        message = f"not used: found {count} values, expected {point_count}, as many as {name}"
        context.diagnostics.warning(path, velocities.GetName(), message)
    return count == point_count


def _moved_by_velocities(shape: UsdGeom.PointBased, context: FrameContext) -> Samples:
    """USD's own positions from the one base sample: two times where they move straight, else an even grid."""
    straight = _computed_points(shape, [0.0, 0.5, 1.0], context)
    begin, middle, end = (points for _, points in straight)
    if np.array_equal(begin, end) and np.array_equal(begin, middle):
        return Samples(straight[:1])
    # USD computes in single precision: a straight line bends by the rounding of positions.
    rounding = 4 * np.finfo(np.float32).eps * max(np.abs(begin).max(), np.abs(end).max())
    bend = np.linalg.norm(middle - (begin + end) / 2, axis=1).max()
    if bend <= rounding:
        return Samples([straight[0], straight[2]])
    # Under acceleration points move on parabolas; halving a chord's time quarters its distance from the arc.
    chord = max(CHORD_TOLERANCE * np.ptp(middle, axis=0).max(), rounding)
    level = min(max(math.ceil(math.log(bend / chord, 4)), 1), FINEST_LEVEL)
    even = np.linspace(0.0, 1.0, 2**level + 1).tolist()
    return Samples(_computed_points(shape, even, context))


def _computed_points(
    shape: UsdGeom.PointBased, times01: list[float], context: FrameContext
) -> list[tuple[float, np.ndarray]]:
    codes = [context.shutter.time_code(time) for time in times01]
    points = shape.ComputePointsAtTimes(codes, context.code)
    return [(time, array(values, np.float32, 3)) for time, values in zip(times01, points, strict=True)]


def changes(attribute: Usd.Attribute, context: FrameContext) -> bool:
    """Whether an int[] attribute takes more than one value within the shutter. Compares values, not sample
    counts."""
    if not context.shutter.moving or not attribute.ValueMightBeTimeVarying():
        return False
    # Integers are held until the next sample: the one after the shutter says nothing.
    interval = context.shutter.interval
    values = [attribute.Get(t) for t in bracketing_times(attribute, context.shutter) if t <= interval.max]
    return any(value != values[0] for value in values[1:])
