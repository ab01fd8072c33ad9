"""Random stages: the tracks as they are traced against usd-core's own evaluation at 33 times, and the tree's
invariants. What the public scenes do not cover: shutters beside the frame, samples that nearly agree, rates that do
not align, nested instancers under all of it."""

from __future__ import annotations

import numpy as np
import pytest
from msbvh import _core
from msbvh.base.errors import Diagnostics
from msbvh.scene.reader import ReadSettings, read_frame
from random_stages import FRAME, StageMaker
from recording import DENSE_TIMES01
from stage_truth import StageTruth
from test_dense_times import Frame, worst_pixels

TOLERANCE = 0.05
"""Pixels."""


def check(made: StageMaker, name: str) -> None:
    """That the tracks follow the stage, within the segments that there are, and that the tree holds."""
    diagnostics = Diagnostics()
    result = read_frame(
        made.stage, FRAME, ReadSettings(width=480, motion_tolerance=TOLERANCE, outside_tolerance=1.0), diagnostics
    )
    assert not any("deviates" in str(diagnostic) for diagnostic in diagnostics), name
    frame = Frame(StageTruth(made.stage, FRAME, made.shutter), result)
    worst = max(worst_pixels(frame, time01) for time01 in DENSE_TIMES01[1:-1])
    assert worst <= TOLERANCE, f"{name}: {worst:.4g} pixels, shutter {made.shutter}"
    renderer = _core.Renderer(result.scene, width=16, height=16, spp=1)
    renderer.verify()
    assert np.isfinite(np.array(renderer.render(lambda *_: None))).all()


@pytest.mark.parametrize("held", [False, True])
@pytest.mark.parametrize("first", range(0, 100, 20))
def test_tracks_follow_random_stages(first: int, held: bool):
    for seed in range(first, first + 20):
        check(StageMaker(seed, held), f"seed {seed}")


@pytest.mark.parametrize("first", range(0, 200, 20))
def test_tracks_follow_motion_scales(first: int):
    for seed in range(first, first + 20):
        made = StageMaker(seed, held=False)
        made.scale_motion()
        check(made, f"seed {seed}")
