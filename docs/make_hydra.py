"""Holds the Hydra plugin, and hdEmbree in the same host, to the rules of motion: docs/hydra_conformance.json, which
docs/make_conformance.py shows, and docs/hydra_dumps.md.

    python docs/make_hydra.py DRAW --plugins PATH    # minutes; needs a build with an OpenUSD (docs/hydra.md)

DRAW is build/hydra/tests/hydra/hydra_draw, PATH its PXR_PLUGINPATH_NAME, which this process must not have. A rule that
fails through scene indices is excused only by what the host has handed over: the dump of it has the lines that say so.
"""

from __future__ import annotations

import argparse
import fnmatch
import json
import os
import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from msbvh.base.progress import Progress
from msbvh.conform.suite import Outcome, Rule, conform, find_suite, other_renderer, read_rules

ROOT = Path(__file__).resolve().parents[1]
RESULTS = ROOT / "docs" / "hydra_conformance.json"
DUMPS = ROOT / "docs" / "hydra_dumps.md"
SAMPLES = 64
"""What UsdAppUtilsFrameRecorder leaves at the plugin's own."""


@dataclass(frozen=True)
class Column:
    """A renderer in a host."""

    title: str
    engine: str
    renderer: str = "HdMsbvhRendererPlugin"


COLUMNS = (
    Column("MSBVH, scene indices", "indices"),
    Column("MSBVH, frame recorder", "recorder"),
    Column("hdEmbree, frame recorder", "recorder", "HdEmbreeRendererPlugin"),
)


@dataclass(frozen=True)
class Reason:
    """What a host does not hand over, for rules whose names match. It excuses a rule only where the dump bears it out."""

    rules: str
    words: str
    lines: str
    """A regular expression for the lines of the dump that show it."""
    still: str = ""
    """For lines that are there, and name no times."""
    absent: str = ""
    """For lines that are not there."""

    def holds(self, lines: list[str]) -> bool:
        """Whether the dump says so."""
        if self.still:
            found = [line for line in lines if re.search(self.still, line)]
            if not found or any("times 0 x []" not in line for line in found):
                return False
        return not (self.absent and any(re.search(self.absent, line) for line in lines))


REASONS = (
    Reason("visibility_*", "visibility has no times", r"visibility/", still=r"visibility/"),
    Reason(
        "instance_reset_inside",
        "no transform says that it is reset: every one is flattened, and says so of itself",
        r"hydra:instanceTransforms|xform/",
        absent=r"xform/resetXformStack: times .*: 0$",
    ),
    Reason(
        "instancer_over_prototype",
        "a prototype that is an over is not there",
        r"Instancer|Elsewhere",
        absent=r"^/Elsewhere.* mesh mesh/",
    ),
    Reason(
        "instancer_hidden_prototypes",
        "prototypes in an invisible scope are invisible",
        r"visibility/",
        still=r"Prototypes/.*visibility/visibility: times 0 x \[\]: 0",
    ),
    Reason(
        "instancer_indices_change",
        "prototype indices have no times",
        r"instancerTopology/instanceIndices",
        still=r"instancerTopology/instanceIndices",
    ),
    Reason("*velocity_scale*", "motion:velocityScale is not there", r"velocit|blurScale", absent=r"velocityScale"),
    Reason(
        "blur_scale_inherited,blur_scale_of_instancer,blur_scale_of_native_instance,instancer_root_blur_scale",
        "motion:blurScale of a prim that is not point-based is not there",
        r"blurScale|xform/matrix",
        absent=r"blurScale",
    ),
    Reason(
        "spline_*",
        "OpenUSD 24.11 has no splines: the attribute has no value there",
        r"xform/matrix",
        still=r"xform/matrix",
    ),
    Reason(
        "skin_*,blend_*,subdivision_skinned",
        "points are those at rest, no skeleton poses them",
        r"primvars/points|extComputation",
        still=r"primvars/points/primvarValue",
        absent=r"extComputation",
    ),
    Reason(
        "velocity_at_48",
        "scene globals have no timeCodesPerSecond",
        r"sceneGlobals|velocities",
        absent=r"timeCodesPerSecond",
    ),
)


