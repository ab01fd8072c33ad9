"""Points and their rates over the shutter, as authored: what they mean is the translator's business."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from pxr import Usd, UsdGeom

from ..stage.typed_twin import typed_twin
from ..stage.value_types import FLOAT3S, QUATERNIONS
from ..stage.values import Unreadable, ignore, might_vary, raw, required
from .boxes import Box
from .context import FrameContext, array
from .times import bracketing_times, sample_times, thinned

RawSamples = Sequence[tuple[float | None, np.ndarray]]
"""(time01, values) at increasing times, the sizes as they are; the time is None for a value that is authored for
all times."""


@dataclass
class Samples:
    """Arrays at increasing times; linear between them (`held`: each holds until the next), held outside."""

    values: RawSamples = field(default_factory=list)
    """float32[N, 3] each."""
    held: bool = False

    def box(self) -> Box:
        """Around the values of all samples."""
        box = Box.empty()
        for _, points in self.values:
            box = box.union(Box.around(points))
        return box

    def at_frame(self, context: FrameContext) -> np.ndarray:
        """The sample that a value at the frame starts from."""
        frame01 = context.shutter.frame01_unclamped
        before = [values for time01, values in self.values if time01 is None or time01 <= frame01 + 1e-9]
        return (before or [self.values[0][1]])[-1]


def still(samples: RawSamples) -> bool:
    """Whether all samples hold the same values, however many there are."""
    first = samples[0][1]
    return all(np.array_equal(first, values) for _, values in samples[1:])


def raw_samples(
    attribute: Usd.Attribute, context: FrameContext, columns: int = 3, needs_times: bool = False
) -> RawSamples:
    """The samples of an array attribute that the shutter and the frame lie between; one where it does not change.

    A blocked sample has no values. [] where nothing is authored. `needs_times`: it matters whether a value that
    does not change is a time sample, as for what velocities move. Raises Unreadable.
    """
    shutter = context.shutter
    kind = QUATERNIONS if columns == 4 else FLOAT3S
    every = sample_times([attribute], shutter)
    if every:
        times = thinned(every, len(required(attribute, context.code, kind) or ()))
        if len(times) < len(every):
            message = f"found {len(every)} samples in the shutter, too many to hold; {len(times)} of them are read"
            context.diagnostics.group(str(attribute.GetPrimPath()), attribute.GetName(), message)
        return [(shutter.time01(time), array(required(attribute, time, kind), np.float32, columns)) for time in times]
    value = required(attribute, context.code, kind)
    if value is None and not attribute.HasAuthoredValue():
        return []
    values = array(value, np.float32, columns)
    if not (needs_times and shutter.moving and attribute.GetNumTimeSamples()):
        return [(None, values)]
    return [(shutter.time01(bracketing_times(attribute, shutter)[0]), values)]


def optional_samples(
    attribute: Usd.Attribute, context: FrameContext, columns: int = 3, needs_times: bool = False
) -> RawSamples:
    """Like raw_samples(), but values of another type are reported and count as none."""
    try:
        return raw_samples(attribute, context, columns, needs_times)
    except Unreadable as fault:
        ignore(fault)
        return []


def rates(velocities: Usd.Attribute, accelerations: Usd.Attribute, context: FrameContext) -> dict[str, RawSamples]:
    """The translator's names of what may carry an array; {} where nothing is authored or the shutter is
    closed."""
    if not context.shutter.moving or not velocities.HasAuthoredValue():
        return {}
    keywords = {"velocities": optional_samples(velocities, context, needs_times=True)}
    if accelerations.HasAuthoredValue():
        keywords["accelerations"] = optional_samples(accelerations, context, needs_times=True)
    return {name: samples for name, samples in keywords.items() if samples} if keywords["velocities"] else {}


def rate_times(context: FrameContext, velocity_scale: float) -> dict[str, float]:
    """The translator's names of what turns rates into positions."""
    if not context.shutter.moving:
        return {}
    return {
        "frame01": context.shutter.frame01_unclamped,
        "seconds_per_shutter": context.seconds_per_shutter,
        "velocity_scale": velocity_scale,
    }


def carries_still_pose(attributes: list[Usd.Attribute], context: FrameContext) -> bool:
    """Whether velocities may carry the pose of a frame without blur: from the samples of such attributes before it,
    which values that are interpolated do not show. USD's own computation has it then."""
    frame = context.shutter.frame
    if context.shutter.moving or frame is None:
        return False
    around = [each.GetBracketingTimeSamples(frame) for each in attributes if each.GetNumTimeSamples()]
    return any(times and times[0] != frame for times in around)


def sample_points(
    shape: UsdGeom.PointBased, context: FrameContext, has_velocities: bool
) -> tuple[Samples, dict[str, RawSamples]]:
    """The points of a mesh, and the translator's names of its velocities and accelerations."""
    carried_by: dict[str, RawSamples] = {}
    if has_velocities and carries_still_pose([shape.GetVelocitiesAttr()], context):
        twin = typed_twin(shape.GetPrim(), context.code)
        pose = UsdGeom.PointBased(twin.prim).ComputePointsAtTime(context.code, context.code)
        return Samples([(None, array(pose, np.float32, 3))], context.held), {}
    if has_velocities:
        carried_by = rates(shape.GetVelocitiesAttr(), shape.GetAccelerationsAttr(), context)
    values = raw_samples(shape.GetPointsAttr(), context, needs_times=bool(carried_by))
    empty = np.zeros((0, 3), np.float32)
    return Samples(values or [(None, empty)], context.held), carried_by


def changes(attribute: Usd.Attribute, context: FrameContext) -> bool:
    """Whether an int[] attribute takes more than one value within the shutter. Compares values, not sample
    counts."""
    if not context.shutter.moving or not might_vary(attribute):
        return False
    # Integers are held until the next sample: the one after the shutter says nothing.
    interval = context.shutter.interval
    values = [raw(attribute, t) for t in bracketing_times(attribute, context.shutter) if t <= interval.max]
    return any(value != values[0] for value in values[1:])
