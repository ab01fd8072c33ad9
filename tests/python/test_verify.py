"""`msbvh verify`: what it tries, what it says, its exit codes."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from conftest import Run
from msbvh.cli.main import main
from msbvh.scene.reader import ReadSettings, read_frame
from msbvh.verify import checks
from msbvh.verify.checks import Probe, Verdict, VerifySettings, verify
from msbvh.verify.hard_shells import FRAME, SHUTTER, hard_shells
from msbvh.verify.table import verdict_text

FEW = "600"


@pytest.mark.parametrize("name", hard_shells())
def test_hard_shells_are_closed_and_nothing_gets_out(name: str) -> None:
    stage = hard_shells()[name]
    frame = read_frame(stage, FRAME, ReadSettings(shutter=SHUTTER))
    verdict = verify(name, frame, VerifySettings(rays=600))
    assert verdict.meshes == verdict.closed_meshes == 1
    assert verdict.holds, verdict_text(verdict)
    inside = [probe for probe in verdict.probes if "inside" in probe.probe]
    assert inside and all(probe.rays >= 400 for probe in inside)


def test_hard_shells_move_as_they_say() -> None:
    tracks = {}
    for name, stage in hard_shells().items():
        frame = read_frame(stage, FRAME, ReadSettings(shutter=SHUTTER))
        tracks[name] = max((track.segments, track.degree) for track in frame.tracks)
    assert tracks["still"][0] == 0
    assert tracks["accelerated"][1] >= 2
    assert tracks["whole turns"][0] >= 4 and tracks["sheared back and forth"][0] >= 16


def test_a_users_scene(msbvh: Run, scene: Path) -> None:
    done = msbvh("verify", scene, "--rays", FEW, "--json")
    assert done.returncode == 0, done.stderr
    (verdict,) = json.loads(done.stdout)
    assert verdict["scene"] == str(scene) and verdict["holds"]
    assert (verdict["meshes"], verdict["closed_meshes"]) == (1, 0)
    by_name: dict[str, Any] = {probe["probe"]: probe for probe in verdict["probes"]}
    assert by_name["rays at edges"]["rays"] == int(FEW)
    assert by_name["rays at edges"]["judged"] == int(FEW)
    assert by_name["rays from inside closed meshes"]["rays"] == 0


def test_the_same_seed_asks_the_same(scene: Path, capsys: pytest.CaptureFixture[str]) -> None:
    said = []
    for seed in ("1", "1", "2"):
        assert main(["verify", str(scene), "--rays", "200", "--seed", seed]) == 0
        said.append(capsys.readouterr().out)
    assert said[0] == said[1]
    assert "0 wrong" in said[0] and "rays along faces" in said[0]


def wrong_verdict(broken: str = "") -> Verdict:
    rows = [Probe("rays at edges", "avx2", 100, 10, 2, "ray from (0, 0, 0): is lost")]
    return Verdict("shot.usda", 3, 1, broken, rows)


@pytest.mark.parametrize("broken", ["", "node 64: child 3 lies outside"])
def test_what_is_wrong_is_told_and_ends_with_1(
    broken: str, scene: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    found: Callable[..., Verdict] = lambda *_: wrong_verdict(broken)
    monkeypatch.setattr("msbvh.cli.verify_command.verify", found)
    assert main(["verify", str(scene)]) == 1
    said = capsys.readouterr().out
    assert "wrong, rays at edges, avx2: ray from (0, 0, 0): is lost" in said
    assert ("broken: node 64" in said) == bool(broken)


def test_a_broken_invariant_is_a_verdict(monkeypatch: pytest.MonkeyPatch) -> None:
    class Renderer(checks._core.Renderer):
        def verify(self) -> None:
            raise checks._core.Error("node 64: child 3 lies outside")

    monkeypatch.setattr(checks._core, "Renderer", Renderer)
    stage = hard_shells()["still"]
    verdict = verify("still", read_frame(stage, FRAME, ReadSettings(shutter=SHUTTER)), VerifySettings(rays=10))
    assert not verdict.holds and verdict.broken_invariant == "node 64: child 3 lies outside"


def test_a_scene_that_is_not_there_is_one_line(msbvh: Run) -> None:
    done = msbvh("verify", "nowhere.usda")
    assert done.returncode == 1
    assert done.stderr.count("\n") == 1 and "nowhere.usda" in done.stderr
