"""Time: the open shutter, and the times at which a stage is evaluated over it.

`time01` is a time relative to the shutter: 0 at its opening, 1 at its closing. Samples that bracket the
shutter lie outside [0, 1].
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from pxr import Gf, Usd, UsdGeom

from .errors import Diagnostics

ABSURD_SHUTTER_FRAMES = 16.0
"""A shutter that is open for longer is taken as authored, with a warning: one exporter writes the length of
the shot."""

FINEST_LEVEL = 7
"""2^7 intervals: the most segments a track has."""

JUMP_TIME01 = 1e-6
"""How long before a change at once its last old value is sampled: half the translator's kJumpTime01."""


@dataclass(frozen=True)
class Shutter:
    """The open shutter of a frame."""

    frame: float | None
    """Time code; None: USD's default time, where nothing moves."""
    open: float = 0.0
    """Frames (time codes) relative to `frame`."""
    close: float = 0.0

    @property
    def moving(self) -> bool:
        """Whether it is open for any time at all."""
        return self.frame is not None and self.close > self.open

    @property
    def frame_code(self) -> Usd.TimeCode:
        """Where everything is read that is not sampled over the shutter."""
        return Usd.TimeCode.Default() if self.frame is None else Usd.TimeCode(self.frame)

    @property
    def frame01_unclamped(self) -> float:
        """The frame's time, which may lie outside of the shutter; 0 where nothing moves."""
        return self.time01(self.frame) if self.moving else 0.0

    @property
    def frame01(self) -> float:
        """The frame's time, or the shutter's end that is next to it; 0 where nothing moves."""
        return min(max(self.time01(self.frame), 0.0), 1.0) if self.moving else 0.0

    @property
    def interval(self) -> Gf.Interval:
        """The open shutter in time codes. Only for a moving one."""
        return Gf.Interval(self.frame + self.open, self.frame + self.close)

    def scaled(self, scale: float) -> Shutter:
        """The window of a prim with that motion:blurScale: scaled about the frame (UsdGeomMotionAPI)."""
        return self if scale == 1.0 or not self.moving else replace(self, open=scale * self.open, close=scale * self.close)

    def time_code(self, time01: float) -> Usd.TimeCode:
        """The stage's time at `time01`; a closed shutter has the frame's alone."""
        if not self.moving:
            return self.frame_code
        return Usd.TimeCode(self.frame + (1.0 - time01) * self.open + time01 * self.close)

    def time01(self, time: float) -> float:
        """Of a time code. Only for a moving shutter."""
        return (time - (self.frame + self.open)) / (self.close - self.open)


SHUTTER_HINT = "--shutter -0.25:0.25 opens it"


def checked_shutter(
    frame: float | None, open_frames: float, close_frames: float, camera: str, diagnostics: Diagnostics
) -> Shutter:
    """The shutter that a camera asks for, closed where that makes no sense. Says what it decided and why."""
    closed = Shutter(frame)
    if frame is None:
        diagnostics.note("", "", "rendered at USD's default time: no motion blur")
        return closed
    if not (math.isfinite(open_frames) and math.isfinite(close_frames)):
        found = f"found {open_frames:g} to {close_frames:g}, expected finite numbers"
        diagnostics.warning(camera, "shutter:open, shutter:close", f"{found}; no motion blur")
        return closed
    if close_frames < open_frames:
        found = f"found {close_frames:g}, before shutter:open at {open_frames:g}, expected a later time"
        diagnostics.warning(camera, "shutter:close", f"{found}; no motion blur")
        return closed
    if close_frames == open_frames:
        message = f"equals shutter:open, {open_frames:g}: no motion blur; {SHUTTER_HINT}"
        diagnostics.note(camera, "shutter:close", message)
        return closed
    _warn_of_absurd_length(close_frames - open_frames, (camera, "shutter:close"), "as authored", diagnostics)
    return Shutter(frame, open_frames, close_frames)


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


def _warn_of_absurd_length(
    length: float, subject: tuple[str, str], rendered: str, diagnostics: Diagnostics
) -> None:
    if length > ABSURD_SHUTTER_FRAMES:
        found = f"the shutter is open for {length:g} frames, expected about one"
        diagnostics.warning(*subject, f"{found}; rendered {rendered}")


