"""A frame's pixels, with as many samples as are asked for: by number, by the noise of each, by a goal, or by a time."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ..base.progress import Progress
from ..output.denoise import AUXILIARIES, denoised
from ..output.stats import FrameStats
from .budget import Goals, Outcome, render_within
from .film import Film
from .frame_layers import weighted
from .sample_sum import DEPTH, needs_depth

MOST_SLICES_OF_NOISE = 16
"""Of the shutter, where pixels stop at multiples of this many samples: a block of core/film/sum_tree.h."""
SLICES_ARE_EVEN = (
    f"each slice has as many samples, and pixels stop at multiples of {MOST_SLICES_OF_NOISE};"
    f" expected at most {MOST_SLICES_OF_NOISE} slices"
)
LEAST_SECONDS = 1e-3
"""Of a time limit that is over before the first sample: a block of them is taken all the same."""


@dataclass(frozen=True)
class Wanted:
    """What is asked for of a frame's samples."""

    spp: int
    goals: Goals
    time_limit: float | None
    film: Film
    aovs: tuple[str, ...]
    """That are rendered."""
    noise: float = 0.0
    """That a pixel may keep; 0: all take as many samples."""


def clash_with_noise(goals: Goals, film: Film) -> str | None:
    """Why the noise of each pixel cannot decide how many samples it has, nor a time limit."""
    if goals.decide_samples:
        return "--target-flip and --time-budget decide the samples"
    return SLICES_ARE_EVEN if film.shutter_slices > MOST_SLICES_OF_NOISE else None


def rendered_aovs(aovs: Sequence[str], goals: Goals, denoise: bool) -> tuple[str, ...]:
    """Those that are asked for, and what else is needed: ranges of samples, of which a budget makes a picture, need to know
    whose sample is nearest."""
    needed = AUXILIARIES if denoise else ()
    if goals.decide_samples and needs_depth(aovs):
        needed = (*needed, DEPTH)
    return tuple(dict.fromkeys((*aovs, *needed)))


def traced(renderer: Any, wanted: Wanted, ends: float, stats: FrameStats, label: str) -> Outcome:
    """`ends`: time.perf_counter() when the last sample has to be there, where a goal or the time limit asks for that."""
    with stats.timed("trace"), Progress(f"msbvh: {label}") as progress:
        if wanted.goals.decide_samples:
            outcome = render_within(renderer, wanted.goals, ends, progress, wanted.aovs)
        else:
            seconds = None if wanted.time_limit is None else max(ends - time.perf_counter(), LEAST_SECONDS)
            pixels, aovs, slices = renderer.render_sliced(progress, seconds)
            pixels = weighted(pixels, slices, wanted.film)
            outcome = Outcome(pixels, aovs, renderer.statistics["spp"], None, {}, slices)
    stats.render = {**renderer.statistics, **outcome.statistics, "spp": outcome.samples}
    return outcome


def time_limit_note(wanted: Wanted, samples: int) -> str | None:
    """What is to be said where the time was over before all samples were taken."""
    if wanted.time_limit is None or samples >= wanted.spp:
        return None
    if wanted.noise > 0.0:
        return (
            f"--time-limit {wanted.time_limit:g}: at most {samples} samples a pixel;"
            f" the same --noise with --spp {samples} renders the same picture"
        )
    return f"--time-limit {wanted.time_limit:g}: stopped at {samples} samples a pixel; --spp {samples} renders the same picture"


def with_denoised(outcome: Outcome, stats: FrameStats) -> Any:
    """The picture without most of its noise, float32[height, width, 4]. Raises SceneError."""
    with stats.timed("denoise"):
        return denoised(outcome.pixels, *(outcome.aovs[name] for name in AUXILIARIES))
