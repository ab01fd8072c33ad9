"""Writes docs/accuracy.md and docs/images/accuracy.png: what each step of accuracy costs, on six scenes.

    python docs/make_accuracy.py [--allow-dirty] [--reports DIR]      # `make accuracy`: twenty minutes on two cores

Runs `msbvh accuracy` on its built-in scenes and on one public scene (../shared/scenes beside the checkout), to
out/accuracy/NAME/, where the whole reports are; goes on there after an interruption. --reports: makes the page of reports
that were made before. Nothing here knows a figure, and the sentences are those of the reports. A tree with uncommitted
changes is refused, or with --allow-dirty marked.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import provenance

ROOT = Path(__file__).resolve().parents[1]
OUT = Path("out/accuracy")
IMAGE = Path("docs/images/accuracy.png")
OPTIONS = ("--imageWidth", "240", "--spp", "8", "--rounds", "2")
PUBLIC = "velocity_accel/arnold_1427.3/data/test.usd"
"""Of ../shared/scenes: from the testsuite of arnold-usd."""
GOALS = ("--target-error", "0.25px", "--target-flip", "0.05", "--time-budget", "3s")

Report = dict[str, Any]
Point = dict[str, Any]

HEAD = """# What accuracy costs

Made by `make accuracy`, which runs `msbvh accuracy {options}` on each scene: msbvh {commit}, {processor}, {threads} threads,
{instruction_set}. Each point was rendered {runs} times, by another seed each time, in processes of their own and in rounds;
times are medians, with the lowest and the highest in brackets.

![Seconds a frame against the error of the picture, scene by scene](images/accuracy.png)

**How to read it.** A knob is turned while all others are held at the base settings. *Frame* is from opening the stage to the
file, without the start of the process. *Alone* is what that knob's kind of error does to the picture by itself, beside a
picture with the same noise and the finest motion, shape or path depth: relative MSE, and mean HDR-FLIP, of which 0.01 is what
an attentive eye may find. Below 0: hidden by noise. *Whole* is the relative MSE
beside a reference with {reference} times the samples, the finest of everything and other seeds. *px* is the largest error of
any prim's motion. A report of a scene of your own has all this, pictures and every prim in it: `msbvh accuracy SCENE --out DIR`.
"""

READING = """## What they have in common

