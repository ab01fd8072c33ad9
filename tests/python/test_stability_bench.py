"""msbvh bench --stability, and what docs/make_stability.py makes of its report."""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from conftest import ROOT, Fails, Run
from msbvh import _core
from msbvh.base.errors import SceneError
from msbvh.bench.rays import find_peer
from msbvh.bench.stability import StabilitySettings, cells, per_million
from msbvh.bench.stability_table import table
from msbvh.cli.bench_command import wrong_row

sys.path.insert(0, str(ROOT / "docs"))
import make_stability
import stability_probes

QUICK = (
    "bench", "--stability", "--quick", "--json", "--scenes", "ball-129,cube-2,instances-3,displaced-2,tubes-129,points-2"
)  # fmt: skip


def has_embree() -> bool:
    try:
        return find_peer("embree").library.is_file()
    except SceneError:
        return False


# The command


def test_ours_leaks_nowhere_and_stands_alone_where_no_peer_is_asked_for(msbvh: Run, tmp_path: Path) -> None:
    done = msbvh(*QUICK, "--out", "kept")
    assert done.returncode == 0, done.stderr
    assert "no peer beside us" in done.stderr
    report = json.loads(done.stdout)
    assert report == json.loads((tmp_path / "kept" / "stability.json").read_text())
    rows = report["rows"]
    assert {row["shape"] for row in rows} == {"ball", "cube", "instances", "displaced", "tubes", "points"}
    assert {row["motion"] for row in rows if row["degenerate"]} == {"slivers at the centre"}
    assert all(row["rays"] >= 400 and row["judged"] >= 1 for row in rows)
    assert all(row["rays"] == sum(row[f"rays {aim}"] for aim in stability_probes.AIMS) for row in rows)
    assert all((row["leaks"], row["wrong"]) == (0, 0) for row in rows)
    assert all(row["peer_leaks"] is None and row["peer_wrong"] is None for row in rows)


@pytest.mark.skipif(not has_embree(), reason="the wheel embreex is not installed")
def test_embree_gets_the_same_rays(msbvh: Run) -> None:
    scenes = "ball-129,instances-3,tubes-129,points-2"
    done = msbvh("bench", "--stability", "--quick", "--json", "--scenes", scenes, "--peer", "embree")
    assert done.returncode == 0, done.stderr
    rows = json.loads(done.stdout)["rows"]
    assert all((row["peer_leaks"] is None) == (row["degree"] > 1) for row in rows)
    assert sum(row["peer_leaks"] or 0 for row in rows) > 0
    assert all((row["peer_wrong"] is None) == (row["degree"] > 1 or row["shape"] == "tubes") for row in rows)
    for row in rows:
        if row["peer_leaks"]:
            assert sum(row[f"peer_leaks {aim}"] for aim in stability_probes.AIMS) == row["peer_leaks"]
            assert row["peer_leaks_at_keys"] <= row["peer_leaks"]


def test_what_is_tried() -> None:
    every = cells(StabilitySettings())
    assert {cell[0] for cell in every} == set(_core.stability_shapes())
    assert {cell[1] for cell in every} == set(_core.stability_motions())
    assert {segments + 1 for _, _, segments, degree, _, _ in every if degree == 1} == {2, 3, 9, 17, 33, 129}
    assert {degree for _, _, _, degree, _, _ in every} == {1, 2, 3}
    assert {position for *_, position, _ in every} == {0, 1e2, 1e4, 1e6, 1e7}
    assert {1e-6, 1, 1e6} <= {scale for *_, scale in every}
    assert set(cells(StabilitySettings(quick=True))) < set(every)
    assert [cell for cell in every if cell[0] == "fine"] == [("fine", "flight", 128, 1, 1e4, 1.0)]
    degenerate = {
        cell[1]: cell for cell in every if cell[1] in ("slivers at the ends", "denormal keys", "near-equal keys")
    }
    assert len(degenerate) == 3
    assert {cell[0] for cell in every if cell[1] == "denormal keys"} == {"ball"}


def test_a_cell_that_cannot_be_is_refused() -> None:
    for cell in (("pear", "rotation", 1, 1, 0.0, 1.0), ("ball", "stroll", 1, 1, 0.0, 1.0)):
        with pytest.raises(_core.Error, match="expected one of"):
            _core.stability_run(cell, rays=60, seed=1, oracle_tests=1.0, peer="", peer_folder="")
    with pytest.raises(_core.Error, match="found degree 2"):
        _core.stability_run(
            ("displaced", "rotation", 2, 2, 0.0, 1.0), rays=60, seed=1, oracle_tests=1.0, peer="", peer_folder=""
        )


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        (("--scenes", "pear*"), 1, "matches nothing; expected globs of ball, dense, fine, shell"),
        (("--builder", "mbvh"), 2, "--builder and --stability exclude each other"),
        (("--threads", 1), 2, "--threads and --stability exclude each other"),
        (("--frames",), 2, "--stability and --frames exclude each other"),
        (("--peer", "cycles"), 2, "--peer cycles: found no --frames"),
    ],
)
def test_what_is_refused(fails: Fails, arguments: Sequence[object], code: int, message: str) -> None:
    fails(("bench", "--stability", *arguments), code, message)


# The page


def row(shape: str, keys: int, leaks: float, peer: float | None, **changed: Any) -> dict[str, Any]:
    found = {
        "shape": shape, "probe": "from inside", "motion": "rotation", "degenerate": False,
        "keys": keys, "degree": 1, "position": 1e4, "scale": 1.0, "rays": 6000,
        "rays_at_keys": 3000, "judged": 1000, "wrong": 0.0, "leaks": leaks, "leaks_at_keys": 0.0, "peer_leaks": peer,
        "peer_wrong": peer and 0.0, "peer_leaks_at_keys": peer and peer / 3,
    }  # fmt: skip
    of_rays = {f"rays {aim}": 1000 for aim in stability_probes.AIMS}
    of_aims = {f"leaks {aim}": leaks / 6 for aim in stability_probes.AIMS}
    of_peer = {f"peer_leaks {aim}": peer and peer / 6 for aim in stability_probes.AIMS}
    return found | of_rays | of_aims | of_peer | changed


