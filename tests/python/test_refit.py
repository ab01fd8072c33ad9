"""Trees over frames: the pictures do not depend on what a frame takes over from the one before, the figures say
what it was."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import ROOT, Run
from exr import read_exr
from msbvh import _core
from msbvh.base.errors import Diagnostics, SceneError
from msbvh.scene.reader import ReadSettings, read_frame
from msbvh.stage.opening import open_stage
from pxr import Usd
from random_edits import EditedStage
from shared_scenes import SharedScene, here, scene_parameters
from soak import soak_count, soak_figure

POLICIES = ("auto", "always", "never")
SHOWCASE = ROOT / "testenv" / "showcase" / "showcase.usda"
SMALL = ("-w", 64, "--spp", 4, "--seed", 3)
FRAMES = 4
"""Of a public scene, from the one that its index names."""

# A strip that waves and has another face from frame 3 on, and a card that stands still.
WAVING = """#usda 1.0
(
    defaultPrim = "world"
    endTimeCode = 4
    startTimeCode = 1
    upAxis = "Y"
)
def Xform "world"
{
    def Camera "main_cam"
    {
        float focalLength = 35
        float horizontalAperture = 24
        float verticalAperture = 16
        double shutter:open = -0.25
        double shutter:close = 0.25
        double3 xformOp:translate = (0, 0, 5)
        uniform token[] xformOpOrder = ["xformOp:translate"]
    }
    def Mesh "strip"
    {
        int[] faceVertexCounts.timeSamples = { 1: [4, 4], 2.7: [4] }
        int[] faceVertexIndices.timeSamples = { 1: [0, 1, 2, 3, 3, 2, 4, 5], 2.7: [0, 1, 2, 3] }
        point3f[] points.timeSamples = {
            0: [(-1, 0, 0), (1, 0, 0), (1, 0.4, 0), (-1, 0.4, 0), (1, 0.8, 0), (-1, 0.8, 0)],
            5: [(-1, 0, 0), (1, 0.5, 0), (1, 0.9, 0), (-1, 0.4, 1), (1, 1.3, 0), (-1, 0.8, 2)]
        }
        uniform token subdivisionScheme = "none"
    }
    def Xform "card" (
        instanceable = true
        references = </card>
    )
    {
    }
}
def Xform "card"
{
    def Mesh "quad"
    {
        int[] faceVertexCounts = [4]
        int[] faceVertexIndices = [0, 1, 2, 3]
        point3f[] points = [(-1.5, -1, -1), (1.5, -1, -1), (1.5, 0, -1), (-1.5, 0, -1)]
        uniform token subdivisionScheme = "none"
    }
}
"""


def recorded(
    msbvh: Run, folder: Path, scene: Path, frames: str, policy: str
) -> tuple[list[np.ndarray], list[dict[str, Any]]]:
    """Pixels and the renderer's figures, frame by frame."""
    done = msbvh(
        "record", scene, f"{policy}.###.exr", "-f", frames, "--refit", policy, "--stats", "stats.json", *SMALL
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    figures = json.loads((folder / "stats.json").read_text())["frames"]
    pictures = [read_exr(folder / frame["output"][0]) for frame in figures]
    return pictures, [frame["render"] for frame in figures]


def ways(render: dict[str, Any]) -> tuple[int, int, int]:
    accel = render["accel"]
    assert accel["built"] + accel["refitted"] + accel["kept"] == render["trees"]
    assert 0.0 <= accel["refit_seconds"] <= accel["build_seconds"]
    return accel["built"], accel["refitted"], accel["kept"]


def assert_same(pictures: dict[str, list[np.ndarray]]) -> None:
    for policy in POLICIES[:2]:
        for picture, expected in zip(pictures[policy], pictures["never"], strict=True):
            assert np.array_equal(picture, expected)


def test_the_showcase_is_the_same_whichever_way(msbvh: Run, tmp_path: Path) -> None:
    pictures, figures = {}, {}
    for policy in POLICIES:
        pictures[policy], figures[policy] = recorded(msbvh, tmp_path, SHOWCASE, "5:8", policy)
    assert_same(pictures)
    assert all(ways(render)[1:] == (0, 0) for render in figures["never"])
    for policy in POLICIES[:2]:
        assert ways(figures[policy][0])[1:] == (0, 0)
        for render in figures[policy][1:]:
            built, refitted, kept = ways(render)
            assert refitted > 0 and kept > 0
    assert all(ways(render)[0] == 0 for render in figures["always"][1:])


def test_another_face_is_built_anew(msbvh: Run, tmp_path: Path) -> None:
    scene = tmp_path / "scene.usda"
    scene.write_text(WAVING)
    pictures, figures = {}, {}
    for policy in POLICIES:
        pictures[policy], figures[policy] = recorded(msbvh, tmp_path, scene, "1:4", policy)
    assert_same(pictures)
    assert not np.array_equal(pictures["never"][0], pictures["never"][1])
    # The card's tree is kept; the world's, which has the strip, is built where its faces change.
    assert [ways(render) for render in figures["always"]] == [(2, 0, 0), (0, 1, 1), (1, 0, 1), (0, 1, 1)]


def test_a_frame_again_is_kept_and_a_single_one_holds_nothing(scene: Path) -> None:
    result = read_frame(open_stage(str(scene), Diagnostics()), 2.0, ReadSettings(width=32), Diagnostics())
    size = {"width": result.camera.width, "height": result.camera.height, "spp": 2}
    renderer = _core.Renderer(result.scene, **size)
    first = renderer.render()
    renderer.commit(result.scene, **size, refit="auto")
    assert ways(renderer.statistics)[0] == 0
    assert np.array_equal(renderer.render(), first)
    renderer.commit(result.scene, **size, refit="never")
    assert ways(renderer.statistics)[1:] == (0, 0)
    with pytest.raises(ValueError, match='refit: found "sometimes"; expected auto or always or never'):
        renderer.commit(result.scene, **size, refit="sometimes")
    assert np.array_equal(renderer.render(), first)


@pytest.mark.slow
@pytest.mark.shared
@pytest.mark.parametrize("shared", scene_parameters())
def test_public_scenes(shared: SharedScene | None) -> None:
    """Refitted trees hold their invariants, and show what built ones do."""
    shared = here(shared)
    stage = open_stage(str(shared.path), Diagnostics())
    start = float(shared.frame) if shared.frame else stage.GetStartTimeCode()
    always = None
    for frame in range(FRAMES):
        result = read_frame(stage, start + frame, ReadSettings(width=64), Diagnostics())
        settings = {"width": result.camera.width, "height": result.camera.height, "spp": 2, "max_bounces": 1}
        if always is None:
            always = _core.Renderer(result.scene, **settings, keep_topology=True)
        else:
            always.commit(result.scene, **settings, refit="always", keep_topology=True)
        always.verify()
        expected = _core.Renderer(result.scene, **settings).render()
        assert np.array_equal(always.render(), expected)


EDITS_OF_SEQUENCE = 40


@pytest.mark.soak
def test_edits_between_frames_render_as_the_edited_stage_alone() -> None:
    """A renderer that is kept while the stage is edited shows what a new one shows of a new stage, to the bit."""
    edits = soak_count(40, 20_000)
    seen: dict[str, int] = {"built": 0, "refitted": 0, "kept": 0}
    for seed in range(edits // EDITS_OF_SEQUENCE):
        edited = EditedStage(seed)
        kept: _core.Renderer | None = None
        history: list[str] = []
        for _ in range(EDITS_OF_SEQUENCE):
            history.append(edited.edit())
            shown, kept = picture(edited.stage, edited.frame, kept, "always" if seed % 2 else "auto")
            alone, _ = picture(edited.copy(), edited.frame, None, "never")
            assert (shown is None) == (alone is None), (seed, history)
            if kept is not None and shown is not None:
                assert np.array_equal(shown, alone), (seed, history)
                seen = {way: count + kept.statistics["accel"][way] for way, count in seen.items()}
    assert all(seen.values())
    ways_taken = ", ".join(f"{count} {way}" for way, count in seen.items())
    soak_figure("edits", f"{edits} edited frames as rendered alone; trees: {ways_taken}")


def picture(
    stage: Usd.Stage, frame: float, kept: _core.Renderer | None, policy: str
) -> tuple[np.ndarray | None, _core.Renderer | None]:
    """The picture, by the renderer that is kept from the last frame where there is one; None: nothing to be seen."""
    try:
        result = read_frame(stage, frame, ReadSettings(camera="/Camera", width=32), Diagnostics())
    except SceneError:
        return None, kept
    settings = {"width": result.camera.width, "height": result.camera.height, "spp": 2, "max_bounces": 1, "seed": 5}
    if kept is None:
        kept = _core.Renderer(result.scene, **settings, keep_topology=policy != "never")
    else:
        kept.commit(result.scene, **settings, refit=policy, keep_topology=True)
    return kept.render(), kept
