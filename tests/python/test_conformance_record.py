"""The recorded run: twice our own error fails, also where noise would explain it; other renderers go by noise alone."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from conftest import ROOT, Run
from msbvh.images import read_alpha

SUITE = ROOT / "testenv" / "motion"
SPP = 256


@pytest.mark.xfail(strict=True, reason="errors are held against noise alone")
def test_twice_our_error_fails(msbvh: Run, tmp_path: Path) -> None:
    from msbvh.conformance import image_of, judged, read_expected, read_rules
    from msbvh.conformance_record import read_record

    RECORD = read_record(SUITE, SPP)
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
