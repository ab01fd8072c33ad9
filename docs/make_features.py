"""Writes docs/features.md: every feature of the acceleration structure with its test, with and without it.

    python docs/make_features.py [--allow-dirty] [build/release/bench/msbvh_bench_features]    # under a minute

The executable comes with -DMSBVH_BUILD_BENCH=ON (`make setup` has it). Rows are those that it prints; nothing here
knows a figure. A tree with uncommitted changes is refused, or with --allow-dirty marked.
"""

from __future__ import annotations

import json
import os
import platform
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import provenance

ROOT = Path(__file__).resolve().parents[1]
BENCH = Path("build/release/bench/msbvh_bench_features")

Row = dict[str, Any]

HEAD = """# Features, with and without

Made by `python docs/make_features.py`, which runs `{command}`: msbvh{commit}, {processor}, {cores} cores, {system};
load average {load_average:.1f} before the run.
{shared}
A row is one feature on one scene, built twice and traced twice by the same {ray_count} rays at random times, by
one thread: without the feature -> with it. Speed is the median of {rounds} rounds (3 at least) in which both sides have their
turn; the ratio (with over without, above 1 the feature makes rays faster) is the median of the rounds' own ratios, with
the lowest and the highest in brackets. Builds are medians of 3, by one thread. Bytes are all that traversal reads, a
triangle that is seen (of instances: each time). Random rays join two random points of the scene's box, primary ones come
in tiles of 8 x 8 pixels, shadow rays start where those hit. *Slower*: all rounds were below 1; *slower, perhaps*: the
median is, and some rounds are not; *even*: within a hundredth. Rays are not all that a feature is for: the columns beside
the ratio say what it spares or costs.
*Hits differ* counts rays whose two hits are farther apart than 1e-4 of the scene, or of which one is missing: 0 where both
sides show the same motion, not where one approximates a curve of the other by keys.
"""

SHARED = """The machine was shared: absolute figures are too low, and only ratios with a narrow spread say much.
"""

COLUMNS = (
    "feature",
    "scene",
    "sides",
    "Mrays/s",
    "ratio",
    "nodes a ray",
    "triangles a ray",
    "bytes a triangle",
    "build s",
    "hits differ",
    "test",
)


def main() -> None:
    allow_dirty = "--allow-dirty" in sys.argv[1:]
    arguments = [argument for argument in sys.argv[1:] if argument != "--allow-dirty"]
    bench = Path(arguments[0]) if arguments else ROOT / BENCH
    try:
        commit = provenance.commit(allow_dirty=allow_dirty)
    except provenance.DirtyTree as error:
        sys.exit(f"make_features: error: {error}")
    load_average = os.getloadavg()[0]
    out = subprocess.run([bench], check=True, stdout=subprocess.PIPE, text=True).stdout
    rows = [json.loads(line) for line in out.splitlines()]
    text = "\n".join(page(rows, bench, load_average, commit))
    (ROOT / "docs" / "features.md").write_text(text + "\n", encoding="utf-8")


def page(rows: list[Row], bench: Path, load_average: float, commit: str) -> Iterator[str]:
    """The lines of docs/features.md."""
    counts = [row["ray_count"] for row in rows]
    yield HEAD.format(
        command=BENCH if bench.resolve() == (ROOT / BENCH).resolve() else bench.name,
        commit=f" ({commit})",
        processor=provenance.processor(),
        cores=os.cpu_count(),
        system=f"{platform.system()} {platform.release()}",
        load_average=load_average,
        shared=SHARED if load_average > 0.5 else "",
        ray_count=f"{min(counts)} to {max(counts)}",
        rounds=max(row["rounds"] for row in rows),
    )
    yield f"| {' | '.join(COLUMNS)} |"
    yield "|---" * len(COLUMNS) + "|"
    for found in by_feature(rows).values():
        for row in found:
            yield f"| {' | '.join(cells(row, first=row is found[0]))} |"
    yield from slower(rows)


def by_feature(rows: list[Row]) -> dict[str, list[Row]]:
    """In the order in which features first appear."""
    found: dict[str, list[Row]] = {}
    for row in rows:
        found.setdefault(row["feature"], []).append(row)
    return found


def cells(row: Row, *, first: bool) -> list[str]:
    """One cell a column; what the feature is, and where it is described, in its first row only."""
    name = f"**{row['feature']}**"
    return [
        f"{name}: {row['what']} ({source(row['source'])})" if first else name,
        scene(row),
        f"{row['without']} -> {row['with']}",
        change(row, "mrays", 2),
        f"{ratio(row)}{verdict(row)}",
        change(row, "nodes_per_ray", 1),
        change(row, "tests_per_ray", 1),
        change(row, "bytes_per_tri", 0),
        change(row, "build_s", 3),
        str(row["hits_differ"]),
        "<br>".join(link(test) for test in row["test"].split()),
    ]


def scene(row: Row) -> str:
    keys = row["with_keys"]
    if row["without_keys"] != keys:
        keys = f"{row['without_keys']} -> {keys}"
    rays = f"{row['rays']} rays" + (", any hit" if row["any_hit"] else "")
    return f"{row['scene']}, {row['triangles']:.0f} triangles, {keys}; {rays}"


def change(row: Row, key: str, digits: int) -> str:
    return f"{row[f'without_{key}']:.{digits}f} -> {row[f'with_{key}']:.{digits}f}"


def ratio(row: Row) -> str:
    return f"**{row['ratio']:.2f}** [{row['ratio_low']:.2f}, {row['ratio_high']:.2f}]"


def verdict(row: Row) -> str:
    """Names what is not faster; see the head of the page."""
    if abs(row["ratio"] - 1.0) < 0.01:
        return ", even"
    if row["ratio"] > 1.0:
        return ""
    return ", *slower*" if row["ratio_high"] < 1.0 else ", *slower, perhaps*"


def slower(rows: list[Row]) -> Iterator[str]:
    """The rows in which rays became slower, once more, the slowest first."""
    found = sorted((row for row in rows if "slower" in verdict(row)), key=lambda row: row["ratio"])
    yield "\n## Slower with the feature\n"
    if not found:
        yield "No row of this run."
    for row in found:
        sides = f"{row['without']} -> {row['with']}"
        yield f"- {row['feature']}, {scene(row)}, {sides}: {ratio(row)}{verdict(row)}."


def link(path: str) -> str:
    return f"[{path}](../{path})"


def source(text: str) -> str:
    """A document or header as a link, a place in the paper as it is."""
    return link(text) if (ROOT / text).is_file() else text


if __name__ == "__main__":
    main()
