"""The section of docs/stability.md that `msbvh bench --stability` fills: rays that closed moving shapes, tubes and spheres
let through, ours and a peer's."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from msbvh import _core
from msbvh.bench.stability import per_million

Row = dict[str, Any]
Report = dict[str, Any]

AIMS = ("in any direction", "at edges", "at vertices", "along faces", "from surface", "in planes of boxes")
"""As core/probe/inside_rays.h names them; rays take them in turn."""
INSIDE, PLAIN, ROUND = "from inside", "from inside, plain", "into round"
"""As bench/stability_cells.h has it: what a row's rays are."""

FOUND = """## {heading}

Made by `{command}`: msbvh {msbvh}{commit}{peer}, {processor},
{instruction_set}, seed {seed}; {minutes:.1f} minutes{runs}.{alone} A ray that hits nothing is lost.

"""
HEADING = "Rays from inside of closed moving shapes, and into tubes and spheres"

METHOD = """### What was tried

{rays:,} rays in {rows} rows: {shapes} shapes, {motions} motions, {forms} kinds of track, {places} places. Both sides get the
same shapes and the same rays. We are asked in four ways (one ray or many, closest or any hit) by each instruction set of this
machine; a peer one ray at a time and in packets of 16, with its robust flag, built in high quality, denormals flushed as it
asks. A figure is that of the worst of a side's ways: rays lost of a million, "-" where nothing was measured, since a peer has
linear keys alone.

- **Closed shapes.** A ray starts at a point that the shape surrounds at the ray's time, farther from the surface than what single
  precision rounds, or on the surface and goes through that point. Rays take six aims in turn; half of the times are random, half
  are at keys and at their neighbours in single precision.
- **Tubes and spheres.** A ray starts outside of everything, from the side of a tube, and ends well inside of one, away from a
  tube's free ends: it must be stopped before. Embree's tubes (round Bezier curves) are not held against the oracle, since it may
  close them otherwise. Ribbons have no inside. A displaced surface is its triangles for Embree, whose own displacement has no
  such lattice.
- **Degenerate motion**: `ball` and `cube` at three places, `ball` alone where triangles become slivers.
"""

LIMITS = """**How to read it.** Each row weighs the same, and these rows are hard on purpose: shapes at 10^7, motion of 24 times a
shape's size within a shutter, and four aims of six at places where a tracer is likeliest to lose a ray. A picture has fewer
such rays: these shares are not what a frame loses. Zero of {rays:,} rays are no proof: docs/design/watertight.md has
that. Why Embree loses what it loses was not looked into. Where a shape has next to no volume, or is small beside what single
precision resolves there, no start is safely inside, and a row has fewer rays.
"""


def section(report: Report) -> str:
    """All of it, with its heading; what was found comes first."""
    rows = report["rows"]
    closed, all_aims = _of(rows, INSIDE, degenerate=False), _of(rows, INSIDE)
    parts = [_head(report) + "".join(f"- {line}\n" for line in reading(report))]
    parts.append(LIMITS.format(rays=sum(row["rays"] for row in rows)))
    parts.append(_method(rows))
    parts.append("### Closed shapes by place and keys\n\n" + by_place_and_keys(closed))
    if round_rows := _of(rows, ROUND):
        parts.append("### Tubes and spheres by place and keys\n\n" + by_place_and_keys(round_rows))
    parts.append("### By shape\n\n" + by(rows, "shape", _core.stability_shapes()))
    parts.append("### Closed shapes by motion\n\n" + by(all_aims, "motion", _core.stability_motions()))
    parts.append("### Closed shapes by aim, and by time\n\n" + by_aim(all_aims))
    parts.append("### Farther from double precision than the stated bound\n\n" + wrong_by_place(rows))
    return "\n".join(parts)


def _of(rows: Sequence[Row], probe: str, degenerate: bool | None = None) -> list[Row]:
    return [row for row in rows if row["probe"] == probe and degenerate in (None, row["degenerate"])]


def joined(reports: Sequence[Report]) -> Report:
    """Reports of several shapes as one. Raises ValueError unless all are of one commit, machine, seed and size."""
    same = ("commit", "processor", "instruction_set", "peer", "seed", "rays", "quick")
    first = reports[0]["machine"]
    for report in reports[1:]:
        for key in same:
            if report["machine"][key] != first[key]:
                raise ValueError(f"reports: found {key} {first[key]} and {report['machine'][key]}; expected one")
    machines = [report["machine"] for report in reports]
    together = {
        "seconds": sum(machine["seconds"] for machine in machines),
        "load_average": max(machine["load_average"] for machine in machines),
        "scenes": [name for machine in machines for name in machine["scenes"]],
        "runs": len(machines),
    }
    return {
        "machine": {**first, **together},
        "rows": [row for report in reports for row in report["rows"]],
    }


