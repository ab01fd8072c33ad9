"""msbvh bench: the report's schema, that it ends in time, its peer where there is one, and what it refuses."""

from __future__ import annotations

import importlib.metadata
import json
import math
import resource
from pathlib import Path
from typing import Any

import pytest
from conftest import Run
from msbvh import _core
from msbvh.base.errors import SceneError
from msbvh.bench.rays import BenchSettings, cases, find_peer, reader
from pxr import Gf, Usd, UsdGeom

TINY = ("--quick", "--triangles", 600, "--repetitions", 2)

TEXT = {"scene", "rays", "builder", "layout"}
WHOLE = {"triangles", "keys", "threads", "mismatches", "degree", "oracle_rays"}
FIGURES = {"mrays", "bytes_per_tri", "build_s", "nodes_per_ray", "tests_per_ray", "sah", "duplication"}
PEER = {"peer_mrays", "ratio", "peer_bytes_per_tri", "peer_build_s", "peer_misses", "peer_mismatches"}
"""Null where they were not measured."""


def rows_of(msbvh: Run, *arguments: object) -> list[dict[str, Any]]:
    done = msbvh("bench", "--json", *TINY, *arguments)
    assert done.returncode == 0, done.stderr
    report = json.loads(done.stdout)
    assert report["machine"]["instruction_set"] in _core.supported_instruction_sets()
    assert report["machine"]["processor"]
    return report["rows"]


def has_peer() -> bool:
    try:
        return find_peer("embree").library.is_file()
    except SceneError:
        return False


NO_EMBREEX = "the wheel embreex is not installed (the extra `test` brings it where there is one)"


def test_the_schema_of_json(msbvh: Run) -> None:
    rows = rows_of(msbvh, "--scenes", "mini,wheels-9,twist-2")
    assert {row["scene"] for row in rows} == {"mini", "wheels", "twist"}
    assert {row["builder"] for row in rows} == {"msbvh", "mbvh"}
    assert {row["rays"] for row in rows} == {"primary", "shadow", "random"}
    for row in rows:
        assert all(isinstance(row[key], str) for key in TEXT)
        assert all(type(row[key]) is int and row[key] >= 0 for key in WHOLE)
        assert all(math.isfinite(row[key]) and row[key] > 0 for key in FIGURES), row
        assert row["robust"] is True
        assert all(row[key] is None for key in PEER)
        assert row["mrays_low"] <= row["mrays"] <= row["mrays_high"]


def test_nothing_leaks_and_the_oracle_agrees(msbvh: Run) -> None:
    rows = rows_of(msbvh, "--scenes", "twist,room,hairball,crowd,ballistic,spin")
    assert all(row["mismatches"] == 0 for row in rows)
    closed = {row["scene"] for row in rows if row["misses"] is not None}
    assert closed == {"twist", "room"}
    assert all(row["misses"] == 0 for row in rows if row["scene"] in closed)


def test_the_same_seed_measures_the_same(msbvh: Run) -> None:
    def work(seed: int) -> list[tuple[float, float, float]]:
        rows = rows_of(msbvh, "--scenes", "debris", "--builder", "mbvh", "--seed", seed)
        assert {row["builder"] for row in rows} == {"mbvh"}
        return [(row["nodes_per_ray"], row["tests_per_ray"], row["sah"]) for row in rows]

    assert work(7) == work(7)
    assert work(7) != work(8)


def test_threads_are_a_row_each(msbvh: Run) -> None:
    rows = rows_of(msbvh, "--scenes", "mini", "--threads", "1,2")
    assert {row["threads"] for row in rows} == {1, 2}


def test_the_table_and_the_file(msbvh: Run, tmp_path: Path) -> None:
    done = msbvh("bench", *TINY, "--scenes", "mini", "--out", "bench")
    assert done.returncode == 0
    head, columns, *lines = done.stdout.splitlines()
    assert head.startswith("msbvh ")
    assert "Mrays/s" in columns
    assert len(lines) == len(json.loads((tmp_path / "bench" / "bench.json").read_text())["rows"])


