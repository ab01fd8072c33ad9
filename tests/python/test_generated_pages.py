"""What docs/make_performance.py makes of a report, and that a page is of a commit that reproduces it."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from conftest import ROOT

sys.path.insert(0, str(ROOT / "docs"))
import make_performance
import performance_frames
import provenance

MACHINE = {
    "processor": "A processor", "cores": 2, "system": "Linux", "instruction_set": "avx3", "msbvh": "0.1.0",
    "commit": "abc1234", "peer": "Embree 4.4.0 (AVX-512)", "threads": [1], "builders": [], "seed": 1, "repetitions": 5,
    "quick": False, "scenes": ["*"], "triangles": 100000, "load_average": 0.0, "seconds": 120.0,
}  # fmt: skip


def row(scene: str, kind: str, ratio: float, spread: tuple[float, float], **changed: Any) -> dict[str, Any]:
    return {
        "scene": scene, "triangles": 1000, "keys": 1, "degree": 1, "rays": kind, "builder": "msbvh", "threads": 1,
        "robust": True, "mrays": 2.0, "mrays_low": 1.9, "mrays_high": 2.1, "single_mrays": 1.25, "peer_mrays": 2.5,
        "peer_mode": "packet_coherent", "peer_single_mrays": 1.5, "peer_packet_coherent_mrays": 2.5,
        "peer_packet_incoherent_mrays": 1.75, "ratio": ratio, "ratio_low": spread[0], "ratio_high": spread[1],
        "single_ratio": 0.83, "bytes_per_tri": 50.0, "node_bytes_per_tri": 10.0, "leaf_bytes_per_tri": 40.0,
        "vertex_bytes_per_tri": 0.0, "peer_bytes_per_tri": 60.0, "peer_keys": 1.0, "build_s": 0.1, "topology_s": 0.1,
        "bounds_s": 0.0, "peer_build_s": 0.05, "duplication": 1.0, "sah": 10.0, "nodes_per_ray": 5.0,
        "tests_per_ray": 5.0, "misses": 0.0, "peer_misses": 0.0, "mismatches": 0, "mode_mismatches": 0,
        "oracle_rays": 100, "peer_mismatches": 0.0, "ray_count": 1000,
    } | changed  # fmt: skip


def page(machine: dict[str, Any], *rows: dict[str, Any]) -> str:
    return "\n".join(make_performance.page({"machine": machine, "rows": list(rows)}))


@pytest.fixture(autouse=True)
def no_plot(monkeypatch: pytest.MonkeyPatch) -> None:
    """The checkout's own picture stays as it is."""
    monkeypatch.setattr(make_performance, "plot", lambda ours, path: False)


ROWS = (
    row("still", "primary", 0.8, (0.79, 0.81)),
    row("still", "shadow", 0.97, (0.9, 1.1)),
    row("still", "random", 1.5, (1.4, 1.6), peer_mode="single"),
)


def test_every_mode_stands_in_the_table_and_slower_cells_are_marked() -> None:
    text = page(MACHINE, *ROWS)
    assert "| still | 1000 | 1 | 1.25 | 2.00 | 1.50 | *2.50* | 1.75 | **0.80** [0.79, 0.81] *slower* | 0.83 |" in text
    assert "**0.97** [0.90, 1.10] *slower, perhaps* |" in text
    assert "| still | 1000 | 1 | 1.25 | 2.00 | *1.50* | 2.50 | 1.75 | **1.50** [1.40, 1.60] | 0.83 |" in text
    assert "## Where we are slower, 1 thread: 2 of 3 cells" in text
    listed = [line for line in text.splitlines() if line.startswith("- still")]
    assert [line.split(":")[0] for line in listed] == ["- still, 1 key, primary rays", "- still, 1 key, shadow rays"]


def test_the_head_says_what_is_compared() -> None:
    text = page(MACHINE, *ROWS)
    for said in (
        "Embree 4.4.0 (AVX-512)",
        "(abc1234)",
        "avx3",
        "rtcIntersect16",
        "robust flag",
        "2 minutes",
        "A processor",
    ):
        assert said in text
    assert "uncommitted" not in text
    assert "shared" not in text
    assert "Make this page\nagain on a quiet one" in page({**MACHINE, "load_average": 9.0}, *ROWS)
    assert "`msbvh bench --peer embree --triangles 100000 --threads 1`" in text
    chosen = {"builders": ["mbvh"], "repetitions": 3, "seed": 2, "scenes": ["room"]}
    assert "--scenes room --triangles 100000 --threads 1 --builder mbvh --seed 2 --repetitions 3`" in page(
        {**MACHINE, **chosen}, *ROWS
    )
    assert "uncommitted changes" in page({**MACHINE, "commit": "abc1234-dirty"}, *ROWS)


def test_without_a_peer_the_page_has_our_figures() -> None:
    nothing = dict.fromkeys(("ratio", "ratio_low", "ratio_high", "single_ratio", "peer_mrays", "peer_bytes_per_tri"))
    alone = [{**found, **nothing, "peer_keys": None, "peer_build_s": None, "peer_mismatches": None} for found in ROWS]
    text = page({**MACHINE, "peer": None}, *alone)
    assert "| still | 1000 | 1 | 1.25 | 2.00 |\n" in text
    assert "no peer" in text


