"""Public scenes that are absent: their tests are skipped and say which, or fail with MSBVH_REQUIRE_SHARED=1."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import ROOT

TESTS = ROOT / "tests" / "python"
READERS = sorted(
    path.name
    for path in TESTS.glob("test_*.py")
    if re.search(r"^from (shared_scenes|alpha_references) import", path.read_text(encoding="utf-8"), re.MULTILINE)
)


@pytest.fixture(scope="module")
def elsewhere(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The tests that read public scenes, in a checkout that has none beside it."""
    checkout = tmp_path_factory.mktemp("without") / "checkout"
    shutil.copytree(TESTS, checkout / "tests" / "python", ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "pyproject.toml", checkout)
    return checkout


def outcomes(checkout: Path, required: str) -> tuple[set[str], set[str], str]:
    """The files with a test that passed or was skipped, those with one that failed, and what pytest said."""
    command = (sys.executable, "-m", "pytest", "-q", "-rA", "-m", "shared", "-p", "no:cacheprovider")
    done = subprocess.run(
        (*command, *(f"tests/python/{name}" for name in READERS)),
        cwd=checkout,
        env={**os.environ, "MSBVH_REQUIRE_SHARED": required},
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    files = {
        word: set(re.findall(rf"^{word}\b.*?tests/python/(test_\w+\.py)", done.stdout, re.MULTILINE))
        for word in ("PASSED", "SKIPPED", "FAILED", "ERROR")
    }
    return files["PASSED"] | files["SKIPPED"], files["FAILED"] | files["ERROR"], done.stdout


def test_every_reader_of_public_scenes_is_here() -> None:
    assert len(READERS) >= 9


def test_absent_scenes_fail_where_they_are_required(elsewhere: Path) -> None:
    others, failed, said = outcomes(elsewhere, "1")
    assert (others, failed) == (set(), set(READERS)), said
    assert "expected the public scenes beside the checkout" in said


def test_absent_scenes_are_skipped_by_name_elsewhere(elsewhere: Path) -> None:
    skipped, failed, said = outcomes(elsewhere, "0")
    assert failed == set(), said
    assert "PASSED" not in said and skipped
    reasons = set(re.findall(r"^SKIPPED \[\d+\] \S+ (.*)$", said, re.MULTILINE))
    assert all(re.fullmatch(r"no .*/shared/scenes\S* on this machine", reason) for reason in reasons), reasons
