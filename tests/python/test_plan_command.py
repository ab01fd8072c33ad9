"""`msbvh plan`: every effect, on or off, who asks for it, and the geometry that it holds."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from msbvh.cli.main import main
from msbvh.plan_report.report import MOST_PRIMS

SQUARE = """
    int[] faceVertexCounts = [4]
    int[] faceVertexIndices = [0, 1, 2, 3]
    uniform token subdivisionScheme = "none"
"""
CORNERS = "(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)"
MOVED = "(-1, -1, 1), (1, -1, 0), (1, 1, 0), (-1, 1, 2)"
CAMERA = """#usda 1.0
( startTimeCode = 1 )
def Camera "cam"
{
    float2 clippingRange = (0.1, 100)
    double shutter:open = 0
    double shutter:close = 1
    double3 xformOp:translate = (0, 0, 10)
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
"""
STILL = f'def Mesh "still" {{ {SQUARE} point3f[] points = [{CORNERS}]\n }}\n'


def deforming(name: str) -> str:
    samples = f"{{ 1: [{CORNERS}], 2: [{MOVED}] }}"
    return f'def Mesh "{name}" {{ {SQUARE} point3f[] points.timeSamples = {samples}\n }}\n'


def planned(folder: Path, capfd: pytest.CaptureFixture[str], text: str) -> tuple[dict[str, Any], str]:
    """The plan of a stage: as JSON and as text."""
    path = folder / "scene.usda"
    path.write_text(CAMERA + text)
    assert main(["plan", str(path), "--json"]) == 0
    found: dict[str, Any] = json.loads(capfd.readouterr().out)
    assert main(["plan", str(path)]) == 0
    return found, capfd.readouterr().out


def row(found: dict[str, Any], effect: str) -> dict[str, Any]:
    (one,) = [row for row in found["effects"] if row["effect"] == effect]
    return one


def test_the_first_prims_are_named_and_all_are_counted(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    count = MOST_PRIMS + 2
    found, text = planned(tmp_path, capfd, STILL + "".join(deforming(f"m{i}") for i in range(count)))
    keys = row(found, "deforming keys")
    assert keys["on"] and keys["prim_count"] == count
    assert keys["prims"] == [f"/m{i}" for i in range(MOST_PRIMS)]
    (line,) = [line for line in text.splitlines() if line.startswith("deforming keys")]
    assert "/m0: 1 segment; also /m1, /m2, 2 more" in line


def test_bytes_are_those_of_the_arrays(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """Of four vertices, 12 bytes each, and two triangles, 12 bytes each; a segment adds a key."""
    key, triangles = 4 * 12, 2 * 12
    found, text = planned(tmp_path, capfd, STILL + deforming("moves"))
    assert row(found, "deforming keys")["geometry_bytes"] == key
    assert found["base_bytes"] == 2 * (key + triangles)
    assert found["geometry_bytes"] == found["base_bytes"] + key
    assert row(found, "deforming keys")["geometry_share"] == pytest.approx(key / found["geometry_bytes"])
    assert "[25.0% of the geometry, " in text


def test_an_effect_that_is_off_says_so(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    found, text = planned(tmp_path, capfd, STILL)
    curves = row(found, "curves")
    assert not curves["on"] and curves["prims"] == [] and curves["prim_count"] == 0 and curves["why"] == ""
    (off,) = [line for line in text.splitlines() if line.startswith("off ")]
    assert "curves" in off and "deforming keys" in off
    assert found["base_bytes"] == found["geometry_bytes"]


def test_constant_samples_fold_away(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    constant = deforming("constant").replace(MOVED, CORNERS)
    found, _ = planned(tmp_path, capfd, constant)
    still, _ = planned(tmp_path, capfd, STILL)
    assert not row(found, "deforming keys")["on"]
    assert found["geometry_bytes"] == still["geometry_bytes"]


def test_a_closed_shutter_folds_motion_away(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "scene.usda").write_text(CAMERA.replace("shutter:close = 1", "shutter:close = 0") + deforming("moves"))
    assert main(["plan", str(tmp_path / "scene.usda"), "--json"]) == 0
    found = json.loads(capfd.readouterr().out)
    assert not row(found, "deforming keys")["on"]
    assert row(found, "deforming keys")["geometry_bytes"] == 0


def test_a_setting_asks_without_a_prim(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    found, text = planned(tmp_path, capfd, STILL)
    indirect = row(found, "indirect light")
    assert indirect["on"] and indirect["prim_count"] == 0 and indirect["why"] == "up to 2 bounces"
    assert "indirect light       up to 2 bounces [predicted to take about " in text


def test_the_plan_is_that_of_a_render(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """What `plan` says first is what record --stats keeps."""
    found, _ = planned(tmp_path, capfd, STILL + deforming("moves") + deforming("too"))
    out, stats = tmp_path / "a.exr", tmp_path / "s.json"
    arguments = ["record", str(tmp_path / "scene.usda"), str(out), "--stats", str(stats), "-w", "16", "--spp", "1"]
    assert main(arguments) == 0
    assert json.loads(stats.read_text())["frames"][0]["plan"] == found["plan"]


def test_the_rays_work_is_predicted_by_effect_and_found_by_a_render(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """What covers most of the picture takes most of the work; what the render finds is near what was predicted."""
    big = deforming("big").replace(CORNERS, "(-4, -4, 0), (4, -4, 0), (4, 4, 0), (-4, 4, 0)")
    found, text = planned(tmp_path, capfd, big + STILL.replace("-1, -1, 0", "-1, -1, 1"))
    share = row(found, "deforming keys")["ray_share"]
    assert 0.3 < share < 1.0
    assert "of the rays' work" in next(line for line in text.splitlines() if line.startswith("deforming keys"))
    assert row(found, "lens")["ray_share"] is None
    stats = tmp_path / "stats.json"
    out = str(tmp_path / "o.exr")
    assert main(["record", str(tmp_path / "scene.usda"), out, "--spp", "1", "--ray-costs", "--stats", str(stats)]) == 0
    costs = json.loads(stats.read_text())["frames"][0]["render"]["ray_costs"]
    assert costs["effects"]["deforming keys"] == pytest.approx(share, abs=0.1)
    shares = {prim["path"]: prim["share"] for prim in costs["prims"]}
    assert costs["effects"]["deforming keys"] == pytest.approx(shares["/big"])


def test_no_rays_are_traced_where_none_are_asked_for(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "scene.usda"
    path.write_text(CAMERA + deforming("moves"))
    assert main(["plan", str(path), "--json", "--rays", "0"]) == 0
    found = json.loads(capfd.readouterr().out)
    assert row(found, "deforming keys")["ray_share"] is None
