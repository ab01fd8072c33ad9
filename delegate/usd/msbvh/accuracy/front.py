"""The joint front: combinations of knobs, of which the most promising ones are measured.

Each knob was turned alone. A combination is taken to multiply what its knobs do to the time, and to add up what they do to
the error; those that then beat all others are rendered, and only what was rendered is reported.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from .options import Options
from .points import Point
from .sweep import Axis

COMBINATIONS = 8
"""That are measured."""


@dataclass(frozen=True)
class Guess:
    """A combination, and what it should take."""

    options: Options
    seconds: float
    error: float


def guesses(axes: Sequence[Axis], base: Options, points: Mapping[Options, Point]) -> list[Guess]:
    """All combinations of the joint knobs' positions that were measured alone."""
    start = points[base]
    if start.error is None:
        return []
    # With a number of segments in the base, tolerances say nothing.
    joint = [
        axis
        for axis in axes
        if axis.knob.joint and axis.series and not (axis.knob.option == "motion-tolerance" and base.get("segments", 0))
    ]
    choices = [_choices(axis, base, points) for axis in joint]
    found = []
    for picked in itertools.product(*choices):
        options = base
        for one in picked:
            options = one.options.over(options)
        seconds = start.frame_seconds * math.prod(one.seconds for one in picked)
        error = start.error.relative_mse + sum(one.error for one in picked)
        found.append(Guess(options, seconds, max(error, 0.0)))
    return found


def promising(found: Sequence[Guess], known: Sequence[Options], most: int = COMBINATIONS) -> list[Options]:
    """Of those that no other beats, some that were not measured yet, spread evenly over the front."""
    front: list[Guess] = []
    for guess in sorted(found, key=lambda guess: (guess.seconds, guess.error)):
        if not front or guess.error < front[-1].error:
            front.append(guess)
    new = [guess.options for guess in front if guess.options not in known]
    if len(new) <= most:
        return new
    return [new[round(k * (len(new) - 1) / (most - 1))] for k in range(most)]


def _choices(axis: Axis, base: Options, points: Mapping[Options, Point]) -> list[Guess]:
    """A knob's positions: what each does to the base's time, as a factor, and to its error, as a difference."""
    start = points[base]
    found = [Guess(Options(), 1.0, 0.0)]
    for step in axis.steps():
        point = points.get(step.options)
        if point is None or point.error is None or start.error is None or step.options == base:
            continue
        factor = point.frame_seconds / start.frame_seconds
        found.append(Guess(step.options.beside(base), factor, point.error.relative_mse - start.error.relative_mse))
    return found
