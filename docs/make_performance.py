"""Writes docs/performance.md and its plots: how fast we are, what we need, and where we are slower.

    python docs/make_performance.py [bench.json]    # the report of `msbvh bench --peer embree --out DIR`

Without a report it runs the benchmark, with Embree where the package was built with it: some 15 minutes.
Plots need matplotlib (the extra `bench`); without it the page has tables only.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

from msbvh.bench import peer_library
from msbvh.errors import SceneError

ROOT = Path(__file__).resolve().parents[1]
IMAGES = ROOT / "docs" / "images"

Row = dict[str, Any]
KINDS = ("primary", "shadow", "random")

SHARED = """The machine was shared: absolute figures are too low, and only ratios with a narrow spread say much.
"""

HEAD = """# Performance

Made by `{command}` and
`python docs/make_performance.py` (`make bench` runs both in full): msbvh {msbvh}{commit}{peer},
{processor}, {cores} cores, {system}, {instruction_set}; seed {seed}; load average {load_average:.1f} before the run.
{shared}
A cell is the median of {repetitions} rounds (3 at least, where rays take long) with the lowest and the highest in
brackets. In a round each builder and each mode of the peer traces the same rays in turn, so that a ratio (ours over
the peer's rays a second; above 1 we are faster) is taken from measurements that stand side by side. Times of rays are
random: the worst case for caches.
Primary rays come in tiles of 8 x 8 pixels, shadow rays start where they hit and ask for any hit, random rays join two
random points of the scene's box. Ours is always watertight; the peer is measured with its robust flag unless a table
says otherwise, in its high build quality. Where our motion is a curve, or bends at uneven times, the peer has as many
linear keys as bring it within a tenth of a pixel (of 960 across the scene): *peer keys*.
"""


def main() -> None:
    report = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8")) if len(sys.argv) > 1 else measured()
    IMAGES.mkdir(exist_ok=True)
    text = "\n".join(page(report))
    (ROOT / "docs" / "performance.md").write_text(text + "\n", encoding="utf-8")


def measured() -> dict[str, Any]:
    command = [sys.executable, "-m", "msbvh", "bench", "--json", *peer_option()]
    with tempfile.TemporaryFile() as out:
        subprocess.run(command, stdout=out, check=False)
        out.seek(0)
        return json.load(out)


def peer_option() -> list[str]:
    try:
        peer_library("embree")
    except SceneError:
        print("no peer: the package was built without Embree", file=sys.stderr)
        return []
    return ["--peer", "embree"]


def page(report: dict[str, Any]) -> Iterator[str]:
    """The lines of docs/performance.md."""
    machine, rows = report["machine"], report["rows"]
    yield HEAD.format(
        **{
            **machine,
            "command": command_of(machine),
            "shared": SHARED if machine["load_average"] > 0.5 else "",
            "commit": f" ({machine['commit']})" if machine["commit"] else "",
            "peer": f" against {machine['peer']}" if machine["peer"] else "",
        }
    )
    ours = [row for row in rows if row["builder"] == "msbvh" and row["robust"]]
    if plot(ours, bool(machine["peer"])):
        yield "![Ratios and bytes by scene](images/performance.png)\n"
    for threads in machine["threads"]:
        name = "all threads" if threads == 0 else f"{threads} thread{'s' if threads > 1 else ''}"
        yield from table(
            f"Rays a second, {name} (Mrays/s: ours / peer, ratio)",
            [*(f"{kind} rays" for kind in KINDS), "peer keys"],
            group([row for row in ours if row["threads"] == threads]),
            lambda found: [*(speed(found.get(kind)) for kind in KINDS), figure(one(found)["peer_keys"], 0)],
        )
    first = machine["threads"][0]
    ours = [row for row in ours if row["threads"] == first]
    fast = [row for row in rows if row["builder"] == "msbvh" and not row["robust"] and row["threads"] == first]
    if fast:
        title = "Against the peer without its robust flag (Mrays/s: ours / peer, ratio), first number of threads"
        yield from table(
            title, list(KINDS), group(fast), lambda found: [speed(found.get(kind)) for kind in KINDS]
        )
    yield from cost_table(ours)
    yield from builder_table(rows, first)
    yield from check_table(ours)


def command_of(machine: dict[str, Any]) -> str:
    """The command line that made the report."""
    words = ["msbvh bench"]
    words += ["--peer embree"] if machine["peer"] else []
    words += ["--quick"] if machine["quick"] else []
    words += [f"--scenes {','.join(machine['scenes'])}"] if machine["scenes"] != ["*"] else []
    words += [f"--triangles {machine['triangles']}"] if machine["triangles"] else []
    words += [f"--threads {','.join(map(str, machine['threads']))}"] if machine["threads"] != [1, 0] else []
    return " ".join(words)


def group(rows: Iterable[Row]) -> dict[tuple[Any, ...], dict[str, Row]]:
    """(scene, triangles, keys, degree) -> kind of ray -> row."""
    found: dict[tuple[Any, ...], dict[str, Row]] = {}
    for row in rows:
        found.setdefault((row["scene"], row["triangles"], row["keys"], row["degree"]), {})[row["rays"]] = row
    return found


def one(found: dict[str, Row]) -> Row:
    return next(iter(found.values()))


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
    if row is None:
        return "-"
    if row["ratio"] is None:
        return f"{row['mrays']:.2f} [{row['mrays_low']:.2f}, {row['mrays_high']:.2f}]"
    ratio = f"**{row['ratio']:.2f}** [{row['ratio_low']:.2f}, {row['ratio_high']:.2f}]"
    return f"{row['mrays']:.2f} / {row['peer_mrays']:.2f}, {ratio}"


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
            f"{row['build_s']:.2f} ({split})",
            figure(row["peer_build_s"], 2),
            figure(row["duplication"], 2),
            figure(row["sah"], 1),
        ]

    columns = ["bytes/triangle (nodes + leaves + vertices)", "peer", "build s (topology + the rest)", "peer"]
    columns += ["references/triangle", "SAH"]
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
        "Builders: random rays, Mrays/s (nodes, triangles a ray; build)",
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
            f"{sum(row['mismatches'] for row in every)} of {sum(row['oracle_rays'] for row in every)}",
            f"{sum(differ):.0f} of {sum(row['ray_count'] for row in every)}" if differ else "-",
        ]

    columns = ["leaks of 131072", "the peer's", "oracle disagrees", "hits unlike the peer's"]
    yield from table("Right or wrong", columns, group(ours), cells)
    yield "Leaks: rays from inside a closed scene that hit nothing. Hits unlike: one side hits and the other does"
    yield "not, or their distances differ by more than 1e-4 of the scene; not compared where the motion differs."


def plot(ours: list[Row], peer: bool) -> bool:
    """docs/images/performance.png; False where matplotlib is not installed or there is no peer."""
    try:
        import matplotlib
    except ImportError:
        return False
    if not peer:
        return False
    matplotlib.use("Agg")
    from matplotlib import pyplot

    groups = group(row for row in ours if row["threads"] == ours[0]["threads"])
    names = [f"{scene}, {keys} keys" for scene, _, keys, _ in groups]
    places = range(len(names))
    size = (11, 1.5 + 0.36 * len(names))
    figure_, (left, right) = pyplot.subplots(1, 2, figsize=size, sharey=True, layout="constrained")
    for i, kind in enumerate(KINDS):
        values = [found[kind]["ratio"] if kind in found else 0.0 for found in groups.values()]
        left.barh([place + 0.27 * (i - 1) for place in places], values, 0.25, label=f"{kind} rays")
    left.axvline(1.0, color="black", linewidth=0.8)
    left.set_yticks(list(places), names)
    left.invert_yaxis()
    left.set_xlabel("rays a second, ours / peer (robust)")
    left.legend()
    bytes_ = [one(found) for found in groups.values()]
    right.barh([p - 0.2 for p in places], [row["bytes_per_tri"] for row in bytes_], 0.38, label="ours")
    right.barh([p + 0.2 for p in places], [row["peer_bytes_per_tri"] or 0 for row in bytes_], 0.38, label="peer")
    right.set_xscale("log")
    right.set_xlabel("bytes a triangle")
    right.legend()
    figure_.savefig(IMAGES / "performance.png", dpi=80)
    return True


if __name__ == "__main__":
    main()
