"""The suite itself: its answers are usd-core's, its scenes are what their authors write, and every rule tells
those who follow it from those who do not."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from msbvh.conform.record import read_record
from msbvh.conform.suite import Rule, allowed_errors, conform, errors, own_renderer, read_rules
from msbvh.output.images import read_alpha
from projection_oracle import Sampling, coverage
from pxr import Usd, UsdGeom
from soak import is_soak, soak_figure

SUITE = ROOT / "testenv" / "motion"
sys.path.insert(0, str(SUITE))

import make_expected
import make_scenes
from authoring import RULES, STILL

ENTRIES = make_expected.rules()
DISTINCTION = 3.0
"""How many times the allowed error a renderer is out that makes a rule's mistake."""


def test_the_manifest_lists_the_rules_that_are_written() -> None:
    written = json.loads(json.dumps([make_scenes.entry(rule) for rule in RULES.values()]))
    assert written == ENTRIES
    assert [rule.name for rule in read_rules(SUITE)] == list(RULES)
    files = {path.name for path in (SUITE / "scenes").iterdir() if path.is_file()}
    assert files == {f"{name}{suffix}" for name in RULES for suffix in (".usda", ".expected.png")}


def test_the_scenes_are_what_their_authors_write(tmp_path: Path) -> None:
    for rule in RULES.values():
        rule.write(tmp_path)
    for path in sorted(tmp_path.rglob("*.usda")):
        committed = SUITE / "scenes" / path.relative_to(tmp_path)
        assert path.read_text(encoding="utf-8") == committed.read_text(encoding="utf-8"), path.name


@pytest.mark.soak
def test_expected_answers_are_made_again() -> None:
    """Rounding may turn one sample of 8192 a pixel."""
    entries = ENTRIES if is_soak() else ENTRIES[::18]
    for entry in entries:
        again = make_expected.expected(entry, SUITE / entry["scene"])
        committed = read_alpha(SUITE / entry["expected"]) * 65535
        assert np.abs(again - committed).max() <= 65535 / (512 * 16) + 1, entry["rule"]
    soak_figure("expected answers", f"{len(entries)} made again")


@pytest.mark.slow
@pytest.mark.parametrize("rule", read_rules(SUITE), ids=lambda rule: rule.name)
def test_our_renderer_follows_the_rule(rule: Rule, tmp_path: Path) -> None:
    """Within what noise explains, and within three standard errors of the recorded run."""
    (outcome,) = conform([rule], own_renderer(256), 256, tmp_path, record=read_record(SUITE, 256))
    assert outcome.passed, outcome.reason


@pytest.mark.slow
@pytest.mark.parametrize("entry", ENTRIES, ids=lambda entry: entry["rule"])
def test_a_renderer_that_makes_the_mistake_fails(entry: dict, tmp_path: Path) -> None:
    rule = RULES[entry["rule"]]
    stage = Usd.Stage.Open(str(rule.write(tmp_path, mistaken=True)))
    if rule.mistake == STILL:
        camera = UsdGeom.Camera.Get(stage, rule.camera)
        camera.GetShutterOpenAttr().Set(0.0)
        camera.GetShutterCloseAttr().Set(0.0)
    expected = read_alpha(SUITE / entry["expected"])
    size = (entry["width"], entry["height"])
    mistaken = coverage(stage, entry["frames"][-1], rule.camera, size, Sampling(64, 4, subdivisions=4, round=True))
    error, _ = errors(mistaken, expected)
    allowed, _ = allowed_errors(expected, 256, rule.slack)
    assert error >= DISTINCTION * allowed
