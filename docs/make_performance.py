"""Writes docs/performance.md and its plots: how fast we are, what we need, and where we are slower.

    python docs/make_performance.py [--allow-dirty] [--cycles] [--frames frames.json ... | --no-frames] [bench.json]

bench.json is the report of `msbvh bench --peer embree --json`. Without it the benchmark runs with the options in
MEASURED, beside Embree where the wheel embreex is installed: some 15 minutes on two quiet cores. frames.json is the report
of `msbvh bench --frames --json`, of all scenes or several of some of them; without it frames are measured (half an hour), with
--cycles beside Cycles (2 hours), or, with --no-frames, left out. Plots
need matplotlib; the extra `bench` brings both. A page is of a commit: a tree with uncommitted changes is refused, or with
--allow-dirty marked.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import performance_frames
import provenance
from msbvh.base.errors import SceneError
from msbvh.bench.rays import find_peer
from performance_plot import plot
from performance_rows import KINDS, Row, group, one

ROOT = Path(__file__).resolve().parents[1]
IMAGES = ROOT / "docs" / "images"

PEER_MODES = {"single": "one", "packet_coherent": "packets, coherent", "packet_incoherent": "packets, incoherent"}
"""The peer's modes as the report names them: the heading of their column."""

MEASURED = ("--triangles", "100000")
"""What the page is made of: every scene class at a size at which Embree's packets still find much in the caches. Each
class's own size, up to 2 million triangles, takes hours."""

SHARED = """The machine was shared: absolute figures are too low, and only ratios with a narrow spread say much.
"""

LOADED = """**The machine had much more to do than it has cores** (load {load_average:.0f}): even ratios are rough. Make this page
again on a quiet one.
"""

DIRTY = """**Made from a tree with uncommitted changes**: the commit above does not reproduce it.
"""

HEAD = """# Performance

Made by `{command}` and
`python docs/make_performance.py` (`make bench` runs both): msbvh {msbvh}{commit}{peer},
{processor}, {cores} cores, {system}; our instruction set: {instruction_set}; seed {seed}; load average
{load_average:.1f} before the run, which took {minutes:.0f} minutes.
{shared}{dirty}
**What is compared.** All sides trace the same rays in one process, on the same threads, in turn: a round has one turn of
each. We are asked one ray at a time (*one*) and a thousand at once, as the renderer asks (*many*). {peer_asked}
A cell is the median of {repetitions} rounds (3 at least, where rays take long) in millions of rays a second. The
**ratio** is ours, many at once, over the best of the peer's modes in that cell, from turns that stand side by side,
with the lowest and the highest of the rounds in brackets: above 1 we are faster, and *slower* marks where we are not
(*perhaps*: not in every round). A mode that was 2.5 times as slow as its side's best in a first round, which does not count
for the others, has the figure of that round. The last column compares one ray at a time with one ray at a time.

**What is traced.** Times of rays are random: the worst case for caches and packets. Primary rays come in tiles of 8 x 8
pixels along a Z curve, so that a packet is a square of 4 x 4; shadow rays start where they hit and ask for any hit;
random rays join two random points of the scene's box. Ours is always watertight; the peer has its robust flag set unless
a table says otherwise. Where our motion is a curve, or has breakpoints at uneven times, the peer has as many linear keys as bring
it within a tenth of a pixel (of 960 across the scene): *peer keys* in the table of bytes.
"""

ASKED = """{peer}
builds in its high quality (which cuts triangles to pieces only where nothing moves and the robust flag is not set) and
is asked one ray at a time (`rtcIntersect1`, `rtcOccluded1`) and in packets of 16 (`rtcIntersect16`, `rtcOccluded16`) with
the coherent and with the incoherent flag; its rays are in its own layout before the clock starts, and its threads flush
denormals as it asks."""

NO_PEER = "There was no peer in this run."

NO_FRAMES = """## Whole frames

Not measured for this page.
"""


