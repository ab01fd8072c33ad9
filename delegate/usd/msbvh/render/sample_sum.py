"""Pictures of some of a pixel's samples, summed up to the picture of all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from .._core import aov_merges

DEPTH = "cameraDepth"
"""Whose nearest sample depths, ids and places are of."""
MERGES = aov_merges()
"""How each AOV is merged: core/film/aov.h."""


def needs_depth(aovs: Sequence[str]) -> bool:
    """Whether any of them is that of the nearest sample."""
    return any(MERGES[name] == "nearest" for name in aovs)


class SampleSum:
    """Blocks of samples; weighted by their counts."""

    def __init__(self, aovs: Sequence[str] = ()) -> None:
        """`aovs`: those that the renderer makes. Where needs_depth() says so, cameraDepth is among them."""
        self._names = aovs
        self._sum: np.ndarray | None = None
        self._count = 0
        self._sums: dict[str, np.ndarray] = {}
        self._nearest: dict[str, np.ndarray] = {}

    def add(self, count: int, pixels: np.ndarray, aovs: Mapping[str, np.ndarray]) -> None:
        """A picture of so many samples: float32[height, width, 4], and its AOVs."""
        weighted = pixels.astype(np.float64) * count
        self._sum = weighted if self._sum is None else self._sum + weighted
        self._count += count
        for name in self._names:
            if MERGES[name] != "nearest":
                part = _part_of_sum(MERGES[name], aovs[name].astype(np.float64), count)
                self._sums[name] = self._sums.get(name, 0.0) + part
        self._take_nearest(aovs)

    def _take_nearest(self, aovs: Mapping[str, np.ndarray]) -> None:
        names = [name for name in self._names if MERGES[name] == "nearest"]
        if not names:
            return
        if not self._nearest:
            self._nearest = {name: np.array(aovs[name]) for name in names}
            return
        nearer = (aovs[DEPTH] < self._nearest[DEPTH]).reshape(aovs[DEPTH].shape[:2])
        for name in names:
            self._nearest[name][nearer] = aovs[name][nearer]

    @property
    def pixels(self) -> np.ndarray:
        """float32[height, width, 4]."""
        assert self._sum is not None
        return np.asarray(self._sum / self._count, np.float32)

    @property
    def aovs(self) -> dict[str, np.ndarray]:
        found = {name: _from_sum(MERGES[name], total, self._count) for name, total in self._sums.items()}
        return {name: found[name] if name in found else self._nearest[name] for name in self._names}

    @staticmethod
    def merged(parts: Sequence[SampleSum]) -> SampleSum:
        """Of parts that have samples."""
        whole = SampleSum(parts[0]._names)
        for part in parts:
            whole.add(part._count, part.pixels, part.aovs)
        return whole


def _part_of_sum(merge: str, values: np.ndarray, count: int) -> np.ndarray:
    """Means count by their samples, totals as they are, and errors by the variance of the sum of their samples."""
    if merge == "total":
        return values
    return values * count if merge == "mean" else np.square(values * count)


def _from_sum(merge: str, total: np.ndarray, count: int) -> np.ndarray:
    found = total
    if merge != "total":
        found = (total if merge == "mean" else np.sqrt(total)) / count
    return np.asarray(found, np.float32)
