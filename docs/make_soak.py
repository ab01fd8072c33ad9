"""Runs every long check whole and writes what it found to docs/soak.md: `make soak`.

    python docs/make_soak.py [--list] [--only GLOB]... [--jobs N] [--timeout SECONDS] [--allow-dirty]

Each check is a process of its own; its output is in build/soak/COMMIT/. A check that has passed is remembered by commit:
a run that was interrupted, even killed, goes on where it was when it is started again. A failed one is run again, and
the page says how often it had failed before. Exit code 0 if all have passed, 1 if one has not, 130 or 143 if stopped.
"""

from __future__ import annotations

import argparse
import fnmatch
import json
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass, field
from datetime import UTC, datetime
from pathlib import Path

import provenance
from soak_checks import Check, Outcome, SoakError, find_checks, run_check
from soak_page import Entry, Run, write_run

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "soak.md"
BUILD = ROOT / "build" / "release"
MEMORY = ROOT / "build" / "soak"
LIMIT_SECONDS = 3 * 3600.0


@dataclass(frozen=True)
class Settings:
    """Where a run keeps what, and how it runs."""

    commit: str
    memory: Path
    page: Path = PAGE
    root: Path = ROOT
    jobs: int = 1
    limit_seconds: float = LIMIT_SECONDS
    only: tuple[str, ...] = ()
    still_at: Callable[[], str] | None = None
    """The commit now: a run ends where the tree changes under it. None: not asked."""


@dataclass
class Remembered:
    """What is known of a check at a commit."""

    outcome: Outcome | None = None
    failures: list[str] = field(default_factory=list)


class Stop:
    """Set by SIGINT, SIGTERM and SIGHUP."""

    def __init__(self) -> None:
        self.signal = 0
        self.event = threading.Event()

    def install(self) -> None:
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, self.set)

    def set(self, number: int, _frame: object = None) -> None:
        self.signal = number
        self.event.set()


def main() -> int:
    options = argument_parser().parse_args()
    stop = Stop()
    stop.install()
    try:
        checks = selected(find_checks(ROOT, BUILD), options.only)
        commit = provenance.commit(allow_dirty=options.allow_dirty or options.list)
        settings = Settings(
            commit, MEMORY / commit, jobs=options.jobs, limit_seconds=options.timeout, only=tuple(options.only),
            still_at=lambda: provenance.commit(allow_dirty=options.allow_dirty),
        )  # fmt: skip
        if options.list:
            show(checks, settings)
            return 0
        if commit.endswith("-dirty"):
            forget(settings.memory)  # it may have been of other changes
        return run(checks, settings, stop)
    except (SoakError, provenance.DirtyTree) as error:
        print(f"soak: error: {error}", file=sys.stderr)
        return 1


def argument_parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description="Runs every long check whole; writes docs/soak.md.")
    parser.add_argument("--list", action="store_true", help="show the checks and what is remembered of them")
    parser.add_argument("--only", action="append", default=[], metavar="GLOB", help="only checks of such names")
    parser.add_argument("--jobs", type=int, default=1, help="how many at once; most use every core; default: 1")
    parser.add_argument("--timeout", type=float, default=LIMIT_SECONDS, metavar="SECONDS", help="for each check")
    parser.add_argument("--allow-dirty", action="store_true", help="mark uncommitted changes, don't refuse them")
    return parser


def selected(checks: Sequence[Check], only: Sequence[str]) -> list[Check]:
    """Those that a glob matches; all without globs. Raises SoakError for none."""
    found = [check for check in checks if not only or any(fnmatch.fnmatch(check.name, glob) for glob in only)]
    if not found:
        known = "; ".join(check.name for check in checks) or "none"
        raise SoakError(f"found no check for {', '.join(only) or 'this tree'}; the checks are: {known}")
    return found