{sentences}
"""


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--allow-dirty", action="store_true")
    parser.add_argument("--reports", type=Path)
    arguments = parser.parse_args()
    try:
        commit = provenance.commit(allow_dirty=arguments.allow_dirty)
    except provenance.DirtyTree as error:
        sys.exit(f"make_accuracy: error: {error}")
    folder = arguments.reports or ROOT / OUT
    if arguments.reports is None:
        measure()
    reports = {
        path.parent.name: json.loads(path.read_text(encoding="utf-8"))
        for path in sorted(folder.glob("*/accuracy.json"))
    }
    commits = {str(report["machine"]["commit"]) for report in reports.values()}
    if len(commits) > 1 or (arguments.reports is None and commits != {commit}):
        sys.exit(
            f"make_accuracy: error: {folder}: found reports of {', '.join(sorted(commits))}, expected all of {commit}"
        )
    if not reports:
        sys.exit(f"make_accuracy: error: {folder}: found no */accuracy.json, expected reports of `msbvh accuracy`")
    (ROOT / "docs" / "accuracy.md").write_text(
        "\n".join(page(reports, commits.pop())).rstrip("\n") + "\n", encoding="utf-8"
    )
    plot(reports, ROOT / IMAGE)


def measure() -> None:
    """Exit code 1 says that a goal cannot be kept, which is a result."""
    command = [sys.executable, "-m", "msbvh", "accuracy", *OPTIONS, *GOALS]
    runs = [[*command, "--out", str(OUT)]]
    public = ROOT.parent / "shared" / "scenes" / PUBLIC
    if public.is_file():
        runs.append([*command, str(public), "--out", str(OUT / public.parents[1].name)])
    else:
        print(f"make_accuracy: {public} is not there: left out")
    for run in runs:
        if subprocess.run(run, cwd=ROOT, check=False).returncode not in (0, 1):
            sys.exit(f"make_accuracy: error: {' '.join(run)} failed")


def page(reports: Mapping[str, Report], commit: str) -> Iterator[str]:
    """The lines of docs/accuracy.md."""
    first = next(iter(reports.values()))
    yield HEAD.format(
        options=" ".join((*OPTIONS, *GOALS)),
        commit=commit,
        processor=first["machine"]["processor"],
        threads=first["threads"],
        instruction_set=first["machine"]["instruction_set"],
        runs=first["points"][first["named"][0]["id"]]["runs"],
        reference=first["reference"]["samples"] // first["base"]["spp"],
    )
    yield READING.format(sentences="\n".join(f"- {sentence}" for sentence in in_common(reports)))
    for name, report in reports.items():
        yield from scene(name, report)


def in_common(reports: Mapping[str, Report]) -> Iterator[str]:
    """What the reports have in common, counted."""
    many = len(reports)
    for name in ("2 keys everywhere", "Arnold-like 3 keys"):
        pairs = [
            (one, other)
            for report in reports.values()
            if (one := named(report, "ours")) and (other := named(report, name))
        ]
        if not pairs:
            continue
        worse = [other["motion_px"] for one, other in pairs if other["motion_px"] > one["motion_px"]] or [0.0]
        times = sorted(median(other) / median(one) for one, other in pairs)
        yield (
            f"*{name}* errs more than ours in {len(worse)} of {len(pairs)} scenes, where it is off by {min(worse):.2g} to"
            f" {max(worse):.2g} px, and takes {times[0]:.2f} to {times[-1]:.2f} times as long a frame."
        )
    yield from (
        f"{text} ({len(names)} of {many}: {', '.join(names)})." for text, names in useless(reports).items() if names
    )
    noises = [report["machine"]["noise"] for report in reports.values()]
    low, high = min(noises), max(noises)
    yield f"The same frame's time changed by a factor of {low:.2f} to {high:.2f} from run to run: less means nothing."


def useless(reports: Mapping[str, Report]) -> dict[str, list[str]]:
    """Knobs that bought nothing, with the scenes where that was so."""
    found: dict[str, list[str]] = {}
    for name, report in reports.items():
        for axis in report["axes"]:
            points = [report["points"][step["id"]] for series in axis["series"] for step in series["points"]]
            points = [point for point in points if not point["failed"]]
            if len(points) < 2:
                continue
            times = [median(point) for point in points]
            if axis["error"] in ("none", "look"):
                quiet = max(times) / min(times) <= max(1.05, report["machine"]["noise"])
                text = f"{axis['name']}: no position is faster than the clock can tell"
            else:
                errors = [point["kinds"].get(axis["error"], {}).get("flip") for point in points]
                quiet = None not in errors and max(errors) < 0.001
                text = f"{axis['name']}: no position changes what the picture looks like"
            found.setdefault(text, []).extend([name] if quiet else [])
    return found


def named(report: Report, name: str) -> Point | None:
    entry = next((entry for entry in report["named"] if entry["name"] == name), None)
    point = report["points"][entry["id"]] if entry else None
    return point if point and not point["failed"] else None


def median(point: Point) -> float:
    return float(point["seconds"]["frame"][0])


def scene(name: str, report: Report) -> Iterator[str]:
    width, height = report["resolution"]
    yield f"## {name}\n"
    yield f"{width} x {height} pixels, frame {report['frame']:g}, base settings: {options(report['base'])}.\n"
    yield from (f"- {sentence}" for sentence in report["findings"])
    yield ""
    yield from table(report, "named settings", [(entry["name"], entry["id"]) for entry in report["named"]], "")
    yield from table(
        report, "the front", [(options(report["points"][key]["options"]) or "base", key) for key in report["front"]], ""
    )
    for axis in report["axes"]:
        if axis["left_out"]:
            yield f"**{axis['name']}** was left out: {axis['left_out']}.\n"
            continue
        rows = [
            (f"{series['name']} {step['value']}".strip(), step["id"])
            for series in axis["series"]
            for step in series["points"]
        ]
        kind = axis["error"] if axis["error"] in ("motion", "shape", "light") else ""
        yield f"<details><summary>{axis['name']}: <code>--{axis['option']}</code></summary>\n"
        yield f"{axis['says']}\n"
        yield from table(report, f"{axis['option']}", rows, kind)
        yield "</details>\n"


def options(values: Mapping[str, Any]) -> str:
    return ", ".join(f"{name} {value}" for name, value in values.items())


def table(report: Report, title: str, rows: list[tuple[str, str]], kind: str) -> Iterator[str]:
    alone = [f"{kind} alone, rel. MSE", f"{kind} alone, FLIP"] if kind else []
    yield f"| {title} | frame s | trace s | peak MB | {' | '.join([*alone, 'px', 'whole', 'FLIP'])} |"
    yield "|---|" + "---|" * (6 + len(alone))
    for label, key in rows:
        point = report["points"][key]
        if point["failed"]:
            yield f"| {label} | failed: {point['failed']} |"
            continue
        found = point["kinds"].get(kind)
        errors = [figure(found["relative_mse"]), figure(found["flip"])] if found else ["–"] * len(alone)
        middle, low, high = point["seconds"]["frame"]
        cells = [
            f"{middle:.2f} [{low:.2f}, {high:.2f}]",
            f"{point['seconds']['trace'][0]:.2f}",
            f"{point['peak_bytes'] / 1e6:.0f}",
            *errors,
            figure(point["motion_px"]),
            figure(point["relative_mse"]),
            figure(point["flip"]),
        ]
        yield f"| {label} | {' | '.join(cells)} |"
    yield ""


def figure(value: float) -> str:
    return f"{value:.2g}"


def plot(reports: Mapping[str, Report], path: Path) -> None:
    """The front of each scene, all points behind it."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot
    from matplotlib.ticker import NullFormatter

    rows = (len(reports) + 2) // 3
    figure, panels = pyplot.subplots(rows, 3, figsize=(11, 3.4 * rows), squeeze=False)
    for panel in panels.ravel()[len(reports) :]:
        panel.set_visible(False)
    for panel, (name, report) in zip(panels.ravel(), reports.items(), strict=False):
        every = {key: report["points"][key] for key in report["comparable"]}
        shown = {key: point for key, point in every.items() if not point["failed"] and (point["relative_mse"] or 0) > 0}
        panel.loglog(
            [median(p) for p in shown.values()], [p["relative_mse"] for p in shown.values()], ".", color="0.75"
        )
        front = [shown[key] for key in report["front"] if key in shown]
        panel.loglog(
            [median(p) for p in front], [p["relative_mse"] for p in front], "o-", color="#0072b2", label="front", ms=4
        )
        for entry, colour in zip(report["named"], ("#009e73", "#d55e00", "#cc79a7"), strict=False):
            if point := shown.get(entry["id"]):
                panel.loglog(median(point), point["relative_mse"], "D", color=colour, label=entry["name"])
        panel.set_title(name)
        panel.set_xlabel("seconds a frame")
        panel.set_ylabel("relative MSE")
        panel.grid(alpha=0.2)
        panel.xaxis.set_minor_formatter(NullFormatter())
    panels[0, 0].legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(path, dpi=110, metadata={"Software": None})


if __name__ == "__main__":
    main()