def main() -> None:
    options = argument_parser().parse_args()
    try:
        report = of_file(options.report, options.allow_dirty) if options.report else measured(options.allow_dirty)
        frames = None if options.no_frames else frames_report(options)
    except provenance.DirtyTree as error:
        sys.exit(f"make_performance: error: {error}")
    IMAGES.mkdir(exist_ok=True)
    of_frames = performance_frames.section(frames) if frames else [NO_FRAMES]
    text = "\n".join([*page(report), *of_frames])
    (ROOT / "docs" / "performance.md").write_text(text + "\n", encoding="utf-8")


def argument_parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description="Writes docs/performance.md.")
    parser.add_argument("report", nargs="?", type=Path, help="of `msbvh bench --json`; default: measures")
    parser.add_argument(
        "--frames",
        type=Path,
        action="append",
        help="of `msbvh bench --frames --json`; may be repeated, for reports of other scenes; default: measures",
    )
    parser.add_argument("--no-frames", action="store_true", help="leave whole frames out")
    parser.add_argument(
        "--cycles", action="store_true", help="measure frames beside Cycles: see msbvh bench --peer-env"
    )
    parser.add_argument(
        "--allow-dirty", action="store_true", help="mark a tree with uncommitted changes, don't refuse it"
    )
    return parser


def of_file(path: Path, allow_dirty: bool) -> dict[str, Any]:
    """A report that was made before. Raises DirtyTree for one of a tree with uncommitted changes."""
    report: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    found = report["machine"]["commit"]
    if (found is None or found.endswith("-dirty")) and not allow_dirty:
        raise provenance.DirtyTree(f"{path}: found a report of commit {found}; expected one of a clean tree")
    return report


def frames_report(options: argparse.Namespace) -> dict[str, Any]:
    """Of whole frames, from a file or measured. Raises DirtyTree."""
    if options.frames:
        return performance_frames.joined([of_file(path, options.allow_dirty) for path in options.frames])
    return measured(options.allow_dirty, "--frames", *(["--peer", "cycles"] if options.cycles else []))


def measured(allow_dirty: bool, *arguments: str) -> dict[str, Any]:
    """Runs the benchmark, of rays unless arguments say otherwise. Raises DirtyTree."""
    commit = provenance.commit(allow_dirty=allow_dirty)
    command = [sys.executable, "-m", "msbvh", "bench", "--json", *(arguments or (*MEASURED, *peer_option()))]
    with tempfile.TemporaryFile() as out:
        subprocess.run(command, stdout=out, check=False)  # its exit code tells of wrong answers: the page shows them
        out.seek(0)
        report: dict[str, Any] = json.load(out)
    report["machine"]["commit"] = commit
    return report


def peer_option() -> list[str]:
    try:
        find_peer("embree")
    except SceneError as error:
        print(f"make_performance: warning: the page has no peer: {error}", file=sys.stderr)
        return []
    return ["--peer", "embree"]


def page(report: dict[str, Any]) -> Iterator[str]:
    """The lines of docs/performance.md."""
    machine, rows = report["machine"], report["rows"]
    yield head(machine)
    beside = bool(machine["peer"])
    ours = [row for row in rows if row["builder"] == "msbvh" and row["robust"]]
    if beside and plot(ours, IMAGES / "performance.png"):
        yield "![Ratios and bytes by scene](images/performance.png)\n"
    for threads in machine["threads"]:
        name = "all threads" if threads == 0 else f"{threads} thread{'s' if threads > 1 else ''}"
        chosen = [row for row in ours if row["threads"] == threads]
        for kind in KINDS:
            yield from speed_table(f"{kind.capitalize()} rays, {name} (Mrays/s)", chosen, kind, beside)
        if beside:
            yield from slower(f"Where we are slower, {name}", chosen)
    first = machine["threads"][0]
    ours = [row for row in ours if row["threads"] == first]
    fast = [row for row in rows if row["builder"] == "msbvh" and not row["robust"] and row["threads"] == first]
    if fast:
        title = (
            "Against the peer without its robust flag, first number of threads (Mrays/s: ours many / its best, ratio)"
        )
        yield from table(title, list(KINDS), group(fast), lambda found: [speed(found.get(kind)) for kind in KINDS])
        yield from slower("Where we are slower than the peer without its robust flag", fast)
    yield from cost_table(ours)
    yield from builder_table(rows, first)
    yield from check_table(ours)