def _head(report: Report) -> str:
    machine, rows = report["machine"], report["rows"]
    peer, scenes = machine["peer"], ",".join(machine["scenes"])
    command = [
        "msbvh bench --stability",
        *(["--peer embree"] if peer else []),
        *(["--quick"] if machine["quick"] else []),
    ]
    if scenes != "*" and {row["shape"] for row in rows} != set(_core.stability_shapes()):
        command.append(f"--scenes '{scenes}'")

    return FOUND.format(
        heading=HEADING,
        command=" ".join(command),
        commit=f" ({machine['commit']})" if machine["commit"] else "",
        msbvh=machine["msbvh"],
        peer=f", beside {peer}" if peer else "",
        alone="" if peer else " **Embree was not found: our column stands alone.**",
        processor=machine["processor"],
        instruction_set=machine["instruction_set"],
        seed=machine["seed"],
        minutes=machine["seconds"] / 60,
        runs=f" in {machine['runs']} runs at a load of up to {machine['load_average']:.0f}"
        if "runs" in machine
        else "",
    )


def _method(rows: Sequence[Row]) -> str:
    def kinds(*keys: str) -> int:
        return len({tuple(row[key] for key in keys) for row in rows})

    return METHOD.format(
        rays=sum(row["rays"] for row in rows),
        rows=len(rows),
        shapes=kinds("shape"),
        motions=kinds("motion"),
        forms=kinds("keys", "degree"),
        places=kinds("position", "scale"),
    )


def reading(report: Report) -> Iterator[str]:
    """What the figures say, a sentence each; what is ours and wrong comes first."""
    rows = report["rows"]
    bad = [row for row in rows if row["leaks"] or row["wrong"]]
    for row in bad:
        yield f"**Ours is wrong**: {name(row)}: {row['leaks']:.0f} of {row['rays']} rays lost, {row['wrong']:.0f} differ."
    if not bad:
        judged = sum(row["judged"] for row in rows)
        total = sum(row["rays"] for row in rows)
        yield f"Ours: 0 of {total:,} rays are lost, and 0 of {judged:,} judged differ beyond the bound."
    beside = [row for row in rows if row["peer_leaks"] is not None]
    if beside:
        yield from _reading_of_peer(beside, report["machine"]["peer"])


def _reading_of_peer(rows: Sequence[Row], peer: str) -> Iterator[str]:
    closed = _of(rows, INSIDE, degenerate=False)
    leaking = [row for row in closed if row["peer_leaks"]]
    yield (
        f"{peer}: {_million(closed, 'peer_leaks')} of a million rays get out of closed shapes, over all {len(closed)} rows"
        f" that it has; {len(leaking)} of them leak at all."
    )
    for row in _of(rows, PLAIN):
        triangles = _core.stability_shapes()[row["shape"]].partition(",")[0]
        share = _million([row], "peer_leaks")
        yield f"{triangles.capitalize()}, rays in any direction at any time ({name(row)}): {share} of a million."
    worst = max(closed, key=lambda row: row["peer_leaks"] / max(1, row["rays"]), default=None)
    if worst and worst["peer_leaks"]:
        yield f"Its worst other row: {name(worst)}: {_million([worst], 'peer_leaks')} of a million."
    still = sorted({row["keys"] for row in closed} - {row["keys"] for row in leaking})
    if still:
        yield f"It loses none with {_listed(still)} keys."
    at, between = _by_time(closed, "peer_")
    yield f"At keys and next to them it loses {at} of a million, at other times {between}."
    if degenerate := _of(rows, INSIDE, degenerate=True):
        yield f"In degenerate motion: {_million(degenerate, 'peer_leaks')} of a million, over {len(degenerate)} rows."
    for shape in dict.fromkeys(row["shape"] for row in _of(rows, ROUND)):
        share = _million([row for row in rows if row["shape"] == shape], "peer_leaks")
        yield f"Into {_core.stability_shapes()[shape].partition(',')[0]}: {share} of a million."


