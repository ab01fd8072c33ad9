"""Deliberate defects (tests/mutants.toml): each is caught by the test that is named beside it."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import tomllib
from dataclasses import dataclass
from pathlib import Path

import pytest
from conftest import ROOT
from soak import is_soak, soak_figure

WORK = ROOT / "build" / "soak" / "mutants"
SECONDS = 600
"""A test that takes longer has caught its mutant: the same test passes in seconds."""


@dataclass(frozen=True)
class Mutant:
    """A text in a file of the core, what stands in its place, and the test that must fail then."""

    name: str
    file: str
    search: str
    replace: str
    test: tuple[str, str]

    @property
    def target(self) -> str:
        return f"test_{self.test[0]}"


def mutants() -> list[Mutant]:
    entries = tomllib.loads((ROOT / "tests" / "mutants.toml").read_text(encoding="utf-8"))["mutant"]
    return [Mutant(**{**entry, "test": tuple(entry["test"])}) for entry in entries]


@pytest.mark.soak
def test_each_mutant_is_caught() -> None:
    """`make test` has no time to build the core a dozen times: it only sees that each can be made."""
    every = mutants()
    for mutant in every:
        expect_place(mutant)
    if is_soak():
        survivors = survivors_of(every)
        soak_figure("mutants", f"{len(every) - len(survivors)} of {len(every)} caught")
        assert not survivors


def expect_place(mutant: Mutant) -> None:
    """Its text occurs once, and its test exists."""
    text = (ROOT / mutant.file).read_text(encoding="utf-8")
    assert text.count(mutant.search) == 1, f"{mutant.file}: expected once: {mutant.search}"
    assert mutant.replace not in text, f"{mutant.file}: found the defect itself: {mutant.replace}"
    sources = (ROOT / "tests" / mutant.test[0]).glob("*.cpp")
    assert any(f'"{mutant.test[1]}"' in path.read_text(encoding="utf-8") for path in sources), mutant.test


def survivors_of(every: list[Mutant]) -> list[str]:
    """The names of those that their tests do not catch."""
    source, build = WORK / "source", WORK / "release"
    copy_checkout(source)
    configure(source, build)
    make(build, *{mutant.target for mutant in every})
    for mutant in every:
        assert passes(build, mutant), f"{mutant.test} fails without a mutant"
    return [mutant.name for mutant in every if survives(source, build, mutant)]


def copy_checkout(target: Path) -> None:
    """The checkout's files as they are; those that have not changed keep their time, so that little is built."""
    listed = subprocess.run(["git", "-C", ROOT, "ls-files", "-z"], check=True, capture_output=True, text=True).stdout
    for name in filter(None, listed.split("\0")):
        path = target / name
        if not (ROOT / name).is_file() or (path.is_file() and path.read_bytes() == (ROOT / name).read_bytes()):
            continue
        path.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(ROOT / name, path)


def configure(source: Path, build: Path) -> None:
    command = [
        "cmake",
        "-S",
        source,
        "-B",
        build,
        "-G",
        "Ninja",
        "-DCMAKE_BUILD_TYPE=Release",
        "-DMSBVH_BUILD_TESTS=ON",
    ]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)


def make(build: Path, *targets: str) -> None:
    subprocess.run(["cmake", "--build", build, "--target", *sorted(targets)], check=True)


def passes(build: Path, mutant: Mutant) -> bool:
    """Whether its test passes, in the size that it has in `make test`."""
    escaped = mutant.test[1].replace("\\", "\\\\").replace(",", "\\,")
    command = [build / "tests" / mutant.target, f"--test-case={escaped}"]
    environment = {name: value for name, value in os.environ.items() if not name.startswith("MSBVH_SOAK")}
    try:
        done = subprocess.run(command, timeout=SECONDS, env=environment, capture_output=True, text=True)
    except subprocess.TimeoutExpired:
        return False
    assert done.returncode or re.search(r"test cases: +1 \| +1 passed", done.stdout), (
        f"{mutant.test}: found no such test"
    )
    return done.returncode == 0


def survives(source: Path, build: Path, mutant: Mutant) -> bool:
    """Whether the test passes with the defect; the source is as before afterwards."""
    path = source / mutant.file
    sound = path.read_text(encoding="utf-8")
    try:
        path.write_text(sound.replace(mutant.search, mutant.replace), encoding="utf-8")
        make(build, mutant.target)
        found = passes(build, mutant)
    finally:
        path.write_text(sound, encoding="utf-8")
    print(f"{'SURVIVES' if found else 'caught'}: {mutant.name}", flush=True)
    return found