def show(checks: Sequence[Check], settings: Settings) -> None:
    for check in checks:
        outcome = recall(check, settings).outcome
        print(f"{outcome.result if outcome else 'not run':10}  {check.name}")


def run(checks: Sequence[Check], settings: Settings, stop: Stop) -> int:
    """Runs those that have not passed at this commit; then writes the page. Returns the exit code."""
    settings.memory.mkdir(parents=True, exist_ok=True)
    begin = datetime.now(UTC)
    waiting = [check for check in checks if not passed(check, settings)]
    say(f"{len(checks)} checks of {settings.commit}; {len(checks) - len(waiting)} have passed before")
    with ThreadPoolExecutor(settings.jobs) as pool:
        numbered = enumerate(waiting, len(checks) - len(waiting) + 1)
        for _ in pool.map(lambda it: run_one(it[1], f"{it[0]}/{len(checks)}", settings, stop), numbered):
            pass
    if stop.event.is_set():
        say("stopped; the same command goes on from here")
        return 128 + stop.signal
    entries = list(entries_of(checks, settings))
    write_run(settings.page, Run(settings.commit, begin, settings.only, entries))
    failed = [entry.name for entry in entries if not entry.outcome.passed]
    say(f"{len(entries) - len(failed)} passed, {len(failed)} failed; see {settings.page}")
    return 1 if failed else 0


def run_one(check: Check, place: str, settings: Settings, stop: Stop) -> None:
    """Runs it and remembers the outcome, unless it is stopped first."""
    if stop.event.is_set():
        return
    expect_commit(settings)
    say(f"[{place}] {check.name}")
    log = settings.memory / f"{check.slug}.log"
    try:
        outcome = run_check(check, settings.root, log, settings.limit_seconds, say, stop.event.is_set)
    except KeyboardInterrupt:
        return
    expect_commit(settings)
    remember(check, outcome, settings)
    say(
        f"[{place}] {check.name}: {outcome.result} in {outcome.seconds:.0f} s"
        + ("" if outcome.passed else f"; see {log}")
    )
    for figure in outcome.figures:
        say(f"    {figure}")


def expect_commit(settings: Settings) -> None:
    """Raises SoakError where the tree is no longer that of the run."""
    now = settings.still_at() if settings.still_at else settings.commit
    if now != settings.commit:
        raise SoakError(f"the tree changed during the run: found {now}; expected {settings.commit}")


def entries_of(checks: Sequence[Check], settings: Settings) -> Iterator[Entry]:
    for check in checks:
        known = recall(check, settings)
        assert known.outcome is not None, check.name
        yield Entry(check.name, known.outcome, known.failures)


def passed(check: Check, settings: Settings) -> bool:
    outcome = recall(check, settings).outcome
    return outcome is not None and outcome.passed


def memory_of(check: Check, settings: Settings) -> Path:
    return settings.memory / f"{check.slug}.json"


def recall(check: Check, settings: Settings) -> Remembered:
    """What an earlier run left."""
    path = memory_of(check, settings)
    if not path.is_file():
        return Remembered()
    found = json.loads(path.read_text(encoding="utf-8"))
    return Remembered(Outcome(**found["outcome"]), found["failures"])


def remember(check: Check, outcome: Outcome, settings: Settings) -> None:
    """Whole or not at all, whenever this process is killed."""
    known = recall(check, settings)
    if known.outcome and not known.outcome.passed:
        known.failures.append(known.outcome.result)
    path = memory_of(check, settings)
    half = path.with_suffix(f".{os.getpid()}.half")
    half.write_text(json.dumps({"outcome": asdict(outcome), "failures": known.failures}), encoding="utf-8")
    half.replace(path)


def forget(memory: Path) -> None:
    for path in memory.glob("*.json"):
        path.unlink()


def say(text: str) -> None:
    print(f"soak: {time.strftime('%H:%M:%S')} {text}", flush=True)


if __name__ == "__main__":
    sys.exit(main())
