"""The recorded run: twice our own error fails, also where noise would explain it; other renderers are held to
noise alone."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from conftest import ROOT, Run
from msbvh.conform.record import HALF_STEP, Recorded, read_record
from msbvh.conform.suite import image_of, judged, read_expected, read_rules
from msbvh.output.images import read_alpha
from test_conform import fake, outcomes

SUITE = ROOT / "testenv" / "motion"
SPP = 256
RECORD = read_record(SUITE, SPP)


def test_every_rule_is_recorded() -> None:
    """Where one is not: python testenv/motion/make_recorded.py RULE."""
    assert list(RECORD) == [rule.name for rule in read_rules(SUITE)]


@pytest.mark.parametrize("name", RECORD)
def test_an_error_that_doubles_is_beyond_the_record(name: str) -> None:
    recorded = RECORD[name]
    assert recorded.standard_error >= 0
    assert 2 * recorded.error > recorded.allowed or recorded.error <= HALF_STEP


def test_twice_our_error_fails(msbvh: Run, tmp_path: Path) -> None:
    done = msbvh("conform", "--rules", "rotate_op", "--json", "--out", tmp_path)
    (entry,) = json.loads(done.stdout)["rules"]
    assert entry["passed"] and entry["error"] <= entry["recorded_allowed"] < entry["allowed"]

    (rule,) = read_rules(SUITE, "rotate_op")
    _, image = image_of(rule, tmp_path / rule.name)
    expected, recorded = read_expected(rule), RECORD[rule.name]
    found = read_alpha(image)
    assert judged(rule, found, expected, SPP, recorded).passed
    doubled = judged(rule, expected + 2 * (found - expected), expected, SPP, recorded)
    assert not doubled.passed and "recorded" in doubled.reason
    assert doubled.error is not None and doubled.error < doubled.allowed  # noise would let it pass
    assert judged(rule, expected + 2 * (found - expected), expected, SPP).passed


def test_another_renderer_is_held_to_noise_alone(msbvh: Run, tmp_path: Path) -> None:
    body = "alpha = expected(scene); write(image, np.where((alpha > 0) & (alpha < 1), alpha + 0.01, alpha))"
    code, found = outcomes(msbvh, fake(tmp_path, body), "rotate_op")
    assert code == 0
    assert found["rotate_op"]["error"] > RECORD["rotate_op"].allowed
    assert found["rotate_op"]["recorded"] is None and found["rotate_op"]["recorded_allowed"] is None


def test_the_record_is_for_its_samples_a_pixel() -> None:
    assert read_record(SUITE, SPP // 2) == {}


def test_a_sharp_rule_may_be_out_by_what_the_expected_image_rounds() -> None:
    assert Recorded(0.0, 0.0).allowed == HALF_STEP
    assert Recorded(0.003, 1e-4).allowed == pytest.approx(0.0033)


def test_a_broken_record_is_one_line(msbvh: Run, tmp_path: Path) -> None:
    shutil.copy(SUITE / "rules.json", tmp_path)
    (tmp_path / "recorded.json").write_text('{"spp": 256}')
    done = msbvh("conform", "--suite", tmp_path, "--rules", "rotate_op")
    assert done.returncode == 1 and done.stderr.count("\n") == 1
    assert "recorded.json: found KeyError" in done.stderr