def _listed(numbers: Sequence[int]) -> str:
    """`2, 3 and 9`."""
    *first, last = map(str, numbers)
    return f"{', '.join(first)} and {last}" if first else last


def name(row: Row) -> str:
    """`ball, rotation, 129 keys, position 10000, scale 1`."""
    track = f"{row['keys']} keys" if row["degree"] == 1 else f"two pieces of degree {row['degree']}"
    return f"{row['shape']}, {row['motion']}, {track}, position {row['position']:g}, scale {row['scale']:g}"


def by_place_and_keys(rows: Sequence[Row]) -> str:
    """Ours and the peer's, a line a place, columns a kind of track."""
    forms = sorted({(row["degree"], row["keys"]) for row in rows})
    places = sorted({(row["position"], row["scale"]) for row in rows})

    def heading(form: tuple[int, int]) -> str:
        return f"{form[1]} keys: ours, Embree" if form[0] == 1 else f"two pieces of degree {form[0]}: ours, Embree"

    def line(place: tuple[float, float]) -> list[str]:
        here = [row for row in rows if (row["position"], row["scale"]) == place]
        return [
            f"{place[0]:g}",
            f"{place[1]:g}",
            *(_both([row for row in here if (row["degree"], row["keys"]) == form]) for form in forms),
        ]

    return _table(["position", "scale", *map(heading, forms)], map(line, places))


def by(rows: Sequence[Row], key: str, what: dict[str, str]) -> str:
    """A line for each value of a key."""

    def line(value: str) -> list[str]:
        here = [row for row in rows if row[key] == value]
        return [value, what[value], f"{sum(row['rays'] for row in here):,}", *_columns(here, "leaks")]

    found = dict.fromkeys(row[key] for row in rows)
    return _table([key, "", "rays", "ours", "Embree"], map(line, found))


def by_aim(rows: Sequence[Row]) -> str:
    """A line an aim, then the two kinds of times."""
    lines = []
    for aim in AIMS:
        lines.append([aim, *_columns(rows, f"leaks {aim}", f"rays {aim}")])
    both = [_by_time(rows, side) for side in ("", "peer_")]
    lines.append(["at keys and next to them", *(side[0] for side in both)])
    lines.append(["at other times", *(side[1] for side in both)])
    return _table(["rays", "ours", "Embree"], lines)


def wrong_by_place(rows: Sequence[Row]) -> str:
    """Per million of the judged rays."""

    def line(place: tuple[float, float]) -> list[str]:
        here = [row for row in rows if (row["position"], row["scale"]) == place]
        judged = f"{sum(row['judged'] for row in here):,}"
        return [f"{place[0]:g}", f"{place[1]:g}", judged, *_columns(here, "wrong", "judged")]

    places = sorted({(row["position"], row["scale"]) for row in rows})
    return (
        "A sample of the same rays, one at a time, is judged by the oracle (core/trace/oracle.h): nothing that is hit clearly"
        " may lie\nclearly before the answer, and something must lie there. Per million judged.\n\n"
        + _table(["position", "scale", "judged", "ours", "Embree"], map(line, places))
    )


def _by_time(rows: Sequence[Row], side: str) -> tuple[str, str]:
    """Leaks per million at keys, and at other times."""
    kept = [row for row in rows if row[f"{side}leaks"] is not None]
    leaks, at_keys = (sum(row[f"{side}{key}"] for row in kept) for key in ("leaks", "leaks_at_keys"))
    rays, rays_at_keys = (sum(row[key] for row in kept) for key in ("rays", "rays_at_keys"))

    def share(part: float, whole: float) -> str:
        return f"{1e6 * part / whole:,.0f}" if whole else "-"

    return share(at_keys, rays_at_keys), share(leaks - at_keys, rays - rays_at_keys)


def _million(rows: Sequence[Row], figure: str, of: str = "rays") -> str:
    share = per_million(rows, figure, of)
    return "-" if share is None else f"{share:,.0f}"


def _columns(rows: Sequence[Row], figure: str, of: str = "rays") -> list[str]:
    return [_million(rows, figure, of), _million(rows, f"peer_{figure}", of)]


def _both(rows: Sequence[Row]) -> str:
    return ", ".join(_columns(rows, "leaks"))


def _table(headings: Sequence[str], lines: Iterable[Sequence[str]]) -> str:
    every = [headings, ["---"] * len(headings), *lines]
    return "".join(f"| {' | '.join(cells)} |\n" for cells in every)
