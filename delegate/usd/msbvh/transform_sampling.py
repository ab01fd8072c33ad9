"""How densely transforms are sampled over the shutter: as straight lines between the samples need."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from .boxes import Box
from .transforms import LARGEST, Motion

SAMPLING_SHARE = 0.1
"""Of the tolerance: by how much straight lines between samples may stray from the stage. The rest is the
track's."""
FINEST_SPLIT = 12
"""The most often that a stretch between bends is halved: 4096 samples follow ten turns of a wheel that fills the
image to a hundredth of a pixel."""
LARGEST_SAMPLES = 2**23
"""Matrices that are held at once, a gigabyte; beyond it sampling ends where it stands, and says so by its error."""
JUMP01 = 6e-8
"""Bends within this of each other are a jump (kTimeResolution in delegate/translate/time_layout.h)."""
SAME_TIME01 = 1e-12
"""Times that are nearer are one: the translator's kSameTime."""
_PROBE = 0.381966
"""Of a stretch: off the even places, so that no whole number of turns looks straight."""


@dataclass(frozen=True)
class TransformSamples:
    """Some of a motion's things over the shutter, as the translator takes them."""

    indices: np.ndarray
    """int[M] among the motion's things."""
    times01: np.ndarray
    """float64[T]."""
    matrices: np.ndarray
    """float64[T, M, 4, 4]."""
    bends01: np.ndarray
    """float64[B]: where the motion may change its course."""
    held: bool = False
    error_pixels: float = 0.0
    """By which the straight lines between the samples may stray from the stage."""
    usable: bool = True
    """False for those things of which a matrix is not finite or too large; nothing can be drawn there."""


PixelSizes = Callable[[np.ndarray], np.ndarray]
"""The smallest size of a pixel at boxes of float64[T, N, 8, 3] corners: float64[N]."""


def transform_samples(
    motion: Motion, boxes: list[Box], pixel_sizes: PixelSizes, tolerance_pixels: float, held: bool = False
) -> Iterator[TransformSamples]:
    """Samples matrices over the shutter until straight lines between them follow the stage within a share of the
    tolerance.

    Halves the stretches between bends, for those things that need it. Every index comes once. `boxes` are those
    of the things, each in its own space; one: of each.
    """
    everything = np.arange(motion.count)
    bends = np.array(motion.bends01)
    if motion.still:
        yield from _by_use(TransformSamples(everything, np.zeros(1), motion.at_time(0.0)[None], bends))
        return
    if held:
        times01 = np.array([0.0, *(time for time in motion.bends01 if time > 0.0)])
        # In the middle of what holds: a time that is rounded might lie before its own sample.
        middles = (times01 + np.append(times01[1:], 1.0)) / 2
        yield from _by_use(
            TransformSamples(everything, times01, _evaluated(motion, middles, everything), bends, True)
        )
        return
    local = np.array([box.corners() for box in boxes])
    yield from _smooth_samples(motion, local, pixel_sizes, tolerance_pixels, bends)


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
    motion: Motion, local: np.ndarray, pixel_sizes: PixelSizes, tolerance_pixels: float, bends: np.ndarray
) -> Iterator[TransformSamples]:
    """`local` is float64[N, 8, 4], or float64[1, 8, 4] for all."""
    limit = SAMPLING_SHARE * tolerance_pixels
    ends = _distinct_ends(bends)
    remaining = np.arange(motion.count)
    coarse = _evaluated(motion, ends, remaining)
    # No splitting would make a number of what is none.
    for samples in _by_use(TransformSamples(remaining, ends, coarse, bends)):
        if samples.usable:
            remaining, coarse = samples.indices, samples.matrices
            local = local if len(local) == 1 else local[remaining]
            continue
        yield samples
        if len(samples.indices) == motion.count:
            return
    lengths = np.diff(ends)
    stretches = lengths > JUMP01  # Across the others the motion jumps: nothing lies between.
    probes = ends[:-1] + _PROBE * lengths
    probed = _evaluated(motion, probes, remaining)
    for split in range(FINEST_SPLIT):
        times01 = _split(ends, split + 1)
        fine = _refined(motion, coarse, times01, remaining)
        corners = local @ fine[..., :3]
        size = pixel_sizes(corners)
        # Halving a chord quarters its distance from the curve.
        inside = np.append(np.repeat(stretches, 2 ** (split + 1)), True)
        bent = _bend(_split(ends, split), local @ coarse[..., :3], times01, corners, inside) / size
        beside = _bend(times01, corners, probes, local @ probed[..., :3], stretches) / size
        straight = np.maximum(bent, beside) <= limit
        good = straight if split == 0 else (bent <= 4.0 * limit) & (beside <= 4.0 * limit) & (split > 1)
        last = split + 1 == FINEST_SPLIT or 2 * fine.size > 16 * LARGEST_SAMPLES
        good = good | last
        kept_times, kept, error = (ends, coarse, bent) if split == 0 else (times01, fine, bent / 4.0)
        if good.any():
            found = float(error[good].max())
            yield TransformSamples(remaining[good], kept_times, kept[:, good], bends, False, found)
        if good.all():
            return
        remaining, coarse, probed = remaining[~good], fine[:, ~good], probed[:, ~good]
        local = local if len(local) == 1 else local[~good]


def _distinct_ends(bends: np.ndarray) -> np.ndarray:
    """0, 1 and the bends between. A bend at the shutter's end, or two at the same time, that differ by rounding
    alone would make a stretch of no length, which cannot be halved."""
    ends = [0.0]
    for time01 in sorted(bends.tolist()):
        if ends[-1] + SAME_TIME01 < time01 < 1.0 - SAME_TIME01:
            ends.append(time01)
    return np.array([*ends, 1.0])


def _evaluated(motion: Motion, times01: np.ndarray, indices: np.ndarray) -> np.ndarray:
    return np.array([motion.some(time01, indices) for time01 in times01.tolist()])


def _refined(motion: Motion, coarse: np.ndarray, times01: np.ndarray, indices: np.ndarray) -> np.ndarray:
    """The matrices at `times01`, every second of which `coarse` already has."""
    fine = np.empty((len(times01), *coarse.shape[1:]))
    fine[::2] = coarse
    fine[1::2] = _evaluated(motion, times01[1::2], indices)
    return fine


def _split(ends: np.ndarray, split: int) -> np.ndarray:
    """float64[T]: each stretch between two ends in 2^split equal parts."""
    parts = np.arange(2**split) / 2**split
    return np.append((ends[:-1, None] + parts * np.diff(ends)[:, None]).ravel(), ends[-1])


def _bend(
    times01: np.ndarray, corners: np.ndarray, probes: np.ndarray, probed: np.ndarray, counts: np.ndarray
) -> np.ndarray:
    """How far float64[P, N, 8, 3] corners at the probes stray from the straight lines between float64[T, N, 8, 3]
    ones: float64[N]. Since corners are linear in the matrices, this bounds every point of the box. `counts` is
    bool[P]: which probes matter."""
    after = np.clip(np.searchsorted(times01, probes, side="right"), 1, len(times01) - 1)
    begin, end = times01[after - 1], times01[after]
    weight = ((probes - begin) / (end - begin))[:, None, None, None]
    straight = (1.0 - weight) * corners[after - 1] + weight * corners[after]
    return np.linalg.norm((probed - straight)[counts], axis=-1).max(axis=(0, 2), initial=0.0)
