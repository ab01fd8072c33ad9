"""Writes docs/stability.md: the deliberate defects, and the tests that catch them.

    python docs/make_stability.py [--allow-dirty]    # a quarter of an hour, most of it the build

A tree with uncommitted changes is refused, or with --allow-dirty marked. Exit 1 if a defect is not caught.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence

import mutant_checks
import provenance

PAGE = mutant_checks.ROOT / "docs" / "stability.md"

HEAD = """# Numerical stability

Made by `python docs/make_stability.py`: msbvh {commit}, {processor}.

## Deliberate defects

{caught} of {count} are caught. All are in one build, `-DMSBVH_MUTANTS=ON`, where the environment variable `MSBVH_MUTANT`
names the one that acts; other builds have no trace of them. Each test passes there without a defect. What stands in place
of what is in `tests/mutants.toml`; docs/design/mutants.md says why a script makes the switches. Tests have the size that
they have in `make test`.

| defect | in | caught by | how | seconds |
|---|---|---|---|---|
"""


def page(found: Sequence[mutant_checks.Verdict], commit: str) -> str:
    """The whole text; survivors stand in bold."""
    lines = []
    for verdict in found:
        mutant = verdict.mutant
        how = verdict.result if verdict.caught else "**not caught**"
        cells = (mutant.name, f"`{mutant.file}`", f"{mutant.target}: {mutant.test[1]}", how, f"{verdict.seconds:.1f}")
        lines.append(f"| {' | '.join(cells)} |\n")
    caught = sum(verdict.caught for verdict in found)
    head = HEAD.format(commit=commit, processor=provenance.processor(), caught=caught, count=len(found))
    return head + "".join(lines)


def main() -> int:
    try:
        commit = provenance.commit(allow_dirty="--allow-dirty" in sys.argv[1:])
        mutants = mutant_checks.read_mutants()
        mutant_checks.build(mutants)
        found = mutant_checks.verdicts(mutants)
    except (provenance.DirtyTree, mutant_checks.MutantError) as error:
        sys.exit(str(error))
    PAGE.write_text(page(found, commit), encoding="utf-8")
    return 0 if all(verdict.caught for verdict in found) else 1


if __name__ == "__main__":
    sys.exit(main())