def command(column: Column, draw: Path, dump: Path | None = None) -> str:
    """For conform."""
    options = ["--engine", column.engine, "--renderer", column.renderer, "--camera", "{camera}", "--frames", "{frames}"]
    options += ["--imageWidth", "{width}", "--imageHeight", "{height}"]
    options += ["--set", f"convergedSamplesPerPixel={SAMPLES}"]
    if dump:
        options += ["--dump", str(dump)]
    return " ".join([str(draw), *options, "{scene}", "{out}"])


def run(column: Column, draw: Path, rules: list[Rule]) -> dict[str, Outcome]:
    """By rule."""
    with Progress(column.title) as progress:
        outcomes = list(conform(rules, other_renderer(command(column, draw), 120.0), SAMPLES, progress=progress))
    return {outcome.rule.name: outcome for outcome in outcomes}


def reason_for(rule: str) -> Reason | None:
    """The first that matches."""
    for reason in REASONS:
        if any(fnmatch.fnmatch(rule, each) for each in reason.rules.split(",")):
            return reason
    return None


def dumped(rule: Rule, draw: Path) -> list[str]:
    """What the host had handed over, without the stage's root."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "dump.txt"
        renderer = other_renderer(command(COLUMNS[0], draw, file), 120.0)
        subprocess.run(
            renderer.command(rule, str(Path(folder) / "out.exr")), check=True, capture_output=True, timeout=120
        )
        return file.read_text(encoding="utf-8").splitlines()


def plain(outcome: Outcome) -> dict[str, Any]:
    return {"passed": outcome.passed, "error": None if outcome.error is None else round(outcome.error, 4)}


def write_dumps(rules: list[Rule], found: dict[str, Outcome], draw: Path, version: str) -> dict[str, str]:
    """Of each rule that fails through scene indices. Returns the words for those that the dump excuses."""
    excused = {}
    text = [
        "# What a host hands over where a rule fails through Hydra",
        "",
        f"Made by `python docs/make_hydra.py`, with OpenUSD {version}'s scene indices. A line is a value of a prim: its data",
        "source, the times that it names for the shutter (frames from the frame), then the value at the opening and, where",
        "there are times, at the frame and at the closing. `times 0 x []`: the host says that it never changes. A rule is",
        "excused only where the script finds in these lines what is said of them.",
    ]
    for rule in rules:
        if found[rule.name].passed:
            continue
        reason, lines = reason_for(rule.name), dumped(rule, draw)
        holds = reason is not None and reason.holds(lines)
        text += [
            "",
            f"## {rule.name}",
            "",
            f"{rule.statement}. {reason.words if reason and holds else '**Not excused**'}.",
        ]
        if reason is not None:
            shown = [line for line in lines if re.search(reason.lines, line)]
            text += ["", "```", *(line if len(line) <= 200 else line[:197] + "..." for line in shown), "```"]
            if holds:
                excused[rule.name] = reason.words
    DUMPS.write_text("\n".join(text) + "\n", encoding="utf-8")
    return excused


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("draw", type=Path)
    parser.add_argument("--plugins", required=True)
    parser.add_argument("--openusd", default="24.11")
    options = parser.parse_args()
    rules = read_rules(find_suite(ROOT / "testenv" / "motion"))
    os.environ["PXR_PLUGINPATH_NAME"] = options.plugins  # of the host; this process has read its own plugins
    draw = options.draw.resolve()
    columns = {column.title: run(column, draw, rules) for column in COLUMNS}
    results: dict[str, Any] = {"openusd": options.openusd, "samples": SAMPLES, "columns": {}, "excused": {}}
    for title, found in columns.items():
        results["columns"][title] = {name: plain(outcome) for name, outcome in found.items()}
    first = columns[COLUMNS[0].title]
    failed = [name for name, outcome in first.items() if not outcome.passed]
    results["excused"] = write_dumps(rules, first, draw, options.openusd)
    RESULTS.write_text(json.dumps(results, indent=1, sort_keys=True) + "\n", encoding="utf-8")
    return 0 if len(results["excused"]) == len(failed) else 1


if __name__ == "__main__":
    sys.exit(main())
