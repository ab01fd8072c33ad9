"""A blur budget: as many samples as keep an error, or as a time has room for.

How far a picture is from a converged one can be told without one: of two halves A and B that share no noise, with the mean M,
the error of M is distributed as (A - B) / 2 is, which is how far A is from M. So FLIP between A and M stands for FLIP between M
and the converged picture. (Halves of one low-discrepancy sequence are a little further apart than M is from the truth: what is
promised is rather too much than too little.) What no sample mends is not in it: the motion model and shapes are --target-error's.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..output.flip import flip_map
from .sample_sum import SampleSum

SLACK = 1.1
"""A budget is kept within 10 %."""
FIRST_SAMPLES = 8
FIRST_IN_TIME = 2
"""Of a pilot, and where time is short; even numbers."""
MOST_SAMPLES = 65536
MOST_GROWTH = 4
"""Samples grow by no more at once: how the error falls is known only for as far as it was seen."""
FLIP_SLOPE = 0.4
"""FLIP falls about as this power of the samples, until the frame itself has shown how."""
AIM = 0.97
"""Of what is wanted: a little below, so that noise in the measure does not lift it above."""


WRITING = 2e-7
"""Seconds a pixel and file: about what a compressed image takes."""


def writing_seconds(pixels: int, files: int) -> float:
    """About what it takes to write a frame."""
    return WRITING * pixels * files


@dataclass(frozen=True)
class Goals:
    """What is asked for; None: it is not."""

    error_px: float | None = None
    """Of motion and shape, each prim's largest."""
    flip: float | None = None
    """Mean HDR-FLIP."""
    seconds: float | None = None
    """Of a frame, from its reading to its file."""

    @property
    def any(self) -> bool:
        return self != Goals()

    @property
    def decide_samples(self) -> bool:
        return self.flip is not None or self.seconds is not None


COUNTED = ("rays", "rays_in_packets", "rays_interleaved", "rays_single", "camera_rays", "trace_seconds")
"""Of _core.RenderStatistics: what each range of samples adds to."""


@dataclass(frozen=True)
class Outcome:
    """A frame that kept its budget, or did not."""

    pixels: np.ndarray
    aovs: Mapping[str, np.ndarray]
    samples: int
    flip: float | None
    """None: nobody asked."""
    statistics: Mapping[str, float]
    """COUNTED, summed over all ranges of samples."""
    slices: np.ndarray | None = None
    """Of the shutter, float32[count, height, width, 4]; none where no samples but settings' own were rendered."""

    def misses(self, goals: Goals, frame_seconds: float) -> list[str]:
        """What is not kept, in words."""
        found = []
        if goals.flip is not None and self.flip is not None and self.flip > goals.flip * SLACK:
            found.append(f"--target-flip {goals.flip:g}: found {self.flip:.3g} with {self.samples} samples a pixel")
        if goals.seconds is not None and frame_seconds > goals.seconds * SLACK:
            found.append(f"--time-budget {goals.seconds:g}s: the frame took {frame_seconds:.3g} s")
        return found


def render_within(
    renderer: Any,
    goals: Goals,
    ends: float,
    progress: Callable[[float], object],
    aovs: tuple[str, ...] = (),
) -> Outcome:
    """Renders with as many samples as the goals ask for. `ends`: time.perf_counter() when the last sample has to be there, if
    there is a goal for the time."""
    return _Rendering(renderer, goals, ends, progress, aovs).run()


class _Rendering:
    def __init__(
        self, renderer: Any, goals: Goals, ends: float, progress: Callable[[float], object], aovs: tuple[str, ...]
    ) -> None:
        self._renderer = renderer
        self._goals = goals
        self._ends = ends
        self._progress = progress
        self._halves = (SampleSum(aovs), SampleSum(aovs))
        self._samples = 0
        self._seen: list[tuple[int, float]] = []
        """Samples, and FLIP with so many."""
        self._statistics: dict[str, float] = dict.fromkeys(COUNTED, 0)
        self._seconds = 0.0
        """Of all ranges, with what judging them takes."""
        self._share = 0.0

    def run(self) -> Outcome:
        more = FIRST_SAMPLES if self._goals.seconds is None else FIRST_IN_TIME
        while more > 0:
            self._add(more)
            more = self._more()
        self._progress(1.0)
        whole = SampleSum.merged(self._halves)
        flip = self._seen[-1][1] if self._seen else None
        return Outcome(whole.pixels, whole.aovs, self._samples, flip, self._statistics)

    def _add(self, count: int) -> None:
        """Adds samples, half of them to each half."""
        begin = time.perf_counter()
        for half in self._halves:
            low, step = self._share, (1.0 - self._share) * 0.4
            said = lambda share, low=low, step=step: self._progress(low + step * share)  # noqa: E731
            pixels, aovs = self._renderer.render_samples(self._samples, count // 2, said)
            half.add(count // 2, pixels, aovs)
            self._samples += count // 2
            found = self._renderer.statistics
            self._statistics = {name: value + found[name] for name, value in self._statistics.items()}
            self._share = low + step
        if self._goals.flip is not None:
            self._seen.append((self._samples, self._flip()))
        self._seconds += time.perf_counter() - begin

    def _flip(self) -> float:
        whole = SampleSum.merged(self._halves).pixels[..., :3]
        return float(np.mean([flip_map(whole, half.pixels[..., :3]).mean() for half in self._halves]))

    def _more(self) -> int:
        """Samples that are still wanted; an even number."""
        wanted = min(self._by_flip(), self._by_time(), MOST_SAMPLES - self._samples)
        return max(0, int(wanted) // 2 * 2)

    def _by_flip(self) -> float:
        if self._goals.flip is None:
            return math.inf
        samples, error = self._seen[-1]
        if error <= self._goals.flip:
            return 0
        slope = FLIP_SLOPE
        if len(self._seen) > 1:
            (n0, e0), (n1, e1) = self._seen[-2:]
            slope = min(max(math.log(e0 / e1) / math.log(n1 / n0), 0.15), 1.0) if e1 > 0.0 else slope
        return max(2, grown(samples, error / (AIM * self._goals.flip), slope) + 1 - samples)

    def _by_time(self) -> float:
        """As many as fit. Half of the room is left at first: the pilot's rate is only roughly that of the rest."""
        if self._goals.seconds is None:
            return math.inf
        rate = self._seconds / self._samples
        room = self._ends - time.perf_counter()
        share = 0.5 if self._samples == FIRST_IN_TIME else 1.0
        fitting = max(share * room / rate, min(room / rate, 2.0))
        # What is left after the second step is a rest that is not worth a third look.
        return fitting if fitting >= 0.03 * self._samples else 0


def grown(samples: int, factor: float, slope: float) -> int:
    """As many samples as divide an error by a factor that falls as a power of them; no more than are known to do so."""
    return math.ceil(samples * math.exp(min(math.log(factor) / slope, math.log(MOST_GROWTH))))
