"""Writes docs/stability.md: what gets out of closed moving shapes, and the deliberate defects with the tests that catch them.

    python docs/make_stability.py [--probes [REPORT.json ...]] [--mutants] [--allow-dirty]

Its two sections stand between markers and are made anew apart; without an option both are. --probes takes reports of
`msbvh bench --stability --json`, of all shapes or several of some of them; without one it measures (ten minutes on two cores),
beside Embree where the wheel embreex is installed. --mutants takes a quarter of an hour, most of it the build. A tree with
uncommitted changes is refused, or with --allow-dirty marked. Exit 1 if a ray of ours gets out or a defect is not caught.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import mutant_checks
import provenance
import stability_probes
from msbvh.base.errors import SceneError
from msbvh.bench.rays import find_peer

PAGE = mutant_checks.ROOT / "docs" / "stability.md"

TITLE = """# Numerical stability

Made by `python docs/make_stability.py` (`make stability`), whose options `--probes` and `--mutants` make one section anew.

{summary}"""
FOUND = re.compile(r"^- (.+)$|^(\d+ of \d+) are caught\.", re.MULTILINE)
"""What a section says first: a list of what was found, or how many defects were caught."""
MOST_FOUND = 3

SECTIONS = {"probes": stability_probes.HEADING, "mutants": "Deliberate defects"}
"""Between markers, in this order: option -> heading."""

NOT_MADE = """## {heading}

Not made yet: `python docs/make_stability.py --{name}`.
"""

MUTANTS = """## Deliberate defects

Made by `python docs/make_stability.py --mutants`: msbvh {commit}, {processor}.

{caught} of {count} are caught. All are in one build, `-DMSBVH_MUTANTS=ON`, where the environment variable `MSBVH_MUTANT`
names the one that acts; other builds have no trace of them. Each test passes there without a defect. What stands in place
of what is in `tests/mutants.toml`; docs/design/mutants.md says why a script makes the switches. Tests have the size that
they have in `make test`.

| defect | in | caught by | how | seconds |
|---|---|---|---|---|
"""


class PageError(Exception):
    """The page that is there, or a report, is not one of ours."""


def mutants_section(found: Sequence[mutant_checks.Verdict], commit: str) -> str:
    """The whole text; survivors stand in bold."""
    lines = []
    for verdict in found:
        mutant = verdict.mutant
        how = verdict.result if verdict.caught else "**not caught**"
        cells = (mutant.name, f"`{mutant.file}`", f"{mutant.target}: {mutant.test[1]}", how, f"{verdict.seconds:.1f}")
        lines.append(f"| {' | '.join(cells)} |\n")
    caught = sum(verdict.caught for verdict in found)
    head = MUTANTS.format(commit=commit, processor=provenance.processor(), caught=caught, count=len(found))
    return head + "".join(lines)


def refreshed(page: str | None, made: dict[str, str]) -> str:
    """The page with some sections made anew; None: there was none. Raises PageError where markers are missing."""
    sections = {}
    for name, heading in SECTIONS.items():
        kept = NOT_MADE.format(heading=heading, name=name) if page is None else _between(page, name)
        sections[name] = made.get(name, kept)
    parts = [TITLE.format(summary=summary(sections))]
    for name, text in sections.items():
        begin, end = _markers(name)
        parts.append(f"{begin}\n{text}{end}\n")
    return "\n".join(parts)


def summary(sections: dict[str, str]) -> str:
    """The first of what each section has found, a line each; nothing of those that are not made yet."""
    lines = []
    for text in sections.values():
        for found, caught in FOUND.findall(text.partition("\n### ")[0])[:MOST_FOUND]:
            lines.append(f"- {found or f'Deliberate defects: {caught} are caught by the test named for them.'}\n")
    return "".join(lines)


def _markers(name: str) -> tuple[str, str]:
    return f"<!-- {name}: begin -->", f"<!-- {name}: end -->"


def _between(page: str, name: str) -> str:
    begin, end = _markers(name)
    head, found, rest = page.partition(f"{begin}\n")
    text, closed, _ = rest.partition(f"{end}\n")
    if not found or not closed:
        raise PageError(f"{PAGE}: found no section between {begin} and {end}; expected both, or no page")
    return text


def probes_report(paths: Sequence[Path], allow_dirty: bool) -> dict[str, Any]:
    """Of files, or measured. Raises DirtyTree, PageError."""
    if not paths:
        provenance.commit(allow_dirty=allow_dirty)
        return measured()
    reports = [json.loads(path.read_text(encoding="utf-8")) for path in paths]
    for path, report in zip(paths, reports, strict=True):
        if str(report["machine"]["commit"]).endswith("-dirty") and not allow_dirty:
            raise provenance.DirtyTree(f"{path}: found a report of a dirty tree; expected one of a clean tree")
    try:
        return stability_probes.joined(reports)
    except ValueError as error:
        raise PageError(str(error)) from error


def measured() -> dict[str, Any]:
    """By the command that a user has, whose exit code 1 says that ours leaks."""
    try:
        find_peer("embree")
        peer = ["--peer", "embree"]
    except SceneError as error:
        print(f"{error}: our column stands alone", file=sys.stderr)
        peer = []
    command = [sys.executable, "-m", "msbvh", "bench", "--stability", "--json", *peer]
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
    if done.returncode not in (0, 1) or not done.stdout:
        raise PageError(f"{' '.join(command)}: found exit code {done.returncode}; expected a report")
    report: dict[str, Any] = json.loads(done.stdout)
    return report


def main() -> int:
    parser = argparse.ArgumentParser(description="Writes docs/stability.md.")
    parser.add_argument(
        "--probes", nargs="*", type=Path, metavar="REPORT.json", help="only the rays; of reports, or measured"
    )
    parser.add_argument("--mutants", action="store_true", help="only the deliberate defects")
    parser.add_argument(
        "--allow-dirty", action="store_true", help="mark a tree with uncommitted changes, not refuse it"
    )
    options = parser.parse_args()
    both = options.probes is None and not options.mutants
    made, fine = {}, True
    page = PAGE.read_text(encoding="utf-8") if PAGE.exists() else None
    try:
        refreshed(page, {})  # before minutes are spent
        if both or options.probes is not None:
            report = probes_report(options.probes or (), options.allow_dirty)
            made["probes"] = stability_probes.section(report)
            fine &= not any(row["leaks"] or row["wrong"] for row in report["rows"])
        if both or options.mutants:
            commit = provenance.commit(allow_dirty=options.allow_dirty)
            mutants = mutant_checks.read_mutants()
            mutant_checks.build(mutants)
            found = mutant_checks.verdicts(mutants)
            made["mutants"] = mutants_section(found, commit)
            fine &= all(verdict.caught for verdict in found)
        PAGE.write_text(refreshed(page, made), encoding="utf-8")
    except (provenance.DirtyTree, mutant_checks.MutantError, PageError) as error:
        sys.exit(str(error))
    return 0 if fine else 1


if __name__ == "__main__":
    sys.exit(main())
