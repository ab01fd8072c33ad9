"""The long checks, found where they are written, and one of them run in a process of its own.

C++: test cases of the suite "slow" whose names begin with "soak: " (tests/support/soak.h). Python: tests with the marker
`soak` (tests/python/soak.py). The C++ tests, as `make test` runs them, in builds with sanitizers and the kernels of
every instruction set. And each fuzz target for two minutes (run_fuzz.py).
"""

from __future__ import annotations

import hashlib
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree import ElementTree

import run_fuzz

PREFIX = "soak: "
BEAT_SECONDS = 60.0
"""How often a running check is heard of."""
SANITIZERS = {"asan": "AddressSanitizer and UndefinedBehaviorSanitizer", "tsan": "ThreadSanitizer"}
"""Presets of CMakePresets.json."""
FUZZ_SECONDS = 120
"""For each target."""
GRACE_SECONDS = 10.0
"""What a process gets to clean up before it is killed."""


class SoakError(Exception):
    """The checks cannot be found or run."""


@dataclass(frozen=True)
class Check:
    """A long check: `name` as in docs/soak.md, and the command that runs it alone."""

    name: str
    command: tuple[str, ...]
    ran: re.Pattern[str]
    """What its output contains where it has passed, and not only been skipped."""

    @property
    def slug(self) -> str:
        """A file name for it."""
        words = re.sub(r"[^A-Za-z0-9]+", "-", self.name).strip("-")[:60]
        return f"{words}-{hashlib.sha256(self.name.encode()).hexdigest()[:8]}"


@dataclass
class Outcome:
    """How a run of a check ended."""

    result: str
    """`passed`, or what went wrong in a few words."""
    seconds: float
    figures: list[str] = field(default_factory=list)

    @property
    def passed(self) -> bool:
        return self.result == "passed"


def find_checks(root: Path, build: Path) -> list[Check]:
    """All of them. Raises SoakError where the tests are not built or cannot be collected."""
    executables = sorted(
        path for path in (build / "tests").glob("test_*") if os.access(path, os.X_OK) and path.is_file()
    )
    if not executables:
        raise SoakError(f"{build / 'tests'}: found no tests; expected a build with them: make setup")
    found = [check for executable in executables for check in _doctest_checks(executable)]
    fuzzed = [_fuzzed(target.name) for target in run_fuzz.targets()]
    return found + _pytest_checks(root) + [_sanitized(preset) for preset in SANITIZERS] + fuzzed


def _doctest_checks(executable: Path) -> list[Check]:
    arguments = ["--reporters=xml", "--list-test-cases", "--test-suite=slow", f"--test-case={PREFIX}*"]
    cases = ElementTree.fromstring(_output([str(executable), *arguments])).iter("TestCase")
    kind = executable.name.removeprefix("test_")
    return [_doctest_check(executable, kind, case.attrib["name"]) for case in cases]


def _doctest_check(executable: Path, kind: str, case: str) -> Check:
    escaped = case.replace("\\", "\\\\").replace(",", "\\,")
    command = (str(executable), "--test-suite=slow", f"--test-case={escaped}")
    return Check(f"{kind}: {case.removeprefix(PREFIX)}", command, re.compile(r"test cases: +1 \| +1 passed"))


def _pytest_checks(root: Path) -> list[Check]:
    pytest = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "-m", "soak", "-q"]
    listed = _output([*pytest, "--collect-only", str(root / "tests" / "python")], cwd=root, none=5).splitlines()
    ids = [line for line in listed if "::" in line]
    ran = re.compile(r"^1 passed", re.MULTILINE)
    return [Check(i.removeprefix("tests/python/"), (*pytest, i), ran) for i in ids]


def _sanitized(preset: str) -> Check:
    """Builds the C++ tests and runs them, the long checks' samples among them."""
    steps = [
        f"cmake --preset {preset}",
        f"cmake --build --preset {preset}",
        f"env -u MSBVH_SOAK -u MSBVH_SOAK_FIGURES ctest --preset {preset}",
    ]
    name = f"sanitizers: every C++ test under {SANITIZERS[preset]}, all instruction sets"
    return Check(name, ("sh", "-c", " && ".join(steps)), re.compile(r"^100% tests passed", re.MULTILINE))


def _fuzzed(target: str) -> Check:
    script = str(Path(run_fuzz.__file__).resolve())
    command = (sys.executable, script, "--seconds", str(FUZZ_SECONDS), "--only", target)
    return Check(f"fuzz: {target}", command, re.compile(rf"^fuzz {target}: .*; no defect$", re.MULTILINE))


def _output(command: Sequence[str], *, cwd: Path | None = None, none: int = 0) -> str:
    """Standard output. `none`: the exit code that says that there is nothing to list."""
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True)
    if done.returncode not in (0, none):
        raise SoakError(
            f"{' '.join(command)}: exit code {done.returncode}: {(done.stdout + done.stderr).strip()[-2000:]}"
        )
    return done.stdout


def run_check(
    check: Check, root: Path, log: Path, limit_seconds: float, say: Callable[[str], None], stopped: Callable[[], bool]
) -> Outcome:
    """Runs it whole, its output in `log`. Raises KeyboardInterrupt when `stopped` says so."""
    figures = log.with_suffix(f".{os.getpid()}.figures")
    environment = {**os.environ, "MSBVH_SOAK": "1", "MSBVH_SOAK_FIGURES": str(figures)}
    begin = time.monotonic()
    try:
        with log.open("wb") as out:
            process = subprocess.Popen(
                check.command, cwd=root, env=environment, stdout=out, stderr=subprocess.STDOUT, start_new_session=True
            )
            code = _wait(process, check, begin + limit_seconds, say, stopped)
        seconds = time.monotonic() - begin
        result = _result(check, code, log.read_text(encoding="utf-8", errors="replace"), limit_seconds)
        return Outcome(result, seconds, _figures(figures))
    finally:
        figures.unlink(missing_ok=True)


def _wait(
    process: subprocess.Popen[bytes],
    check: Check,
    end: float,
    say: Callable[[str], None],
    stopped: Callable[[], bool],
) -> int | None:
    """The exit code; None: the time was up."""
    begin = beat = time.monotonic()
    try:
        while (code := process.poll()) is None:
            now = time.monotonic()
            if stopped():
                raise KeyboardInterrupt
            if now > end:
                return None
            if now - beat >= BEAT_SECONDS:
                say(f"{check.name}: running for {now - begin:.0f} s")
                beat = now
            time.sleep(0.1)
        return code
    finally:
        _end(process)


def _end(process: subprocess.Popen[bytes]) -> None:
    """Ends it and the processes that it started."""
    for number in (signal.SIGTERM, signal.SIGKILL):
        try:
            os.killpg(process.pid, number)
        except ProcessLookupError:
            break
        try:
            process.wait(GRACE_SECONDS)
        except subprocess.TimeoutExpired:
            continue
    process.wait()


def _result(check: Check, code: int | None, output: str, limit_seconds: float) -> str:
    if code is None:
        return f"not done in {limit_seconds:.0f} s"
    if code < 0:
        return f"killed by {signal.Signals(-code).name}"
    if code != 0:
        return f"failed, exit code {code}"
    if not check.ran.search(output):
        return "did not pass: skipped, or expected to fail"
    return "passed"


def _figures(path: Path) -> list[str]:
    """`check<TAB>figure` lines as `check: figure`."""
    if not path.is_file():
        return []
    lines = path.read_text(encoding="utf-8").splitlines()
    return [line.replace("\t", ": ", 1) for line in lines if line.strip()]