class TimeGrid:
    """Nested sets of times over the shutter: 2^level even intervals, and the times that are authored within
    it.

    With the authored times, motion that is linear between them is caught exactly; the even ones catch curves.
    """

    def __init__(self, shutter: Shutter, authored: Iterable[float] = (), held: bool = False) -> None:
        """`authored` are time codes, in any order. `held`: values jump at them, so the instants before count
        too."""
        self.shutter = shutter
        self._authored: list[float] = []
        self._levels: dict[int, list[float]] = {}
        if shutter.moving:
            inside = sorted({shutter.time01(time) for time in authored if shutter.interval.Contains(time)})
            jumps = [time - JUMP_TIME01 for time in inside if held and time > JUMP_TIME01]
            if len(inside) <= 2**FINEST_LEVEL:
                self._authored = inside + jumps

    @property
    def bends01(self) -> list[float]:
        """The authored times, on a held stage with the instants before them."""
        return sorted(self._authored)

    def times01(self, level: int) -> list[float]:
        """Increasing, from 0 to 1; [0] alone for a closed shutter. Levels nest."""
        if not self.shutter.moving:
            return [0.0]
        if level not in self._levels:
            even = np.linspace(0.0, 1.0, 2**level + 1)
            # Authored times that differ from an even one by rounding alone would make intervals of no length.
            distant = (time for time in self._authored if np.min(np.abs(even - time)) > 1e-9)
            self._levels[level] = sorted({*even.tolist(), *distant})
        return self._levels[level]


def is_held(stage: Usd.Stage) -> bool:
    """Whether values jump from sample to sample instead of being interpolated."""
    return stage.GetInterpolationType() == Usd.InterpolationTypeHeld


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
        *attribute.GetBracketingTimeSamples(first)[:1],
        *attribute.GetBracketingTimeSamples(shutter.frame),
        *attribute.GetBracketingTimeSamples(shutter.frame + Usd.TimeCode.SafeStep())[1:],
        *attribute.GetBracketingTimeSamples(last)[1:],
    }
    if len(around) < 2:
        return sorted(around)
    return sorted(around.union(attribute.GetTimeSamplesInInterval(Gf.Interval(min(around), max(around)))))


def sample_times(attributes: Iterable[Usd.Attribute], shutter: Shutter) -> list[float]:
    """Time codes that say all about how several attributes move together over the shutter; [] where they do
    not.

    The union of their bracketing samples; many even ones for splines and where there are more samples than a
    track has keys.
    """
    varying = [attribute for attribute in attributes if attribute.ValueMightBeTimeVarying()]
    if not shutter.moving or not varying:
        return []
    authored = [bracketing_times(attribute, shutter) for attribute in varying]
    times = sorted(set().union(*authored))
    if all(authored) and len(times) <= 2**FINEST_LEVEL + 4:
        return times
    return [
        shutter.time_code(time).GetValue() for time in np.linspace(0.0, 1.0, 2**FINEST_LEVEL + 1).tolist()
    ]


def xform_bends(xformable: UsdGeom.Xformable, shutter: Shutter) -> list[float]:
    """Time codes inside the shutter at which a transform may change its course: its ops' samples and the knots
    of their splines."""
    times: list[float] = []
    for op in xformable.GetOrderedXformOps():
        times.extend(_bends_of(op.GetAttr(), shutter))
    return times


STEP01 = 4e-8
"""How long before a jump its last old value is sampled: less than a ray's time can tell apart (kTimeResolution in
delegate/translate/time_layout.h), which makes the two a jump."""


def _bends_of(attribute: Usd.Attribute, shutter: Shutter) -> list[float]:
    """Samples or knots inside the shutter, and the instants before values that come at once: held or two-valued
    knots, blocks."""
    step = STEP01 * (shutter.close - shutter.open)
    if attribute.HasSpline():
        spline = attribute.GetSpline()
        inside = [time for time in spline.GetKnots().keys() if shutter.interval.Contains(time)]
        jumps = [time for time in inside if spline.EvalPreValue(time) != spline.Eval(time)]
        return [*inside, *(time - step for time in jumps)]
    inside = list(attribute.GetTimeSamplesInInterval(shutter.interval))
    if not inside or all(attribute.Get(time) is not None for time in (shutter.interval.min, *inside)):
        return inside
    return [*inside, *(time - step for time in inside)]
