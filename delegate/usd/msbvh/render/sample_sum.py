"""Pictures of some of a pixel's samples, summed up to the picture of all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

DEPTH = "cameraDepth"
"""Whose nearest sample depths and ids are of."""
MEANS = ("Neye", "normal", "albedo")
"""AOVs that are averaged, as colour is: core/film/aov.h."""


class SampleSum:
    """Blocks of samples; weighted by their counts."""

    def __init__(self, aovs: Sequence[str] = ()) -> None:
        """`aovs`: those that the renderer makes. Where depths or ids are among them, cameraDepth is too."""
        self._names = aovs
        self._sum: np.ndarray | None = None
        self._count = 0
        self._means: dict[str, np.ndarray] = {}
        self._nearest: dict[str, np.ndarray] = {}

    def add(self, count: int, pixels: np.ndarray, aovs: Mapping[str, np.ndarray]) -> None:
        """A picture of so many samples: float32[height, width, 4], and its AOVs."""
        weighted = pixels.astype(np.float64) * count
        self._sum = weighted if self._sum is None else self._sum + weighted
        self._count += count
        for name in self._names:
            if name in MEANS:
                self._means[name] = self._means.get(name, 0.0) + aovs[name].astype(np.float64) * count
        self._take_nearest(aovs)

    def _take_nearest(self, aovs: Mapping[str, np.ndarray]) -> None:
        names = [name for name in self._names if name not in MEANS]
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
        means = {name: np.asarray(found / self._count, np.float32) for name, found in self._means.items()}
        return {name: means[name] if name in means else self._nearest[name] for name in self._names}

    @staticmethod
    def merged(parts: Sequence[SampleSum]) -> SampleSum:
        """Of parts that have samples."""
        whole = SampleSum(parts[0]._names)
        for part in parts:
            whole.add(part._count, part.pixels, part.aovs)
        return whole
