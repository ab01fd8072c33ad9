"""Writes docs/conformance.md: how we do by the suite of testenv/motion, and against public reference images.

    python docs/make_conformance.py    # some minutes; with msbvh installed or on PYTHONPATH

The table of reference images needs ../shared/scenes beside the checkout. That of Hydra shows what docs/make_hydra.py has
found, where there was an OpenUSD to build the plugin for.
"""

from __future__ import annotations

import json
import platform
import sys
import tempfile
from collections.abc import Iterator
from itertools import groupby
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests" / "python"))

from alpha_references import BOUND, SAMPLING, SPP, alpha_errors, comparisons
from msbvh import _core
from msbvh.base.progress import Progress
from msbvh.conform.record import STANDARD_ERRORS, read_record
from msbvh.conform.suite import Outcome, conform, find_suite, own_renderer, read_rules
from pxr import Usd


def main() -> None:
    text = "\n".join([*heading(), *rules_table(), *hydra_table(), *references_table()])
    (ROOT / "docs" / "conformance.md").write_text(text + "\n", encoding="utf-8")


RULES_TEXT = """## Rules of motion

`msbvh conform` runs them; **{passed} of {count} pass**. A rule is a small scene and the coverage that
usd-core's own evaluation has, projected at 512 times of the shutter (`testenv/motion`). The error is the
mean of alpha's absolute error over what either image covers; by noise is what as many independent samples a
pixel explain, by record what a run of ours may have: {standard_errors:g} standard errors above that of the
run in `testenv/motion/recorded.json` (`python testenv/motion/make_recorded.py`).
`msbvh conform --command 'usdrecord --renderer X'` holds another renderer to them, by noise alone."""

HYDRA_TEXT = """## Through Hydra

The same rules through the Hydra plugin and, in the same host, through OpenUSD's own CPU delegate: OpenUSD {openusd}, {samples}
samples a pixel, errors allowed by noise alone. Made by `python docs/make_hydra.py`. Scene indices are the way that OpenUSD
takes by default since 25.11; the frame recorder, which usdrecord is a command line of, still takes the older scene delegate in
{openusd}. What fails through scene indices is excused where the dump of it shows that the host has handed over other values
([hydra_dumps.md](hydra_dumps.md)): {excused} of {failed}.
"""

REFERENCES_TEXT = """Scenes of Autodesk/arnold-usd's test suite, whose reference images' alpha is coverage.
Mean absolute error of alpha over the whole image, ours and that of the oracle: usd-core's evaluation,
projected as triangles at {times} times and {subpixels} x {subpixels} places of each pixel. What the oracle
is out by is the reference's own noise and pixel filter; ours is to stay below {bound} times that.

| scene | frame | ours | oracle | ratio | bound |
|---|---|---|---|---|---|"""


def heading() -> Iterator[str]:
    version = ".".join(map(str, Usd.GetVersion()[1:]))
    yield "# Conformance"
    yield ""
    yield f"Made by `python docs/make_conformance.py`: msbvh {_core.__version__}, usd-core {version},"
    yield f"Python {platform.python_version()}, {SPP} samples a pixel, seed 0."
    yield ""


def rules_table() -> Iterator[str]:
    """Every rule of the suite with its result."""
    suite = find_suite(ROOT / "testenv" / "motion")
    record = read_record(suite, SPP)
    with Progress("rules") as progress:
        outcomes = list(conform(read_rules(suite), own_renderer(SPP), SPP, progress=progress, record=record))
    passed = sum(outcome.passed for outcome in outcomes)
    yield RULES_TEXT.format(passed=passed, count=len(outcomes), standard_errors=STANDARD_ERRORS)
    for topic, group in groupby(outcomes, key=lambda outcome: outcome.rule.topic):
        yield ""
        yield f"### {topic[0].upper()}{topic[1:]}"
        yield ""
        yield "| rule | result | error | by noise | by record | statement |"
        yield "|---|---|---|---|---|---|"
        yield from map(rule_row, group)
    yield ""


def hydra_table() -> Iterator[str]:
    """Every rule through the plugin, as docs/make_hydra.py has found it."""
    found = json.loads((ROOT / "docs" / "hydra_conformance.json").read_text(encoding="utf-8"))
    columns, excused = found["columns"], found["excused"]
    titles = sorted(columns, key=lambda title: (not title.endswith("indices"), not title.startswith("MSBVH")))
    failed = [name for name, row in columns[titles[0]].items() if not row["passed"]]
    yield HYDRA_TEXT.format(
        openusd=found["openusd"], samples=found["samples"], excused=len(excused), failed=len(failed)
    )
    yield f"| rule | {' | '.join(titles)} | what the host does not hand over |"
    yield f"|---|{'---|' * len(titles)}---|"
    passed = [
        f"**{sum(row['passed'] for row in columns[title].values())} of {len(columns[title])}**" for title in titles
    ]
    yield f"| all | {' | '.join(passed)} | |"
    for name in columns[titles[0]]:
        cells = [hydra_cell(columns[title][name]) for title in titles]
        yield f"| `{name}` | {' | '.join(cells)} | {excused.get(name, '' if name not in failed else '**not excused**')} |"
    yield ""


def hydra_cell(row: dict[str, Any]) -> str:
    error = "no picture" if row["error"] is None else f"{row['error']:.4f}"
    return f"pass {error}" if row["passed"] else f"**fail** {error}"


def rule_row(outcome: Outcome) -> str:
    error = "-" if outcome.error is None else f"{outcome.error:.4f}"
    result = "pass" if outcome.passed else "**fail**"
    why = "" if outcome.passed else f" ({outcome.reason})"
    recorded = f"{outcome.recorded.allowed:.4f}" if outcome.recorded else "-"
    cells = (
        f"`{outcome.rule.name}`",
        result,
        error,
        f"{outcome.allowed:.4f}",
        recorded,
        outcome.rule.statement + why,
    )
    return f"| {' | '.join(cell.replace('|', '/') for cell in cells)} |"


def references_table() -> Iterator[str]:
    """Every public scene with a reference image: compared, or the reason why not."""
    every = comparisons()
    yield "## Reference images of another renderer"
    yield ""
    if not every:
        yield "Not made: `../shared/scenes` was not on the machine."
        return
    times, subpixels = SAMPLING.times, SAMPLING.subpixels
    yield REFERENCES_TEXT.format(times=times, subpixels=subpixels, bound=BOUND)
    compared = [comparison for comparison in every if not comparison.excluded]
    with tempfile.TemporaryDirectory() as folder, Progress("reference images") as progress:
        for done, comparison in enumerate(compared):
            found = alpha_errors(comparison, Path(folder))
            progress((done + 1) / len(compared))
            ratio = f"{found.ratio:.2f}" if found.ratio <= BOUND else f"**{found.ratio:.2f}**"
            cells = (
                str(comparison),
                f"{comparison.frame:g}",
                f"{found.ours:.4f}",
                f"{found.oracle:.4f}",
                ratio,
            )
            yield f"| {' | '.join(cells)} | {BOUND} |"
    yield ""
    yield "Not compared:"
    yield ""
    yield "| scene | reason |"
    yield "|---|---|"
    for comparison in every:
        if comparison.excluded:
            yield f"| {comparison} | {comparison.excluded} |"


if __name__ == "__main__":
    main()
