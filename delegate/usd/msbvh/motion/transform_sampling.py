"""How densely transforms are sampled over the shutter: as interpolation between the samples needs."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from .boxes import Box, corners_of
from .transforms import LARGEST, Motion
from .turns import Turns

SAMPLING_SHARE = 0.1
"""Of the tolerance: by how much interpolation between samples may stray from the stage. The rest is the track's."""
CUBIC_SPLIT = 2
"""From here on a stretch has the four samples that a cubic takes; lines before."""
FINEST_SPLIT = 12
"""The most often that a stretch between breakpoints is halved: 4096 samples."""
LARGEST_SAMPLES = 2**23
"""Matrices that are held at once, a gigabyte; beyond it sampling ends where it stands, and says so by its error."""
JUMP01 = 6e-8
"""Breakpoints within this of each other are a jump (kTimeResolution in delegate/translate/time_layout.h)."""
SAME_TIME01 = 1e-12
"""Times that are nearer are one: the translator's kSameTime."""
TIMES_A_TURN = 8
"""What is sampled so densely at least cannot pass for something slower, or for rest (turns.py)."""
_PROBE = 0.381966
"""Of a stretch: off the even places, for what is no turn and yet repeats."""


@dataclass(frozen=True)
class TransformSamples:
    """Some of a motion's things over the shutter, as the translator takes them."""

    indices: np.ndarray
    """int[M] among the motion's things."""
    times01: np.ndarray
    """float64[T]."""
    matrices: np.ndarray
    """float64[T, M, 4, 4]."""
    breakpoints01: np.ndarray
    """float64[B]: where the motion may change its course."""
    held: bool = False
    error_pixels: float = 0.0
    """By which interpolation between the samples may stray from the stage."""
    periods01: tuple[tuple[float, ...], ...] = ()
    """Of each thing, the shares of the shutter after which its motion may repeat; empty where none does."""
    usable: bool = True
    """False for those things of which a matrix is not finite or too large; nothing can be drawn there."""


PixelSizes = Callable[[np.ndarray], np.ndarray]
"""The smallest size of a pixel at boxes of float64[T, N, 8, 3] corners: float64[N]."""


def transform_samples(
    motion: Motion, boxes: list[Box], pixel_sizes: PixelSizes, tolerance_pixels: float, held: bool = False
) -> Iterator[TransformSamples]:
    """Samples matrices over the shutter until what is interpolated between them follows the stage within a share of
    the tolerance.

    Halves the stretches between breakpoints, for those things that need it. Every index comes once. `boxes` are those
    of the things, each in its own space; one: of each.
    """
    everything = np.arange(motion.count)
    breakpoints = np.array(motion.breakpoints01)
    if motion.still:
        yield from _by_use(TransformSamples(everything, np.zeros(1), motion.at_time(0.0)[None], breakpoints))
        return
    if held:
        times01 = np.array([0.0, *(time for time in motion.breakpoints01 if time > 0.0)])
        # In the middle of what holds: a time that is rounded might lie before its own sample.
        middles = (times01 + np.append(times01[1:], 1.0)) / 2
        yield from _by_use(
            TransformSamples(everything, times01, _evaluated(motion, middles, everything), breakpoints, True)
        )
        return
    local = corners_of(boxes)
    yield from _smooth_samples(motion, local, pixel_sizes, tolerance_pixels, breakpoints)


def _by_use(samples: TransformSamples) -> Iterator[TransformSamples]:
    """The usable things and the others apart; the one object where all are alike."""
    good = (np.abs(samples.matrices) <= LARGEST).all(axis=(0, 2, 3))
    if good.all():
        yield samples
        return
    for usable, chosen in ((True, good), (False, ~good)):
        if chosen.any():
            yield replace(
                samples,
                indices=samples.indices[chosen],
                matrices=samples.matrices[:, chosen],
                usable=usable,
            )


def _smooth_samples(
    motion: Motion, local: np.ndarray, pixel_sizes: PixelSizes, tolerance_pixels: float, breakpoints: np.ndarray
) -> Iterator[TransformSamples]:
    """`local` is float64[N, 8, 4], or float64[1, 8, 4] for all."""
    limit = SAMPLING_SHARE * tolerance_pixels
    ends = _distinct_ends(breakpoints)
    remaining = np.arange(motion.count)
    coarse = _evaluated(motion, ends, remaining)
    # No splitting would make a number of what is none.
    for samples in _by_use(TransformSamples(remaining, ends, coarse, breakpoints)):
        if samples.usable:
            remaining, coarse = samples.indices, samples.matrices
            local = local if len(local) == 1 else local[remaining]
            continue
        yield samples
        if len(samples.indices) == motion.count:
            return
    course = Course(ends)
    turns = motion.every_turns()
    needed = _needed_splits([turns[index] for index in remaining.tolist()], ends)
    probes = ends[:-1] + _PROBE * np.diff(ends)
    probed = _evaluated(motion, probes, remaining)
    first = min(int(needed.min()), FINEST_SPLIT - 1)
    if first > 0:
        coarse = _evaluated(motion, course.times01(first), remaining)
    for split in range(first, FINEST_SPLIT):
        times01 = course.times01(split + 1)
        fine = _refined(motion, course, split, coarse, remaining)
        corners = local @ fine[..., :3]
        size = pixel_sizes(corners)
        bent = course.strays(split, local @ coarse[..., :3], times01, corners) / size
        beside = course.strays(split + 1, corners, probes, local @ probed[..., :3]) / size
        if split == 0:
            good, kept_times, kept, error = np.maximum(bent, beside) <= limit, ends, coarse, bent
        else:
            # Halving the distance of a cubic's points divides its error by 16, of a line's by 4.
            gain = 4.0 if split < CUBIC_SPLIT else 8.0
            good = (bent <= gain * limit) & (beside <= limit) & (split > 1)
            kept_times, kept, error = times01, fine, bent / gain
        good &= needed <= split
        good |= split + 1 == FINEST_SPLIT or 2 * fine.size > 16 * LARGEST_SAMPLES
        if good.any():
            found = float(np.maximum(error, _missed(corners, needed > split) / size)[good].max())
            periods = tuple(turns[index].periods01 for index in remaining[good].tolist())
            yield TransformSamples(remaining[good], kept_times, kept[:, good], breakpoints, False, found, periods)
        if good.all():
            return
        remaining, coarse, probed, needed = remaining[~good], fine[:, ~good], probed[:, ~good], needed[~good]
        local = local if len(local) == 1 else local[~good]