def head(machine: dict[str, Any]) -> str:
    """What the figures depend on, and what they mean."""
    commit, peer = machine["commit"], machine["peer"]
    return HEAD.format(
        **{
            **machine,
            "command": command_of(machine),
            "minutes": machine["seconds"] / 60,
            "shared": shared(machine),
            "dirty": DIRTY if commit is None or commit.endswith("-dirty") else "",
            "commit": f" ({commit})" if commit else "",
            "peer": f" against {peer}" if peer else "",
            "peer_asked": ASKED.format(peer=peer) if peer else NO_PEER,
        }
    )


def shared(machine: dict[str, Any]) -> str:
    """What other work on the machine means for the figures."""
    if machine["load_average"] > 2 * machine["cores"]:
        return LOADED.format(**machine)
    return SHARED if machine["load_average"] > 0.5 else ""


def speed_table(title: str, rows: list[Row], kind: str, beside: bool) -> Iterator[str]:
    """A row a scene: each side in each of its modes."""
    columns = ["ours: one", "ours: many"]
    if beside:
        columns += [f"peer: {heading}" for heading in PEER_MODES.values()]
        columns += ["**ratio**: many / its best", "one / one"]

    def cells(found: dict[str, Row]) -> list[str]:
        row = found[kind]
        ours = [figure(row["single_mrays"], 2), figure(row["mrays"], 2)]
        if not beside:
            return ours
        if row["ratio"] is None:  # what the peer cannot show
            return [*ours, *["-"] * (len(PEER_MODES) + 2)]
        return [*ours, *peer_cells(row), ratio(row), figure(row["single_ratio"], 2)]

    yield from table(title, columns, group(row for row in rows if row["rays"] == kind), cells)


def peer_cells(row: Row) -> list[str]:
    """Each mode; the best one in italics."""
    cells = {mode: figure(row[f"peer_{mode}_mrays"], 2) for mode in PEER_MODES}
    return [f"*{cell}*" if mode == row["peer_mode"] else cell for mode, cell in cells.items()]


def ratio(row: Row) -> str:
    return f"**{row['ratio']:.2f}** [{row['ratio_low']:.2f}, {row['ratio_high']:.2f}]{verdict(row)}"


def verdict(row: Row) -> str:
    """Marks a cell in which we are slower."""
    if row["ratio"] >= 1.0:
        return ""
    return " *slower*" if row["ratio_high"] < 1.0 else " *slower, perhaps*"


def slower(title: str, rows: list[Row]) -> Iterator[str]:
    """The cells in which we are slower once more, the slowest first."""
    every = [row for row in rows if row["ratio"] is not None]
    found = sorted((row for row in every if row["ratio"] < 1.0), key=lambda row: row["ratio"])
    yield f"## {title}: {len(found)} of {len(every)} cells\n"
    for row in found:
        keys = "1 key" if row["keys"] == 1 else f"{row['keys']} keys"
        yield f"- {row['scene']}, {keys}, {row['rays']} rays: {ratio(row)}, by {PEER_MODES[row['peer_mode']]}"
    yield ""


def command_of(machine: dict[str, Any]) -> str:
    """The command line that made the report."""
    words = ["msbvh bench"]
    words += ["--peer embree"] if machine["peer"] else []
    words += ["--quick"] if machine["quick"] else []
    words += [f"--scenes {','.join(machine['scenes'])}"] if machine["scenes"] != ["*"] else []
    words += [f"--triangles {machine['triangles']}"] if machine["triangles"] else []
    words += [f"--threads {','.join(map(str, machine['threads']))}"] if machine["threads"] != [1, 0] else []
    words += [f"--builder {name}" for name in machine["builders"]]
    words += [f"--seed {machine['seed']}"] if machine["seed"] != 1 else []
    usual = 3 if machine["quick"] else 5
    words += [f"--repetitions {machine['repetitions']}"] if machine["repetitions"] != usual else []
    return " ".join(words)