def report(*rows: dict[str, Any], **machine: Any) -> dict[str, Any]:
    about = {
        "processor": "A processor", "instruction_set": "avx3", "msbvh": "0.1.0", "commit": "abc1234", "seed": 1,
        "peer": "Embree 4.4.0 (AVX-512)", "scenes": ["*"], "rays": 6000, "quick": False, "seconds": 120.0,
        "load_average": 1.2,
    }  # fmt: skip
    return {"machine": about | machine, "rows": list(rows)}


TWO = (row("ball", 2, 0.0, 0.0), row("cube", 129, 0.0, 60.0))


def test_both_columns_stand_in_the_page() -> None:
    text = stability_probes.section(report(*TWO))
    assert "| 10000 | 1 | 0, 0 | 0, 10,000 |" in text
    assert "Ours: 0 of 12,000 rays are lost, and 0 of 2,000 judged differ" in text
    assert "5,000 of a million rays get out of closed shapes, over all 2 rows" in text
    assert "Its worst other row: cube, rotation, 129 keys, position 10000, scale 1: 10,000 of a million." in text
    assert "It loses none with 2 keys." in text
    still = stability_probes.section(
        report(row("ball", 2, 0.0, 0.0), row("ball", 3, 0.0, 0.0), row("ball", 9, 0.0, 0.0))
    )
    assert "It loses none with 2, 3 and 9 keys." in still
    assert "it loses 3,333 of a million, at other times 6,667." in text
    assert "stands alone" not in text


def test_tubes_degenerate_motion_and_rays_of_one_aim_stand_apart_in_the_page() -> None:
    others = (
        row("tubes", 2, 0.0, 6.0, probe="into round", peer_wrong=None),
        row("ball", 2, 0.0, 12.0, motion="from a point", degenerate=True),
        row("fine", 129, 0.0, 1200.0, probe="from inside, plain", motion="flight"),
    )
    text = stability_probes.section(report(*TWO, *others))
    assert "5,000 of a million rays get out of closed shapes, over all 2 rows" in text
    assert "In degenerate motion: 2,000 of a million, over 1 rows." in text
    assert "Into nine bent tubes of two cubic spans each: 1,000 of a million." in text
    fine = "A closed ball of 39600 triangles, rays in any direction at any time (fine, flight, 129 keys, position 10000, scale 1)"
    assert f"{fine}: 200,000 of a million." in text
    assert "| in any direction | 0 | 4,000 |" in text
    assert "Ours: 0 of 30,000 rays are lost, and 0 of 5,000 judged differ" in text


def test_a_leak_of_ours_is_a_wrong_row_and_comes_first_in_the_page() -> None:
    leaking = row("ball", 2, 12.0, 0.0)
    assert wrong_row(leaking)
    assert wrong_row(row("ball", 2, 0.0, 0.0, wrong=1.0))
    assert not wrong_row(row("ball", 2, 0.0, 60.0, peer_wrong=5.0))
    text = stability_probes.section(report(leaking))
    assert "- **Ours is wrong**: ball, rotation, 2 keys, position 10000, scale 1: 12 of 6000 rays lost" in text
    assert "Ours: 0 of" not in text
    assert table(report(leaking)).splitlines()[-1].split()[:2] == ["all", "1"]


def test_without_embree_our_column_stands_alone() -> None:
    text = stability_probes.section(report(row("ball", 3, 0.0, None), peer=None))
    assert "**Embree was not found: our column stands alone.**" in text
    assert "| 10000 | 1 | 0, - |" in text
    assert per_million([row("ball", 3, 0.0, None)], "peer_leaks") is None


def test_reports_of_shapes_are_joined_if_they_are_of_one_commit() -> None:
    one, other = report(TWO[0], scenes=["ball"]), report(TWO[1], scenes=["cube"])
    both = stability_probes.joined([one, other])
    assert len(both["rows"]) == 2
    assert both["machine"]["seconds"] == 240.0
    assert "4.0 minutes in 2 runs at a load of up to 1." in stability_probes.section(both)
    with pytest.raises(ValueError, match="found commit abc1234 and fff0000"):
        stability_probes.joined([one, report(TWO[1], commit="fff0000")])


def test_a_section_is_made_anew_and_the_other_one_stays() -> None:
    first = make_stability.refreshed(None, {"probes": "## Rays\n\nold\n"})
    assert "old" in first
    assert "Not made yet: `python docs/make_stability.py --mutants`" in first
    second = make_stability.refreshed(first, {"mutants": "## Defects\n\n33\n"})
    assert "old" in second
    assert "33" in second
    assert "Not made" not in second
    third = make_stability.refreshed(second, {"probes": "## Rays\n\nnew\n"})
    assert ("old" in third, "new" in third, "33" in third) == (False, True, True)
    found = make_stability.refreshed(third, {"mutants": "## Defects\n\n36 of 37 are caught. All are in one build.\n"})
    assert found.index("- Deliberate defects: 36 of 37 are caught by the test named for them.") < found.index("## Rays")
    assert (
        stability_probes.section(report(*TWO)).splitlines()[6]
        in make_stability.refreshed(found, {"probes": stability_probes.section(report(*TWO))}).partition("<!-- probes")[
            0
        ]
    )
    with pytest.raises(make_stability.PageError, match="found no section between"):
        make_stability.refreshed("# Another page\n", {})
