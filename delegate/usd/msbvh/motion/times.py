"""Time: the open shutter, and the times at which a stage is evaluated over it.

`time01` is a time relative to the shutter: 0 at its opening, 1 at its closing. Samples that bracket the
shutter lie outside [0, 1].
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from pxr import Gf, Ts, Usd, UsdGeom

from .. import _core
from .._core import ABSURD_SHUTTER_FRAMES, FINEST_LEVEL, even_times01
from ..base.errors import Diagnostics
from ..stage.values import might_vary, raw
from .xform_ops import ordered_ops


@dataclass(frozen=True)
class Shutter:
    """The open shutter of a frame."""

    frame: float | None
    """Time code; None: USD's default time, where nothing moves."""
    open: float = 0.0
    """Frames (time codes) relative to `frame`."""
    close: float = 0.0

    @cached_property
    def moving(self) -> bool:
        """Whether it is open for any time at all."""
        return self.frame is not None and self.close > self.open

    @cached_property
    def frame_code(self) -> Usd.TimeCode:
        """Where everything is read that is not sampled over the shutter."""
        return Usd.TimeCode.Default() if self.frame is None else Usd.TimeCode(self.frame)

    @property
    def frame_number(self) -> float:
        """The frame's time code. Only for a frame that has one."""
        assert self.frame is not None
        return self.frame

    @cached_property
    def frame01_unclamped(self) -> float:
        """The frame's time, which may lie outside of the shutter; 0 where nothing moves."""
        return self.time01(self.frame_number) if self.moving else 0.0

    @property
    def frame01(self) -> float:
        """The frame's time, or the shutter's end that is next to it; 0 where nothing moves."""
        return min(max(self.time01(self.frame_number), 0.0), 1.0) if self.moving else 0.0

    @cached_property
    def interval(self) -> Gf.Interval:
        """The open shutter in time codes. Only for a moving one."""
        return Gf.Interval(self.frame_number + self.open, self.frame_number + self.close)

    def scaled(self, scale: float) -> Shutter:
        """The window of a prim with that motion:blurScale: scaled about the frame (UsdGeomMotionAPI)."""
        return (
            self if scale == 1.0 or not self.moving else replace(self, open=scale * self.open, close=scale * self.close)
        )

    def time_code(self, time01: float) -> Usd.TimeCode:
        """The stage's time at `time01`; a closed shutter has the frame's alone."""
        if not self.moving:
            return self.frame_code
        return Usd.TimeCode(self.frame_number + (1.0 - time01) * self.open + time01 * self.close)

    def time01(self, time: float) -> float:
        """Of a time code. Only for a moving shutter."""
        return (time - (self.frame_number + self.open)) / (self.close - self.open)


SHUTTER_HINT = "--shutter -0.25:0.25 opens it"


def checked_shutter(
    frame: float | None, open_frames: float, close_frames: float, camera: str, diagnostics: Diagnostics
) -> Shutter:
    """The shutter that a camera asks for, closed where that makes no sense. Says what it decided and why."""
    if frame is None:
        diagnostics.note("", "", "rendered at USD's default time: no motion blur")
        return Shutter(frame)
    (opening, closing), said = _core.checked_shutter(open_frames, close_frames, camera, SHUTTER_HINT)
    diagnostics.take(said)
    return Shutter(frame, opening, closing)


def asked_shutter(frame: float, asked: tuple[float, float], diagnostics: Diagnostics) -> Shutter:
    """The shutter of --shutter, held to the same rules as a camera's. The option has refused one that closes before
    it opens."""
    open_frames, close_frames = asked
    if not math.isfinite(close_frames - open_frames):
        found = f"found {open_frames:g} to {close_frames:g}, expected finite numbers"
        diagnostics.warning("", "--shutter", f"{found}; no motion blur")
        return Shutter(frame)
    if close_frames == open_frames:
        message = f"closes where it opens, at {open_frames:g}: no motion blur"
        diagnostics.note("", "--shutter", message)
        return Shutter(frame)
    _warn_of_absurd_length(close_frames - open_frames, ("", "--shutter"), "as asked", diagnostics)
    return Shutter(frame, open_frames, close_frames)


def _warn_of_absurd_length(length: float, subject: tuple[str, str], rendered: str, diagnostics: Diagnostics) -> None:
    if length > ABSURD_SHUTTER_FRAMES:
        found = f"the shutter is open for {length:g} frames, expected about one"
        diagnostics.warning(*subject, f"{found}; rendered {rendered}")


def is_held(stage: Usd.Stage) -> bool:
    """Whether values jump from sample to sample instead of being interpolated."""
    return stage.GetInterpolationType() == Usd.InterpolationTypeHeld


def _bracketing(attribute: Usd.Attribute, time: float) -> tuple[float, ...]:
    return attribute.GetBracketingTimeSamples(time) or ()  # None: for times that are NaN, among others.