def table(
    title: str,
    columns: list[str],
    groups: dict[tuple[Any, ...], dict[str, Row]],
    cells: Callable[[dict[str, Row]], list[str]],
) -> Iterator[str]:
    yield f"## {title}\n"
    yield f"| scene | triangles | keys | {' | '.join(columns)} |"
    yield "|---" * (len(columns) + 3) + "|"
    for (scene, triangles, keys, degree), found in groups.items():
        form = f"{keys}" if degree == 1 else f"{keys}, degree {degree}"
        yield f"| {' | '.join([scene, str(triangles), form, *cells(found)])} |"
    yield ""


def speed(row: Row | None) -> str:
    if row is None or row["ratio"] is None:
        return "-"
    return f"{row['mrays']:.2f} / {row['peer_mrays']:.2f}, {ratio(row)}"


def figure(value: float | None, digits: int) -> str:
    return "-" if value is None else f"{value:.{digits}f}"


def cost_table(ours: list[Row]) -> Iterator[str]:
    """Bytes and build times."""

    def cells(found: dict[str, Row]) -> list[str]:
        row = one(found)
        parts = [row[f"{part}_bytes_per_tri"] for part in ("node", "leaf", "vertex")]
        bytes_ = f"{row['bytes_per_tri']:.0f} ({' + '.join(figure(part, 0) for part in parts)})"
        split = f"{row['topology_s']:.2f} + {row['bounds_s']:.2f}"
        return [
            bytes_,
            figure(row["peer_bytes_per_tri"], 0),
            figure(row["peer_keys"], 0),
            f"{row['build_s']:.2f} ({split})",
            figure(row["peer_build_s"], 2),
            figure(row["duplication"], 2),
            figure(row["sah"], 1),
        ]

    columns = ["bytes/triangle (nodes + leaves + vertices)", "peer", "peer keys"]
    columns += ["build s (topology + the rest)", "peer", "references/triangle", "SAH"]
    yield from table("Bytes and build time, first number of threads", columns, group(ours), cells)
    yield "Bytes are all that traversal reads; the peer's are what it holds after the build, by its own memory"
    yield "monitor, and its moving vertices. SAH: averaged over the shutter, in node tests.\n"


def builder_table(rows: list[Row], threads: int) -> Iterator[str]:
    """Each builder's rays a second and work on random rays."""
    builders = list(dict.fromkeys(row["builder"] for row in rows))
    chosen = [row for row in rows if row["rays"] == "random" and row["robust"] and row["threads"] == threads]
    by_builder = [{**row, "rays": row["builder"]} for row in chosen]

    def cell(row: Row) -> str:
        return f"{row['mrays']:.2f} ({row['nodes_per_ray']:.1f}, {row['tests_per_ray']:.1f}; {row['build_s']:.2f} s)"

    yield from table(
        "Builders: random rays, many at once, Mrays/s (nodes, triangles a ray; build)",
        builders,
        group(by_builder),
        lambda found: [cell(found[builder]) for builder in builders],
    )


def check_table(ours: list[Row]) -> Iterator[str]:
    """Leaks, the oracle, and the peer's hits."""

    def cells(found: dict[str, Row]) -> list[str]:
        every = list(found.values())
        differ = [row["peer_mismatches"] for row in every if row["peer_mismatches"] is not None]
        return [
            figure(one(found)["misses"], 0),
            figure(one(found)["peer_misses"], 0),
            str(sum(row["mode_mismatches"] for row in every)),
            f"{sum(row['mismatches'] for row in every)} of {sum(row['oracle_rays'] for row in every)}",
            f"{sum(differ):.0f} of {sum(row['ray_count'] for row in every)}" if differ else "-",
        ]

    columns = ["leaks of 131072", "the peer's", "one unlike many", "oracle disagrees", "hits unlike the peer's"]
    yield from table("Right or wrong", columns, group(ours), cells)
    yield "Leaks: rays from inside a closed scene that hit nothing. Hits unlike: one side hits and the other does"
    yield "not, or their distances differ by more than 1e-4 of the scene, in the worst of its modes; not compared where the"
    yield "motion differs. Our own two modes must agree to the bit: the benchmark fails where they don't."


if __name__ == "__main__":
    main()
