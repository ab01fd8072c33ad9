"""A blur budget: the cheapest settings that keep an error or a time, found, rendered, and held to it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ..render.budget import AIM, FLIP_SLOPE, MOST_SAMPLES, SLACK, Goals, grown
from .measure import Measurement
from .options import Options
from .points import Point
from .sweep import Axis

ATTEMPTS = 4
NOISE_UNIT = "FLIP of noise"


@dataclass(frozen=True)
class Target:
    """A goal, and what came of it."""

    asked: str
    unit: str
    found: float | None
    holds: bool
    says: str
    id: str | None

    def plain(self) -> dict[str, Any]:
        return dict(vars(self))


def aim(
    goals: Goals,
    base: Options,
    axes: Sequence[Axis],
    measurement: Measurement,
    judge: Callable[[Options], Point],
) -> list[Target]:
    """Picks settings for each goal, renders with them and says whether it holds."""
    search = _Search(base, axes, measurement, judge)
    found = []
    if goals.error_px is not None:
        found.append(search.error_px(goals.error_px))
    if goals.flip is not None:
        found.append(search.flip(goals.flip))
    if goals.seconds is not None:
        found.append(search.seconds(goals.seconds))
    return found


class _Search:
    def __init__(
        self,
        base: Options,
        axes: Sequence[Axis],
        measurement: Measurement,
        judge: Callable[[Options], Point],
    ) -> None:
        self._base = base
        self._axes = {axis.knob.option: axis for axis in axes}
        self._measurement = measurement
        self._judge = judge

    def error_px(self, wanted: float) -> Target:
        """The tolerance is a promise for each prim; edges and complexity are found as `record` finds them."""
        asked = f"--target-error {wanted:g}px"
        options = self._measurement.shapes.fine_enough(wanted).over(self._base.without("segments"))
        point = self._judge(options)
        if point.failed:
            return _failed(asked, "px", point)
        shapes = self._measurement.shapes.by_prim(options)
        errors = {"motion": point.motion_px, "shape": point.shape_px or 0.0}
        worst = max(errors, key=lambda kind: errors[kind])
        holds = errors[worst] <= wanted * SLACK
        says = f"{options.beside(self._base).text() or 'the base settings'}, where {worst} errs most"
        unknown = [path for path, error in shapes.items() if error is None]
        if unknown:
            says += f"; the shape of {len(unknown)} prims was not measured, {unknown[0]} first"
        return Target(asked, "px", errors[worst], holds, says, point.id)

    def flip(self, wanted: float) -> Target:
        """Samples until their noise looks no worse; fewer where they can be spared."""
        tried: dict[int, Point] = {}
        samples = int(self._base.get("spp", 16))
        for options in self._by_samples():
            point = self._measurement.points[options]
            if point.error is not None:
                tried[int(options.get("spp", 16))] = point
        for _ in range(ATTEMPTS):
            samples = _next_samples({n: self._flip(point) for n, point in tried.items()}, wanted, samples)
            if samples in tried:
                break
            point = self._judge(Options.of({"spp": samples}).over(self._base))
            if point.failed:
                return _failed(f"--target-flip {wanted:g}", "FLIP", point)
            tried[samples] = point
            if wanted / SLACK <= self._flip(point) <= wanted:
                break
        holding = [n for n, point in tried.items() if self._flip(point) <= wanted * SLACK]
        best = min(holding) if holding else max(tried)
        point = tried[best]
        says = f"--spp {best}"
        if point.error is not None:
            says += f" (the whole picture beside the reference: {point.error.flip:.3g})"
        bias = self._bias(point)
        if bias > wanted * SLACK:
            says += f"; {bias:.3g} of motion, shape or path depth stands out of the noise, which no sample mends"
            return Target(f"--target-flip {wanted:g}", "FLIP", bias, False, says, point.id)
        return Target(f"--target-flip {wanted:g}", NOISE_UNIT, self._flip(point), bool(holding), says, point.id)

    def _flip(self, point: Point) -> float:
        return self._measurement.noise_flip(point.options)

    def _bias(self, point: Point) -> float:
        """The largest FLIP of one kind of error of the base settings alone, of those that stand out of a point's noise."""
        noise = point.error.noise_relative_mse if point.error is not None else 0.0
        kinds = self._measurement.points[self._base].kinds.values()
        return max((found.flip for found in kinds if found.relative_mse > noise), default=0.0)

    def _by_samples(self) -> Iterator[Options]:
        yield self._base
        axis = self._axes.get("spp")
        for step in axis.steps() if axis else ():
            if step.options in self._measurement.points:
                yield step.options

    def seconds(self, wanted: float) -> Target:
        """The settings with the least error of those that were measured to fit, with as many samples as then fit."""
        asked = f"--time-budget {wanted:g}s"
        fitting = [
            point
            for point in self._measurement.points.values()
            if point.error is not None and point.frame_seconds <= wanted and "frames" not in point.options.plain()
        ]
        if not fitting:
            least = min(point.frame_seconds for point in self._measurement.points.values() if point.runs)
            return Target(
                asked, "s", least, False, f"no settings fit: the cheapest that were tried take {least:.3g} s", None
            )
        best = min(fitting, key=lambda point: point.error.relative_mse if point.error else math.inf)
        for _ in range(ATTEMPTS):
            if "noise" in best.options.plain():
                break  # It decides the samples.
            samples = _samples_in(best, wanted)
            if samples <= int(best.options.get("spp", 16)):
                break
            point = self._judge(Options.of({"spp": samples}).over(best.options))
            if point.failed or point.frame_seconds > wanted * SLACK:
                break
            best = point
            if best.frame_seconds >= wanted / SLACK:
                break
        says = best.options.beside(self._base).text() or "the base settings"
        holds = best.frame_seconds <= wanted * SLACK
        return Target(asked, "s", best.frame_seconds, holds, says, best.id)


def _failed(asked: str, unit: str, point: Point) -> Target:
    return Target(asked, unit, None, False, point.failed, point.id)


def _next_samples(found: Mapping[int, float], wanted: float, start: int) -> int:
    """By how FLIP has fallen between the two counts next to what is wanted, as a power of the samples."""
    known = sorted((n, error) for n, error in found.items() if 0.0 < error < math.inf)
    if not known:
        return start
    nearest = sorted(known, key=lambda pair: abs(math.log(pair[1] / wanted)))[:2]
    slope = FLIP_SLOPE
    if len(nearest) == 2 and nearest[0][0] != nearest[1][0]:
        (n0, e0), (n1, e1) = nearest
        slope = max(-math.log(e1 / e0) / math.log(n1 / n0), 0.1)
    samples, error = nearest[0]
    return max(1, min(grown(samples, error / (AIM * wanted), slope), MOST_SAMPLES))


def _samples_in(point: Point, seconds: float) -> int:
    """As many as a frame's time has room for, if tracing grows with them and nothing else does."""
    samples = int(point.options.get("spp", 16))
    trace = sorted(point.seconds("trace"))[len(point.runs) // 2]
    rest = point.frame_seconds - trace
    return min(MOST_SAMPLES, math.floor(samples * max(seconds * 0.95 - rest, 0.0) / max(trace, 1e-6)))