FRAME_MACHINE = {
    "processor": "A processor", "cores": 2, "commit": "abc1234",
    "sides": {"msbvh": "msbvh 0.1.0", "cycles": "Cycles of Blender 5"},
    "resolution": [480, 320], "spp": 128, "reference_spp": 2048, "max_bounces": 2, "seed": 1, "repetitions": 3, "quick": False,
    "scenes": ["*"], "looks": ["displayColor"], "threads": [1], "load_average": 0.0, "seconds": 7200.0,
}  # fmt: skip


def frame_row(scene: str, side: str, trace: float | None, **changed: Any) -> dict[str, Any]:
    keys = ("trace_ratio", "process_ratio", "cpu_ratio", "trace_mse_ratio", "process_mse_ratio")
    ratios = dict.fromkeys(keys, trace)
    spread = {f"{key}_{end}": trace for key in keys for end in ("low", "high")}
    return {
        "scene": scene, "look": "displayColor", "says": "it moves", "threads": 1, "side": side, "read_s": 0.5, "build_s": 0.25,
        "trace_s": 4.0, "cpu_s": 5.2, "process_s": 5.5, "start_s": 0.5, "memory_bytes": 200 << 20,
        "relative_mse": 0.00125, "reference_share": 0.06,
        "mean_difference": None, "shape_difference": None, "comparable": None, **ratios, **spread,
    } | changed  # fmt: skip


def alike(comparable: bool) -> dict[str, Any]:
    return {"mean_difference": 0.001, "shape_difference": 0.004 if comparable else 0.05, "comparable": comparable}


def frames_page(*rows: dict[str, Any]) -> str:
    return "\n".join(performance_frames.section({"machine": FRAME_MACHINE, "rows": list(rows)}))


def test_looks_of_frames_are_named_and_have_means_of_their_own() -> None:
    rows = [
        frame_row("rotor", "cycles", ratio, look=look, **alike(True))
        for look, ratio in (("metal", 3.0), ("textured", 5.0))
    ]
    report = {"machine": {**FRAME_MACHINE, "looks": ["metal", "textured"]}, "rows": rows}
    text = "\n".join(performance_frames.section(report))
    assert "| rotor, metal | cycles |" in text and "| rotor, textured | cycles |" in text
    assert "1 scenes, metal, 1 thread: trace 3.00" in text and "1 scenes, textured, 1 thread: trace 5.00" in text
    assert "--looks metal,textured" in text
    both = performance_frames.joined([report, {"machine": FRAME_MACHINE, "rows": []}])
    assert both["machine"]["looks"] == ["metal", "textured", "displayColor"]


def test_whole_frames_have_a_section() -> None:
    ours = [frame_row(scene, "msbvh", None) for scene in ("rotor", "cloth")]
    text = frames_page(
        *ours, frame_row("rotor", "cycles", 2.0, **alike(True)), frame_row("cloth", "cycles", 8.0, **alike(True))
    )
    assert "| rotor | msbvh | 0.50 | 0.25 | 4.00 | 5.50 | 0.50 | 5.20 | 200 | 1.25e-03 | - | - | - | - | - |" in text
    assert "| 1.25e-03 | **2.00** [2.00, 2.00] | **2.00** [2.00, 2.00] |" in text
    assert "- cycles over ours, geometric mean of 2 scenes, displayColor, 1 thread: trace 4.00, process 4.00, " in text
    assert "| rotor | it moves | cycles | 0.10% | 0.40% | alike |" in text
    for said in ("2048 samples", "at most 6% of an error", "Diffuse BSDF", "120 minutes", "--peer cycles --threads 1"):
        assert said in text


def test_a_void_comparison_has_no_ratio_and_no_mean() -> None:
    ours = [frame_row(scene, "msbvh", None) for scene in ("rotor", "cloth")]
    text = frames_page(
        *ours, frame_row("rotor", "cycles", 2.0, **alike(True)), frame_row("cloth", "cycles", None, **alike(False))
    )
    assert "| *void* | *void* | *void* | *void* |" in text
    assert "| cloth | it moves | cycles | 0.10% | 5.00% | **void** |" in text
    assert "geometric mean" not in text


def test_a_report_of_a_dirty_tree_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "bench.json"
    path.write_text(json.dumps({"machine": {"commit": "abc1234-dirty"}, "rows": []}))
    with pytest.raises(provenance.DirtyTree, match="expected one of a clean tree"):
        make_performance.of_file(path, allow_dirty=False)
    assert make_performance.of_file(path, allow_dirty=True)["rows"] == []


def test_the_commit_of_a_provenance_only(tmp_path: Path) -> None:
    def git(*arguments: str) -> str:
        who = ("-c", "user.name=t", "-c", "user.email=t@example.org")
        return subprocess.run(
            ["git", "-C", tmp_path, *who, *arguments], check=True, capture_output=True, text=True
        ).stdout

    git("init", "-q")
    (tmp_path / "source.cpp").write_text("int a;\n")
    git("add", ".")
    git("commit", "-qm", "first")
    short = git("rev-parse", "--short", "HEAD").strip()
    assert provenance.commit(tmp_path) == short
    (tmp_path / "docs").mkdir()
    (tmp_path / "docs" / "performance.md").write_text("generated\n")
    git("add", ".")
    assert provenance.commit(tmp_path) == short  # one page after another
    (tmp_path / "new.cpp").write_text("int b;\n")
    with pytest.raises(provenance.DirtyTree, match=r"new\.cpp"):
        provenance.commit(tmp_path)
    assert provenance.commit(tmp_path, allow_dirty=True) == f"{short}-dirty"