def _needed_splits(turns: list[Turns], ends: np.ndarray) -> np.ndarray:
    """int[N]: how often the stretches between ends are to be halved for TIMES_A_TURN."""
    most = np.array([each.within(ends).max() for each in turns])
    return np.ceil(np.log2(np.maximum(TIMES_A_TURN * most, 1.0))).astype(int)


def _missed(corners: np.ndarray, too_fast: np.ndarray) -> np.ndarray:
    """float64[N]: by which float64[T, N, 8, 3] corners may be elsewhere than sampled, where a thing turns faster than it
    is sampled: as far as they ever are from each other."""
    reach = np.linalg.norm(np.ptp(corners, axis=(0, 2)), axis=-1)
    return np.where(too_fast, reach, 0.0)


class Course:
    """The stretches between breakpoints, each split evenly, and interpolation in them as the translator does it
    (delegate/translate/smooth_times.h)."""

    def __init__(self, ends: np.ndarray) -> None:
        """float64[S + 1] ends of stretches. Across those shorter than JUMP01 the motion jumps: nothing lies
        between."""
        self.ends = ends
        self.long = np.diff(ends) > JUMP01

    def parts(self, split: int) -> np.ndarray:
        """int[S]: into how many each stretch is split."""
        return np.where(self.long, 2**split, 1)

    def times01(self, split: int) -> np.ndarray:
        """float64[T]."""
        stretches = zip(self.ends[:-1], self.ends[1:], self.parts(split), strict=True)
        return np.concatenate([*(a + (b - a) * np.arange(n) / n for a, b, n in stretches), self.ends[-1:]])

    def first(self, split: int) -> np.ndarray:
        """int[S]: the number of each stretch's first sample."""
        return np.concatenate([[0], np.cumsum(self.parts(split))[:-1]])

    def strays(self, split: int, corners: np.ndarray, probes: np.ndarray, probed: np.ndarray) -> np.ndarray:
        """How far float64[P, N, 8, 3] corners at the probes stray from what is interpolated between float64[T, N, 8,
        3] ones: float64[N]. Since corners are linear in the matrices, this bounds every point of the box."""
        stretch = np.clip(np.searchsorted(self.ends, probes, side="right") - 1, 0, len(self.long) - 1)
        counts = self.long[stretch]
        stretch, probes = stretch[counts], probes[counts]
        parts = 2**split
        place = (probes - self.ends[stretch]) / (self.ends[stretch + 1] - self.ends[stretch]) * parts
        degree = 3 if split >= CUBIC_SPLIT else 1
        begin = np.clip(np.floor(place).astype(int) - (degree == 3), 0, parts - degree)
        weights = _lagrange(place - begin, degree)
        samples = (self.first(split)[stretch] + begin)[:, None] + np.arange(degree + 1)
        between = np.einsum("pk,pk...->p...", weights, corners[samples])
        return np.linalg.norm(probed[counts] - between, axis=-1).max(axis=(0, 2), initial=0.0)


def _lagrange(place: np.ndarray, degree: int) -> np.ndarray:
    """float64[P, degree + 1]: weights of samples at 0, 1, ... degree for values at float64[P] places."""
    nodes = np.arange(degree + 1)
    weights = np.ones((len(place), degree + 1))
    for i in nodes:
        for j in nodes[nodes != i]:
            weights[:, i] *= (place - j) / (i - j)
    return weights


def _distinct_ends(breakpoints: np.ndarray) -> np.ndarray:
    """0, 1 and the breakpoints between. A breakpoint at the shutter's end, or two at the same time, that differ by rounding
    alone would make a stretch of no length, which cannot be halved."""
    ends = [0.0]
    for time01 in sorted(breakpoints.tolist()):
        if ends[-1] + SAME_TIME01 < time01 < 1.0 - SAME_TIME01:
            ends.append(time01)
    return np.array([*ends, 1.0])


def _evaluated(motion: Motion, times01: np.ndarray, indices: np.ndarray) -> np.ndarray:
    return np.array([motion.some(time01, indices) for time01 in times01.tolist()])


def _refined(motion: Motion, course: Course, split: int, coarse: np.ndarray, indices: np.ndarray) -> np.ndarray:
    """The matrices at the times of the next split; `coarse` has those of this one."""
    times01 = course.times01(split + 1)
    known = np.isin(np.arange(len(times01)), _kept(course, split))
    fine = np.empty((len(times01), *coarse.shape[1:]))
    fine[known] = coarse
    fine[~known] = _evaluated(motion, times01[~known], indices)
    return fine


def _kept(course: Course, split: int) -> np.ndarray:
    """int[T]: where the times of a split are among those of the next."""
    pairs = zip(course.first(split + 1), course.parts(split), course.long, strict=True)
    inside = [first + np.arange(parts) * (2 if is_long else 1) for first, parts, is_long in pairs]
    return np.concatenate([*inside, [int(course.parts(split + 1).sum())]])