@pytest.mark.skipif(not has_peer(), reason=NO_EMBREEX)
def test_a_peer_traces_the_same_rays(msbvh: Run) -> None:
    for row in rows_of(msbvh, "--scenes", "mini,room,crowd,ballistic", "--peer", "embree"):
        assert row["ratio"] > 0
        assert row["ratio_low"] <= row["ratio"] <= row["ratio_high"]
        assert row["peer_bytes_per_tri"] > 0
        assert row["peer_keys"] >= row["keys"]
        if row["scene"] == "ballistic":  # sampled: not the same motion, so that hits differ by design
            assert row["peer_mismatches"] is None
            assert row["peer_keys"] > row["keys"]
        else:
            assert row["peer_mismatches"] <= row["ray_count"] / 1000


def test_without_embreex_a_line_says_how_to_install_it(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(name: str) -> None:
        raise importlib.metadata.PackageNotFoundError(name)

    monkeypatch.setattr(importlib.metadata, "files", missing)
    with pytest.raises(SceneError) as caught:
        find_peer("embree")
    message = str(caught.value)
    assert "Embree is not installed" in message
    assert "pip install embreex" in message
    assert "\n" not in message


@pytest.mark.skipif(not has_peer(), reason=NO_EMBREEX)
def test_embree_4_is_measured_in_every_mode(msbvh: Run) -> None:
    done = msbvh("bench", "--json", *TINY, "--scenes", "mini,room", "--peer", "embree")
    report = json.loads(done.stdout)
    assert report["machine"]["peer"].startswith("Embree 4.4.")
    for row in report["rows"]:
        modes = {mode: row[f"peer_{mode}_mrays"] for mode in ("single", "packet_coherent", "packet_incoherent")}
        assert min(modes.values()) > 0
        assert row["peer_mrays"] == max(modes.values()) == modes[row["peer_mode"]]
        assert row["single_mrays"] > 0
        assert row["single_ratio"] > 0
        assert row["mode_mismatches"] == 0


def test_no_embree_is_needed_to_build() -> None:
    root = Path(__file__).resolve().parents[2]
    assert "libembree" not in (root / "Makefile").read_text()
    assert "find_package(embree" not in (root / "bench" / "CMakeLists.txt").read_text()


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        (("--scenes", "nothing*"), 1, "matches nothing"),
        (("--threads", "many"), 2, "found 'many'"),
        (("--peer", "nobody"), 2, "nobody"),
        (("--builder", "magic"), 2, "magic"),
    ],
)
def test_what_is_refused(msbvh: Run, arguments: tuple[str, ...], code: int, message: str) -> None:
    done = msbvh("bench", *TINY, *arguments)
    assert done.returncode == code
    assert message in done.stderr
    assert not done.stdout


def test_every_class_has_scenes_of_every_size() -> None:
    sizes = [kind["triangles"] for kind in _core.bench_classes()]
    assert min(sizes) <= 10_000
    assert max(sizes) >= 2_000_000
    names = {case.name for case in cases(BenchSettings(scenes=("*",)))}
    assert {kind["name"] for kind in _core.bench_classes()} <= names


@pytest.mark.slow
def test_quick_ends_in_time(msbvh: Run) -> None:
    """One thread: processor time is what the clock shows where nothing else runs. Without a peer, whose idle threads
    spin."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    assert msbvh("bench", "--quick", "--json").returncode == 0
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    assert after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime < 40


@pytest.mark.parametrize("shutter", [None, (0.0, 0.0), (-0.1, 0.1)])
def test_public_scenes_are_read_with_an_open_shutter(tmp_path: Path, shutter: tuple[float, float] | None) -> None:
    stage = Usd.Stage.CreateNew(str(tmp_path / "moving.usda"))
    stage.SetStartTimeCode(1.0)
    cube = UsdGeom.Cube.Define(stage, "/Cube")
    offset = cube.AddTranslateOp()
    for time in range(3):
        offset.Set(Gf.Vec3d(time, 0, 0), time)
    if shutter is not None:
        camera = UsdGeom.Camera.Define(stage, "/Camera")
        camera.AddTranslateOp().Set(Gf.Vec3d(0, 0, 50))
        camera.GetShutterOpenAttr().Set(shutter[0])
        camera.GetShutterCloseAttr().Set(shutter[1])
    stage.Save()
    scene, _ = reader(tmp_path / "moving.usda", "")()
    begin, end = (scene.poses(time)[0][2].mean(axis=(0, 1))[0] for time in (0.0, 1.0))
    assert end - begin == pytest.approx(0.2 if shutter == (-0.1, 0.1) else 0.5, abs=1e-4)
