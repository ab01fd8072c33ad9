"""The deliberate defects of tests/mutants.toml in one build, each against the test that must catch it.

Used by tests/python/test_mutants.py and make_stability.py. The build is -DMSBVH_MUTANTS=ON (cmake/switch_mutants.py says
what that does), and MSBVH_MUTANT names the defect that acts.
"""

from __future__ import annotations

import os
import re
import signal
import subprocess
import time
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
BUILD = ROOT / "build" / "mutants"
SECONDS = 600
"""A test that takes longer says nothing of its mutant."""


class MutantError(Exception):
    """A test is not there, or fails without a mutant."""


@dataclass(frozen=True)
class Mutant:
    """A text in a source file, what stands in its place where it acts, and the test that must fail then."""

    name: str
    file: str
    search: str
    replace: str
    test: tuple[str, str]
    """Executable without its `test_`, and the test case."""

    @property
    def target(self) -> str:
        return f"test_{self.test[0]}"


@dataclass(frozen=True)
class Verdict:
    """How a mutant's test ended with it: `failed`, `crashed (signal)`, `too long` or `passed`. The last two are survivors:
    a busy machine takes long, too."""

    mutant: Mutant
    result: str
    seconds: float

    @property
    def caught(self) -> bool:
        return self.result not in ("passed", "too long")


def read_mutants() -> list[Mutant]:
    """All entries, in their order."""
    entries = tomllib.loads((ROOT / "tests" / "mutants.toml").read_text(encoding="utf-8"))["mutant"]
    return [Mutant(**{**entry, "test": tuple(entry["test"])}) for entry in entries]


def build(mutants: Sequence[Mutant], folder: Path = BUILD) -> None:
    """The one build that has all of them."""
    options = ["-DCMAKE_BUILD_TYPE=Release", "-DMSBVH_BUILD_TESTS=ON", "-DMSBVH_MUTANTS=ON"]
    configure = ["cmake", "-S", str(ROOT), "-B", str(folder), "-G", "Ninja", *options]
    subprocess.run(configure, check=True, stdout=subprocess.DEVNULL)
    targets = sorted({mutant.target for mutant in mutants})
    subprocess.run(["cmake", "--build", str(folder), "--target", *targets], check=True, stdout=subprocess.DEVNULL)


def verdicts(mutants: Sequence[Mutant], folder: Path = BUILD) -> list[Verdict]:
    """Runs each mutant's test with it; first without any, where all of them must pass (else MutantError)."""
    for mutant in {mutant.test: mutant for mutant in mutants}.values():
        result, _ = run(mutant, "", folder)
        if result != "passed":
            raise MutantError(f"{mutant.target}, {mutant.test[1]!r}: {result} without a mutant")
    found = []
    for mutant in mutants:
        verdict = Verdict(mutant, *run(mutant, mutant.name, folder))
        print(f"{'caught' if verdict.caught else 'SURVIVES'}: {mutant.name}: {verdict.result}", flush=True)
        found.append(verdict)
    return found


def run(mutant: Mutant, name: str, folder: Path = BUILD) -> tuple[str, float]:
    """Its test, in the size that it has in `make test`, with the mutant `name` or, where that is empty, none."""
    case = mutant.test[1].replace("\\", "\\\\").replace(",", "\\,")
    environment = {key: value for key, value in os.environ.items() if not key.startswith("MSBVH_")}
    command = [str(folder / "tests" / mutant.target), f"--test-case={case}"]
    begin = time.monotonic()
    try:
        done = subprocess.run(
            command, timeout=SECONDS, env={**environment, "MSBVH_MUTANT": name}, capture_output=True, text=True
        )
    except subprocess.TimeoutExpired:
        return "too long", time.monotonic() - begin
    seconds = time.monotonic() - begin
    if done.returncode < 0:
        return f"crashed ({signal.Signals(-done.returncode).name})", seconds
    if done.returncode == 0 and re.search(r"test cases: +1 \| +1 passed", done.stdout):
        return "passed", seconds
    if re.search(r"test cases: +1 \| +0 passed \| +1 failed", done.stdout):
        return "failed", seconds
    raise MutantError(f"{mutant.target}, {mutant.test[1]!r}: expected one such test\n{done.stdout}{done.stderr}")
