"""What a finished scene shows at a time against what the stage shows then (stage_truth.py), point by point."""

from __future__ import annotations

from typing import Any

import numpy as np
from recording import DENSE_TIMES01, Shot
from stage_truth import StageTruth


def drawn_at(result: Any, time01: float) -> np.ndarray:
    """The points that the finished scene shows at a time, sorted: float64[N, 3]."""
    points = [p.reshape(-1, 3) for _, _, p in result.scene.poses(time01)]
    return in_order(np.concatenate([np.zeros((0, 3)), *points]))


def in_order(points: np.ndarray) -> np.ndarray:
    """Sorted by z, y, x, so that two sets can be compared."""
    return points[np.lexsort(np.round(points, 2).T)]


def apart(a: np.ndarray, b: np.ndarray) -> float:
    """How far the point of either set is at most from the next one of the other: float64[N, 3] each."""
    if not len(a) or not len(b):
        return 0.0 if len(a) == len(b) else np.inf
    distances = np.linalg.norm(a[:, None] - b[None], axis=-1)
    return float(max(distances.min(axis=0).max(), distances.min(axis=1).max()))


def true_at(shot: Shot, time: float, frame: float = 10.0) -> np.ndarray:
    """The points that the stage shows at a time code, sorted: float64[N, 3]."""
    shutter = [a.Get() for a in (shot.camera.GetShutterOpenAttr(), shot.camera.GetShutterCloseAttr())]
    found = StageTruth(shot.stage, frame, tuple(shutter)).polygons(time)
    return in_order(np.concatenate([np.zeros((0, 3)), *(drawn.world_points().reshape(-1, 3) for drawn in found)]))


def assert_as_the_stage(shot: Shot, within: float = 2e-3) -> Any:
    """The scene shows what the stage does, at times that are on no key. Returns what was read."""
    result = shot.read()
    shutter = result.camera.shutter
    seen = set()
    for time01 in DENSE_TIMES01[1:-1:2]:
        expected = true_at(shot, shutter.time_code(time01).GetValue())
        found = drawn_at(result, time01)
        assert found.shape == expected.shape, f"at {time01}"
        assert apart(found, expected) < within, f"at {time01}"
        seen.add(len(expected))
    assert max(seen) > 0, "the stage shows nothing at all: the test sees nothing"
    return result
