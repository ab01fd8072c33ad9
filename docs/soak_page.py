"""docs/soak.md: a section a commit, the newest last."""

from __future__ import annotations

import os
import platform
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

import provenance
from soak_checks import Outcome

HEAD = """# Soak

Every long check, run whole. Made by `make soak`; `make test` runs a fixed-seed sample of each. A section is of a commit, the
newest is the last one. Checks that had passed in an earlier, interrupted run at the same commit are not run again.
"""


@dataclass(frozen=True)
class Entry:
    """A check in a section."""

    name: str
    outcome: Outcome
    failures: Sequence[str]
    """How it had failed before at this commit."""


@dataclass(frozen=True)
class Run:
    """What a section is of. `only`: globs that left checks out."""

    commit: str
    begin: datetime
    only: Sequence[str]
    entries: Sequence[Entry]


def write_run(page: Path, run: Run) -> None:
    """Appends the section of the run; one of the same commit and selection gives way to it."""
    text = page.read_text(encoding="utf-8") if page.is_file() else HEAD
    sections = re.split(r"^(?=## )", text, flags=re.MULTILINE)
    kept = [section.rstrip("\n") for section in sections if not section.startswith(f"{title(run)}\n")]
    half = page.with_name(f"{page.name}.{os.getpid()}.half")
    half.write_text("\n\n".join([*kept, "\n".join(section(run))]) + "\n", encoding="utf-8")
    half.replace(page)


def title(run: Run) -> str:
    return f"## {run.commit}" + (f", only {', '.join(run.only)}" if run.only else "")


def section(run: Run) -> Iterator[str]:
    failed = sum(not entry.outcome.passed for entry in run.entries)
    seconds = sum(entry.outcome.seconds for entry in run.entries)
    yield title(run)
    yield ""
    yield f"{run.begin:%Y-%m-%d %H:%M} UTC; {provenance.processor()}, {os.cpu_count()} cores, {platform.platform()}."
    yield f"{len(run.entries)} checks, {duration(seconds)} in all: {'all passed' if not failed else f'**{failed} failed**'}."
    if run.commit.endswith("-dirty"):
        yield "**Of a tree with uncommitted changes.**"
    yield ""
    yield "| check | result | duration | figures |"
    yield "|---|---|---|---|"
    for entry in run.entries:
        cells = [entry.name, result(entry), duration(entry.outcome.seconds), "<br>".join(entry.outcome.figures)]
        yield f"| {' | '.join(cell.replace('|', '&#124;') for cell in cells)} |"


def result(entry: Entry) -> str:
    text = entry.outcome.result if entry.outcome.passed else f"**{entry.outcome.result}**"
    return text if not entry.failures else f"{text}; before: {', '.join(entry.failures)}"


def duration(seconds: float) -> str:
    if seconds < 100:
        return f"{seconds:.0f} s"
    minutes = seconds / 60
    return f"{minutes:.0f} min" if minutes < 100 else f"{minutes / 60:.1f} h"
