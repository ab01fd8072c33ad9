"""What docs/make_ablation.py makes of figures, and what it says where it cannot measure."""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from conftest import ROOT

sys.path.insert(0, str(ROOT / "docs"))
import ablation_counts
import ablation_page
import make_ablation

MACHINE = ablation_page.Machine("abc1234", "A processor", 2, "Linux")
ON = {
    "effect": "lens", "needs": "", "triangles": 20000, "width": 256, "rounds": 3, "without_seconds": 0.5, "with_seconds": 0.6,
    "ratio": 1.2, "ratio_low": 1.1, "ratio_high": 1.3, "without_bytes": 1000, "with_bytes": 1000, "without_rays": 7,
    "with_rays": 8, "load": 0.5,
}  # fmt: skip


def omitted(**changed: Any) -> dict[str, Any]:
    return {
        "hash": {"sse4": ["aa", "aa"], "avx2": ["bb", "bb"]},
        "count": {"sse4": [1000, 1000], "avx2": [900, 900]},
        "seconds": [[1.0, 1.0], [1.0, 1.1], [1.0, 0.9]],
        "load": 2.0,
    } | changed


def lines(rows: dict[str, Any]) -> list[str]:
    return "\n".join(ablation_page.page(MACHINE, rows)).splitlines()


def row(text: list[str], start: str, *, last: bool = False) -> str:
    return [line for line in text if line.startswith(start)][-1 if last else 0]


def test_what_was_measured_stands_in_both_tables_and_what_was_not_says_so() -> None:
    text = lines({"lens": {"on": ON, "omitted": omitted()}, "opacity": {}})
    assert row(text, "| lens") == (
        "| lens | the base scene | 0.5000 -> 0.6000 | **1.200** [1.100, 1.300] | 7 -> 8 | 1,000 -> 1,000 |"
    )
    assert row(text, "| lens | equal").startswith("| lens | equal | 1,000, equal | 900, equal | 1.0000 [0.9")
    assert row(text, "| opacity") == "| opacity | not measured: `--only opacity` |  |  |  |  |"
    assert [line for line in text if line.startswith("| opacity")][
        1
    ] == "| opacity | not measured: `--only opacity` |  |  |  |"
    assert any("load averages from 0.5 to 2.0" in line for line in text)
    assert "Of 1 builds, 1 drew the same bits." in text
    assert "All counted the same instructions." in text


def test_what_differs_is_named() -> None:
    wrong = omitted(hash={"sse4": ["aa", "aa"], "avx2": ["bb", "cc"]}, count={"sse4": [1000, 990], "avx2": [900, 900]})
    text = lines({"lens": {"omitted": wrong}, "opacity": {"omitted": omitted()}})
    assert row(text, "| lens | **differ**").startswith("| lens | **differ** | 1,000 -> 990 (-1.0000%) | 900, equal |")
    assert "Of 2 builds, 1 drew the same bits; not those without lens." in text
    assert "- lens: +0.5051%" in text and "All counted the same instructions." not in text


def test_nothing_is_said_of_all_where_nothing_was_measured() -> None:
    assert not any("builds" in line and "drew" in line for line in lines({"lens": {}}))


def test_the_interval_holds_the_median_and_narrows_with_pairs() -> None:
    values = [0.98, 0.99, 1.0, 1.01, 1.02]
    middle, low, high = ablation_page.interval(values)
    assert middle == 1.0 and 0.98 <= low < 1.0 < high <= 1.02
    _, closer_low, closer_high = ablation_page.interval(values * 20)
    assert closer_high - closer_low < high - low


def test_instructions_are_the_files_total() -> None:
    assert ablation_counts.total_of("events: Ir\nfn=(1) f\n1 5\nsummary: 17\n\ntotals: 17\n") == 17
    with pytest.raises(ablation_counts.Failed, match="found no instructions"):
        ablation_counts.total_of("events: Ir\nsummary: 0\n")


def test_scenes_that_need_the_omitted_effect_are_not_compared(monkeypatch: pytest.MonkeyPatch) -> None:
    whole: dict[str, dict[str, Any]] = {
        "lens": {"count": 10, "scenes": ["lens"]},
        "instances": {"count": 20, "scenes": ["instances", "moving instances"]},
        "moving instances": {"count": 30, "scenes": ["instances", "moving instances"]},
    }
    monkeypatch.setattr(ablation_counts, "effect_count", lambda bench, effect: {"count": 10, "scenes": []})
    assert ablation_counts.beside_counts(whole, Path("bench"), "moving instances") == {"lens": (10, 10)}
    counts = ablation_counts.beside_counts(whole, Path("bench"), "lens")
    assert counts == {"instances": (20, 10), "moving instances": (30, 10)}


def test_frames_of_other_effects_are_counted_and_what_differs_is_named() -> None:
    text = lines(
        {"lens": {"beside": {"curves": [100, 100], "points": [101, 100]}}, "opacity": {"beside": {"lens": [5, 5]}}}
    )
    assert row(text, "| lens", last=True) == "| lens | 1 of 2 | points +1.00% |"
    assert row(text, "| opacity", last=True) == "| opacity | 1 of 1 |  |"


def test_a_build_without_all_effects_has_a_row_of_its_own() -> None:
    text = lines({"lens": {}, "all at once": {"omitted": omitted()}})
    assert [line[:21] for line in text if line.startswith("| all")] == ["| all at once | equal"]


