"""Prims that no ray can reach: the pictures do not depend on their being left out, the figures say that they are."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from msbvh import _core
from msbvh.base.errors import Diagnostics
from msbvh.cli.main import main
from msbvh.scene.reader import ReadResult, ReadSettings, read_frame
from msbvh.stage.opening import open_stage
from shared_scenes import SharedScene, here, scene_parameters

# Of every kind of geometry one prim away from the picture and, after it, one in it; the camera moves and has a wide lens.
HEAD = """#usda 1.0
( startTimeCode = 1 )
def Camera "cam"
{
    float2 clippingRange = (0.1, 100)
    float focusDistance = 8
    float fStop = 0.5
    double shutter:open = 0
    double shutter:close = 1
    double3 xformOp:translate.timeSamples = { 1: (0, 0, 10), 2: (0.5, 0, 10) }
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
"""
KINDS = {
    "mesh": 'def Mesh "{name}" {{ int[] faceVertexCounts = [4]; int[] faceVertexIndices = [0, 1, 2, 3];'
    " point3f[] points = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]; {move}\n }}",
    "curves": 'def BasisCurves "{name}" {{ int[] curveVertexCounts = [4]; float[] widths = [0.3] ('
    ' interpolation = "constant" ); point3f[] points = [(-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)]; {move}\n }}',
    "points": 'def Points "{name}" {{ float[] widths = [0.4, 0.4]; point3f[] points = [(-1, 0, 1), (0, 1, 1)]; {move}\n }}',
    "instances": 'def PointInstancer "{name}" {{ int[] protoIndices = [0, 0]; point3f[] positions = [(-1, 1, 1), (1, -1, 1)];'
    ' rel prototypes = <cube>; {move}\n def Cube "cube" {{ double size = 0.5\n }}\n }}',
}
OF_THE_PICTURE = tuple(name for name in _core.aov_names() if name not in ("nodeVisits", "primitiveTests", "seconds"))
"""AOVs that do not depend on trees."""

COUNTS = ("trees", "nodes", "references")
AWAY, SEEN = (-60, 0, 0), (0, 0, 0)
LAMP = 'def DistantLight "lamp" { float inputs:intensity = 1\n }\n'
BLACK = 'def DistantLight "lamp" { float inputs:intensity = 0\n }\n'


def prim(kind: str, name: str, place: tuple[int, int, int]) -> str:
    x, y, z = place
    move = (
        f"double3 xformOp:translate.timeSamples = {{ 1: ({x}, {y}, {z}), 2: ({x}, {y + 1}, {z}) }}\n"
        ' uniform token[] xformOpOrder = ["xformOp:translate"]'
    )
    return KINDS[kind].format(name=name, move=move) + "\n"


def both(kinds: tuple[str, ...] = tuple(KINDS)) -> str:
    return "".join(prim(kind, f"{kind}Away", AWAY) + prim(kind, f"{kind}Seen", SEEN) for kind in kinds)


def written(folder: Path, text: str) -> Path:
    path = folder / "scene.usda"
    path.write_text(HEAD + text)
    return path


def read(scene: str | Path, frame: float | None, bounces: int | None, width: int = 64) -> ReadResult:
    stage = open_stage(str(scene), Diagnostics(), ())
    return read_frame(stage, frame, ReadSettings(width=width, max_bounces=bounces))


def rendered(result: ReadResult, bounces: int) -> tuple[np.ndarray, dict[str, np.ndarray], dict[str, Any]]:
    camera = result.camera
    renderer = _core.Renderer(
        result.scene, width=camera.width, height=camera.height, spp=4, max_bounces=bounces, aovs=OF_THE_PICTURE
    )
    pixels, aovs = renderer.render_with_aovs()
    figures = {**renderer.statistics["accel"], "trees": renderer.statistics["trees"]}
    return pixels, aovs, figures


def same_picture(
    scene: str | Path, frame: float | None, bounces: int
) -> tuple[ReadResult, dict[str, Any], dict[str, Any]]:
    """What was read with the fold, and the trees' figures without and with it; pictures and AOVs are the same."""
    whole, folded = read(scene, frame, None), read(scene, frame, bounces)
    (pixels, aovs, before), (others, other_aovs, after) = rendered(whole, bounces), rendered(folded, bounces)
    np.testing.assert_array_equal(pixels, others)
    for name, values in aovs.items():
        np.testing.assert_array_equal(values, other_aovs[name], err_msg=name)
    return folded, before, after


@pytest.mark.parametrize("light", ["", BLACK], ids=["camera light", "black light"])
def test_what_is_outside_of_the_picture_is_left_out_and_the_picture_stays(tmp_path: Path, light: str) -> None:
    scene = written(tmp_path, both() + light)
    result, before, after = same_picture(scene, 1.0, 0)
    assert {row["path"]: (row["why"], row["count"]) for row in result.left_out} == {
        f"/{kind}Away": ("outside the picture", 2 if kind == "instances" else 1) for kind in KINDS
    }
    assert after["nodes"] < before["nodes"] and after["references"] < before["references"]
    assert after["trees"] == before["trees"] - 4
    assert result.scene.mesh_names == read(scene, 1.0, None).scene.mesh_names


def test_the_seen_prims_alone_have_as_large_a_tree(tmp_path: Path) -> None:
    _, _, after = same_picture(written(tmp_path, both()), 1.0, 0)
    alone = "".join(prim(kind, f"{kind}Seen", SEEN) for kind in KINDS)
    _, _, expected = rendered(read(written(tmp_path, alone), 1.0, None), 0)
    assert {name: after[name] for name in COUNTS} == {name: expected[name] for name in COUNTS}


@pytest.mark.parametrize(("light", "bounces"), [(LAMP, 0), ("", 1), (LAMP, 2)], ids=["shadows", "bounces", "both"])
def test_shadows_and_bounces_keep_everything(tmp_path: Path, light: str, bounces: int) -> None:
    result, before, after = same_picture(written(tmp_path, both() + light), 1.0, bounces)
    assert result.left_out == []
    assert after["nodes"] == before["nodes"]


def test_a_prim_that_crosses_the_picture_within_the_shutter_stays(tmp_path: Path) -> None:
    crossing = prim("mesh", "crossing", SEEN).replace("1: (0, 0, 0), 2: (0, 1, 0)", "1: (-60, 0, 0), 2: (60, 0, 0)")
    result, _, _ = same_picture(written(tmp_path, crossing), 1.0, 0)
    assert result.left_out == []


def test_the_commands_say_what_was_left_out(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    scene = written(tmp_path, both(("mesh", "points")))
    assert main(["plan", str(scene), "--max-bounces", "0", "--rays", "0"]) == 0
    (line,) = [line for line in capfd.readouterr().out.splitlines() if line.startswith("left out")]
    assert "2 that no ray can reach, outside the picture throughout the shutter: /meshAway, /pointsAway" in line
    assert main(["plan", str(scene), "--max-bounces", "0", "--rays", "0", "--json"]) == 0
    found = json.loads(capfd.readouterr().out)["left_out"]
    assert [row["path"] for row in found] == ["/meshAway", "/pointsAway"]
    assert main(["plan", str(scene), "--rays", "0"]) == 0  # two bounces
    assert "left out" not in capfd.readouterr().out
    stats = tmp_path / "stats.json"
    image = str(tmp_path / "out.exr")
    assert (
        main(["record", str(scene), image, "-w", "16", "--spp", "1", "--max-bounces", "0", "--stats", str(stats)]) == 0
    )
    assert json.loads(stats.read_text())["frames"][0]["left_out"] == found


@pytest.mark.slow
@pytest.mark.shared
@pytest.mark.parametrize("shared", scene_parameters())
def test_pictures_of_public_scenes_stay(shared: SharedScene | None) -> None:
    shared = here(shared)
    same_picture(shared.path, float(shared.frame) if shared.frame else None, 0)
