"""Rounds of runs: every point once a round, each round with another seed, so that what slows the machine for a while slows
all points alike."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from statistics import quantiles

import numpy as np

from ..base.errors import SceneError
from .facts import SceneFacts
from .kinds import kinds_in, rid_of
from .knobs import Error
from .launch import Shot, run
from .options import Options
from .picture_errors import noise_flip, paired_error, picture_error
from .points import Point
from .shapes import ShapeErrors
from .store import Figures, Store

REFERENCE_SEED = 1_000_000
"""References begin here; points take seeds from the user's on."""
AGAIN = 500_000
"""Added to a seed for a second run of the same frame."""
HALVES = 2
"""Of a reference: pictures that share no noise."""


class Measurement:
    """Points of one scene, measured as they are asked for; what the store holds is not rendered again."""

    def __init__(
        self,
        shot: Shot,
        store: Store,
        seeds: Sequence[int],
        progress: Callable[[float], object],
        shapes: ShapeErrors,
    ) -> None:
        self.shapes = shapes
        self._shot = shot
        self._store = store
        self._seeds = seeds
        self._progress = progress
        self._done = self._ahead = 0.0
        self.points: dict[Options, Point] = {}
        self._times: list[float] = []
        """Of one and the same frame, twice a round."""
        self._rendered: set[tuple[Options, int]] = set()
        self._asked: set[tuple[Options, int]] = set()

    def expect(self, options: Iterable[Options], share: float) -> None:
        """Tells the progress bar how much work lies ahead until it has moved by a share."""
        self._share, self._from = share, self._done
        self._ahead = sum(self._weight(one) * len(self._seeds) for one in set(options) if one not in self.points) or 1.0
        self._spent = 0.0

    def reach(self, share: float) -> None:
        """Moves the progress bar."""
        self._done = share
        self._progress(share)

    def measure(self, options: Sequence[Options], beside: Options | None = None) -> None:
        """Each of them by every seed, in rounds. `beside`: once more at the end of each round, by another seed, so that it is
        known how much the time of one frame changes. Raises SceneError where that one cannot be rendered."""
        wanted = list(dict.fromkeys(one for one in options if one not in self.points))
        for one in wanted:
            self.points[one] = Point(one, shape_px=self.shapes.largest(one))
        for turn, seed in enumerate(self._seeds):
            first = turn * len(wanted) // max(len(self._seeds), 1)
            for one in [*wanted[first:], *wanted[:first]]:
                self._measure(self.points[one], seed)
            if beside is not None:
                if self.points[beside].failed:
                    raise SceneError(self.points[beside].failed)
                self._times.append(_seconds(self.run(beside, seed + AGAIN)))
                self._times.append(_seconds(self.points[beside].runs[-1]))
        self._done = self._from + self._share
        self._progress(min(self._done, 1.0))

    def _measure(self, point: Point, seed: int) -> None:
        if point.failed:
            return
        try:
            point.runs.append(self.run(point.options, seed))
        except SceneError as error:
            point.failed = str(error)
            point.runs.clear()
        self._spent += self._weight(point.options)
        self._progress(min(self._from + self._share * min(self._spent / self._ahead, 1.0), 1.0))

    def run(self, options: Options, seed: int) -> Figures:
        """A run's figures, from the store where it has them."""
        self._asked.add((options, seed))
        found = self._store.figures(options, seed)
        if found is not None:
            return found
        self._rendered.add((options, seed))
        figures = run(self._shot, options, seed, self._store.folder(options, seed))
        self._store.put(options, seed, figures)
        return figures

    def picture(self, options: Options, seed: int) -> np.ndarray:
        return self._store.picture(options, seed)

    def pictures(self, options: Options) -> list[np.ndarray]:
        return [self._store.picture(options, seed) for seed in self._seeds]

    def noise_flip(self, options: Options) -> float:
        """Of one seed's picture beside a converged one, by seeds alone: picture_errors.noise_flip()."""
        return noise_flip(self.pictures(options))

    def judge(self, references: Sequence[np.ndarray]) -> None:
        """Sets the whole error of all points that have none yet."""
        for point in self.points.values():
            if point.runs and point.error is None:
                point.error = picture_error(self.pictures(point.options), references)

    def set_apart(self, partners: Mapping[Options, Options], kind: Error) -> None:
        """Sets one kind of error of points, each beside its partner without it."""
        for options, partner in partners.items():
            point, without = self.points[options], self.points[partner]
            if point.runs and without.runs and kind not in point.kinds:
                point.kinds[kind] = paired_error(self.pictures(options), self.pictures(partner))

    def all_partners(self, options: Sequence[Options], facts: SceneFacts) -> dict[Error, dict[Options, Options]]:
        """Of points whose errors of every kind are to be seen apart."""
        return {kind: {one: rid_of(kind, one) for one in options} for kind in kinds_in(facts)}

    @property
    def rendered(self) -> int:
        """Runs of this process."""
        return len(self._rendered)

    @property
    def taken_over(self) -> int:
        """Runs of an earlier one."""
        return len(self._asked - self._rendered)

    @staticmethod
    def _weight(options: Options) -> float:
        """About what a run takes, beside others."""
        return 8.0 + float(options.get("spp", 16))

    @property
    def noise(self) -> float:
        """How noisy the machine was: the upper quartile of one frame's times over the lower one."""
        if len(self._times) < 2:
            return 1.0
        low, _, high = quantiles(self._times, n=4, method="inclusive")
        return high / low


def _seconds(figures: Figures) -> float:
    return sum(figures.seconds.values())
