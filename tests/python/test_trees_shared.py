"""The invariants of the acceleration structure, proved on every tree of scenes that nobody here wrote."""

from __future__ import annotations

import pytest
from msbvh import _core
from msbvh.base.errors import Diagnostics
from msbvh.scene.reader import ReadSettings, read_frame
from msbvh.stage.opening import open_stage
from shared_scenes import SharedScene, here, scene_parameters


@pytest.mark.slow
@pytest.mark.shared
@pytest.mark.parametrize("shared", scene_parameters())
def test_invariants(shared: SharedScene | None) -> None:
    shared = here(shared)
    stage = open_stage(str(shared.path), Diagnostics())
    frame = float(shared.frame) if shared.frame else stage.GetStartTimeCode()
    # A small picture: edges of subdivided surfaces are as long as a pixel.
    result = read_frame(stage, frame, ReadSettings(width=320), Diagnostics())
    for builder in _core.builders():
        renderer = _core.Renderer(result.scene, width=64, height=64, builder=builder)
        renderer.verify()
        assert renderer.statistics["trees"] > 0