def test_effects_are_those_of_the_plan_and_of_the_option() -> None:
    """In one order everywhere, since CMake counts bits by it."""
    plan = (ROOT / "core/plan/effect_plan.cpp").read_text(encoding="utf-8")
    assert tuple(re.findall(r'\{Effect::k\w+, "([^"]+)"\}', plan)) == make_ablation.EFFECTS
    option = (ROOT / "cmake/OmitEffects.cmake").read_text(encoding="utf-8")
    found = re.search(r"set\(msbvh_effects ([^)]*)\)", option)
    assert found and found[1].split() == [make_ablation.option_name(effect) for effect in make_ablation.EFFECTS]


@pytest.mark.skipif(not make_ablation.BENCH.is_file(), reason="no bench in build/release; make setup makes it")
def test_the_bench_runs_the_named_effect_alone() -> None:
    """Names hold others: "instances" is a part of "moving instances"."""

    def run(effect: str) -> subprocess.CompletedProcess[str]:
        command = [make_ablation.BENCH, "effects", *ablation_counts.SMALL_FRAME, "1", effect]
        return subprocess.run(command, capture_output=True, text=True)

    assert [json.loads(line)["effect"] for line in run("instances").stdout.splitlines()] == ["instances"]
    done = run("instance")
    assert done.returncode == 1 and not done.stdout
    assert 'EFFECT: found "instance"; expected one that msbvh plan names' in done.stderr


def run_generator(*arguments: str, path: str | None = None) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, str(ROOT / "docs/make_ablation.py"), "--allow-dirty", *arguments]
    environment = os.environ if path is None else {**os.environ, "PATH": path}
    return subprocess.run(command, capture_output=True, text=True, env=environment)


def test_without_valgrind_one_line_says_so(tmp_path: Path) -> None:
    git = subprocess.run(["which", "git"], capture_output=True, text=True, check=True).stdout.strip()
    (tmp_path / "git").symlink_to(git)
    done = run_generator(path=str(tmp_path))
    assert done.returncode == 1
    assert done.stderr.startswith("make_ablation: error: valgrind: found none on PATH; expected it for")
    assert len(done.stderr.splitlines()) == 1


def test_an_unknown_effect_is_one_line() -> None:
    done = run_generator("--only", "fog")
    assert done.returncode == 1
    assert done.stderr.startswith("make_ablation: error: --only: found no effect that matches 'fog'; expected one of")


def test_an_unknown_name_stops_the_build(tmp_path: Path) -> None:
    script = tmp_path / "script.cmake"
    script.write_text(f'cmake_minimum_required(VERSION 3.22)\ninclude("{ROOT}/cmake/OmitEffects.cmake")\n')
    command = ["cmake", "-DMSBVH_OMIT_EFFECTS=fog", "-P", script]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode != 0
    assert "MSBVH_OMIT_EFFECTS: found fog; expected some of deforming-keys," in " ".join(done.stderr.split())


def test_rows_of_other_sources_are_not_kept(tmp_path: Path) -> None:
    path = tmp_path / "rows.json"
    make_ablation.Kept(path, "abc1234").add("lens", "on", ON)
    assert make_ablation.Kept(path, "abc1234").has("lens", "on")
    assert not make_ablation.Kept(path, "abc1234").has("lens", "omitted")
    assert not make_ablation.Kept(path, "def5678").has("lens", "on")
    assert not make_ablation.Kept(path, "abc1234").has("lens", "on")  # its binaries are replaced
    unsaved = make_ablation.Kept(path, None)
    unsaved.add("lens", "on", ON)
    assert unsaved.has("lens", "on") and not path.exists()


def test_rows_outlive_what_the_bench_is_not_compiled_from(monkeypatch: pytest.MonkeyPatch) -> None:
    def key(*files: str) -> str | None:
        monkeypatch.setattr(make_ablation, "output", lambda command: "".join(f"{file}\n" for file in files))
        return make_ablation.sources_key()

    monkeypatch.setattr(make_ablation.provenance, "changed_files", lambda: ["bench/README.md", "docs/accuracy.md"])
    first = key("1 bench/README.md", "2 bench/ablation.cpp")
    assert first and key("9 bench/README.md", "2 bench/ablation.cpp") == first
    assert key("1 bench/README.md", "9 bench/ablation.cpp") != first
    monkeypatch.setattr(make_ablation.provenance, "changed_files", lambda: ["bench/ablation.cpp"])
    assert key("1 bench/README.md", "2 bench/ablation.cpp") is None


def test_times_again_leave_the_rest_of_a_row(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    kept = make_ablation.Kept(tmp_path / "rows.json", "abc1234")
    kept.add("lens", "omitted", omitted())
    monkeypatch.setattr(make_ablation, "timed_pair", lambda whole, without, turn: (1.0, 2.0 + turn))
    make_ablation.time_again(["lens", "opacity"], argparse.Namespace(pairs=2), kept)
    found = make_ablation.Kept(tmp_path / "rows.json", "abc1234").rows
    assert list(found) == ["lens"]
    assert found["lens"]["omitted"]["seconds"] == [[1.0, 2.0], [1.0, 3.0]]
    assert found["lens"]["omitted"]["count"] == omitted()["count"]