def bracketing_times(attribute: Usd.Attribute, shutter: Shutter) -> list[float]:
    """The authored times of an attribute inside the open shutter and at the frame, and the ones next to them,
    increasing, as time codes.

    Between them USD interpolates linearly, so they say everything; velocities carry values from the sample at
    or before the frame, if they and the values agree in the sample behind the frame as well, which counts
    where the shutter closes before it, too. Empty where nothing is authored or a spline drives the attribute:
    those have no samples (OpenUSD #3765).
    """
    first, last = shutter.interval.min, shutter.interval.max
    around = {
        *_bracketing(attribute, first)[:1],
        *_bracketing(attribute, shutter.frame_number),
        *_bracketing(attribute, shutter.frame_number + Usd.TimeCode.SafeStep())[1:],
        *_bracketing(attribute, last)[1:],
    }
    if len(around) < 2:
        return sorted(around)
    return sorted(around.union(attribute.GetTimeSamplesInInterval(Gf.Interval(min(around), max(around)))))


def sample_times(attributes: Iterable[Usd.Attribute], shutter: Shutter) -> list[float]:
    """Time codes that say all about how several attributes move together over the shutter; [] where they do
    not.

    The union of their bracketing samples, and many even times for splines.
    """
    varying = [attribute for attribute in attributes if might_vary(attribute)]
    if not shutter.moving or not varying:
        return []
    times: set[float] = set()
    for attribute in varying:
        if attribute.HasSpline():
            breakpoints01 = [shutter.time01(time) for time in breakpoints_of(attribute, shutter)]
            even = even_times01(FINEST_LEVEL, breakpoints01)
            times.update(shutter.time_code(time01).GetValue() for time01 in even)
        else:
            times.update(bracketing_times(attribute, shutter))
    return sorted(times)


MOST_VALUES = 2**26
"""Of an array that are held at all its times together, 800 MB of points."""
FEWEST_THINNED = 2**FINEST_LEVEL + 4
"""So many times of an array are read, however large it is."""


def thinned(times: list[float], size: int) -> list[float]:
    """As many of an array's sample times, evenly picked, as its size allows to hold."""
    most = max(FEWEST_THINNED, MOST_VALUES // max(size, 1))
    if len(times) <= most:
        return times
    return [times[index] for index in np.linspace(0, len(times) - 1, most).round().astype(int).tolist()]


def xform_breakpoints(xformable: UsdGeom.Xformable, shutter: Shutter) -> list[float]:
    """Time codes inside the shutter at which a transform may change its course: its ops' samples and the knots
    of their splines."""
    times: list[float] = []
    for op in ordered_ops(xformable):
        times.extend(_op_breakpoints(op.GetAttr(), shutter))
    return times


STEP01 = 4e-8
"""How long before a jump its last old value is sampled: less than a ray's time can tell apart (kTimeResolution in
delegate/translate/time_layout.h), which makes the two a jump."""

MOST_KNOTS = 2**12
"""A spline whose loops make more knots than this inside the shutter is sampled as if it had none there."""


def _knots(spline: Ts.Spline, shutter: Shutter) -> list[Ts.Knot]:
    """A spline's knots, in and around the shutter those that its loops repeat included."""
    knots = spline.GetKnots()
    length = shutter.close - shutter.open
    if spline.HasLoops() and len(knots) > 1 and len(knots) * length <= MOST_KNOTS * loop_length(spline):
        knots = spline.GetKnotsWithLoopsBaked(shutter.interval)
    return list(knots.values())


def _jumps(knots: list[Ts.Knot]) -> list[float]:
    """Time codes of the knots at which the value comes at once."""
    still = (Ts.InterpHeld, Ts.InterpValueBlock)
    times = []
    for before, knot in pairwise(knots):
        held = before.GetNextInterpolation() in still
        reached = before.GetValue() if held else knot.GetPreValue() if knot.IsDualValued() else knot.GetValue()
        if reached != knot.GetValue():
            times.append(knot.GetTime())
    return times


def loop_length(spline: Ts.Spline) -> float:
    """Time codes after which a looping spline repeats, the shorter of its loops; infinite where it has none."""
    lengths = []
    if spline.HasInnerLoops():
        loop = spline.GetInnerLoopParams()
        lengths.append(loop.protoEnd - loop.protoStart)
    if spline.HasExtrapolatingLoops():
        knots = list(spline.GetKnots().keys())
        modes = {spline.GetPreExtrapolation().mode, spline.GetPostExtrapolation().mode}
        there_and_back = Ts.ExtrapLoopOscillate in modes
        lengths.append((knots[-1] - knots[0]) * (2.0 if there_and_back else 1.0))
    return min((length for length in lengths if length > 0.0), default=math.inf)


def breakpoints_of(attribute: Usd.Attribute, shutter: Shutter) -> list[float]:
    """Time codes inside the shutter at which an attribute's value may change its course: samples or knots."""
    if attribute.HasSpline():
        knots = _knots(attribute.GetSpline(), shutter)
        return [knot.GetTime() for knot in knots if shutter.interval.Contains(knot.GetTime())]
    return list(attribute.GetTimeSamplesInInterval(shutter.interval))


def _op_breakpoints(attribute: Usd.Attribute, shutter: Shutter) -> list[float]:
    """Breakpoints, and the instants before values that come at once: held or two-valued knots, blocks."""
    step = STEP01 * (shutter.close - shutter.open)
    inside = breakpoints_of(attribute, shutter)
    if attribute.HasSpline():
        jumps = [time for time in _jumps(_knots(attribute.GetSpline(), shutter)) if shutter.interval.Contains(time)]
        return [*inside, *(time - step for time in jumps)]
    if not inside or all(raw(attribute, time) is not None for time in (shutter.interval.min, *inside)):
        return inside
    return [*inside, *(time - step for time in inside)]
