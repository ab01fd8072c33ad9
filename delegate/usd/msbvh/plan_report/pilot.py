"""A frame's rays, traced to tell what each effect takes: a few ahead of a render, and those of a render."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

from .. import _core

PILOT_PATHS = 1 << 18
"""Camera samples of a pilot: a fraction of a second on most scenes, and hundreds of looks at each thread."""
MOST_PILOT_SAMPLES = 64
"""A pixel."""


@dataclass(frozen=True)
class Traced:
    """Of one frame."""

    costs: _core.RayCosts | None = None
    """Of a sample of its rays. None: none were traced, or nothing is in the frame that rays could meet."""
    pilot: list[_core.StageSamples] = field(default_factory=list)
    """What threads were found at in a small render; empty without costs."""
    stages: list[_core.StageSamples] = field(default_factory=list)
    """What they were found at in the frame's own; empty where none was made."""


def traced(
    scene: _core.Scene,
    size: tuple[int, int],
    *,
    rays: int,
    spp: int,
    max_bounces: int,
    refraction: bool = False,
    progress: Callable[[float], object] | None = None,
) -> Traced:
    """By `rays` camera rays and a pilot of some more, and by a render of `spp` samples a pixel; 0: not that. `size`: the frame's,
    (width, height) in pixels; `progress`: of both together, as of _core.Renderer.render(). Each builds its trees, one after the
    other. Raises _core.Error for a scene that is wrong."""
    small = pilot_size(size)
    pilot_samples = _pilot_samples(small) if rays else 0
    pilot_work = pilot_samples * small[0] * small[1] + rays
    frame_work = spp * size[0] * size[1]
    turn = pilot_work / max(1, pilot_work + frame_work)
    costs, pilot, stages = None, [], []
    if rays:
        renderer = _renderer(scene, small, pilot_samples, max_bounces, refraction)
        costs = renderer.ray_costs(camera_samples=rays)
        renderer.render_samples(0, pilot_samples, _part(progress, 0.0, turn))
        pilot = renderer.statistics["stages"]
        del renderer  # Its trees make room for the frame's.
    if spp:
        renderer = _renderer(scene, size, spp, max_bounces, refraction)
        renderer.render(_part(progress, turn, 1.0))
        stages = renderer.statistics["stages"]
    return Traced(costs if costs and costs["prims"] else None, pilot, stages)


def _renderer(
    scene: _core.Scene, size: tuple[int, int], spp: int, max_bounces: int, refraction: bool
) -> _core.Renderer:
    width, height = size
    return _core.Renderer(
        scene,
        width=width,
        height=height,
        spp=spp,
        max_bounces=max_bounces,
        refraction=refraction,
        sample_stages=True,
    )


def _part(progress: Callable[[float], object] | None, begin: float, end: float) -> Callable[[float], object] | None:
    """Of one that shares are said to, from `begin` to `end` of it."""
    return progress and (lambda share: progress(begin + (end - begin) * share))


def _pilot_samples(size: tuple[int, int]) -> int:
    """A pixel, of a pilot of `size`."""
    return max(1, min(MOST_PILOT_SAMPLES, PILOT_PATHS // (size[0] * size[1])))


def pilot_size(size: tuple[int, int]) -> tuple[int, int]:
    """Of a frame that has about PILOT_PATHS pixels at most, and the same aspect."""
    width, height = size
    by = max(1.0, math.sqrt(width * height / PILOT_PATHS))
    return max(1, round(width / by)), max(1, round(height / by))
