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
    progress: Callable[[float], object] | None = None,
) -> Traced:
    """By `rays` camera rays and a pilot of some more, and by a render of `spp` samples a pixel; 0: not that. `size`: the frame's,
    (width, height) in pixels; `progress`: the render's, as of _core.Renderer.render(). Builds the trees once. Raises
    _core.Error for a scene that is wrong."""
    if not rays and not spp:
        return Traced()
    width, height = size if spp else pilot_size(size)
    renderer = _core.Renderer(
        scene, width=width, height=height, spp=max(spp, 1), max_bounces=max_bounces, sample_stages=True
    )
    costs, pilot, stages = None, [], []
    if rays:
        costs = renderer.ray_costs(camera_samples=rays)
        renderer.render_samples(0, max(1, min(MOST_PILOT_SAMPLES, PILOT_PATHS // (width * height))))
        pilot = renderer.statistics["stages"]
    if spp:
        renderer.render(progress)
        stages = renderer.statistics["stages"]
    return Traced(costs if costs and costs["prims"] else None, pilot, stages)


def pilot_size(size: tuple[int, int]) -> tuple[int, int]:
    """Of a frame that has about PILOT_PATHS pixels at most, and the same aspect."""
    width, height = size
    by = max(1.0, math.sqrt(width * height / PILOT_PATHS))
    return max(1, round(width / by)), max(1, round(height / by))
