"""The page docs/ablation.md from rows of docs/make_ablation.py; nothing here knows a figure."""

from __future__ import annotations

import math
import random
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean, median
from typing import Any

Row = dict[str, Any]
"""Of an effect: "on" for table 1, "omitted" for table 2, "beside" for table 3; what is absent was not measured."""

RESAMPLES = 10_000
CONFIDENCE = 0.95
NOT_MEASURED = "not measured"
NO_CODE = ("subdivision",)
"""Effects that the front-end turns into triangles: a frame has no code for them."""
NO_EFFECTS = ("all at once", "stage marks")
"""Rows of code that is left out, but not of one effect."""


@dataclass(frozen=True)
class Machine:
    """What the rows were measured on."""

    commit: str
    processor: str
    cores: int
    system: str


HEAD = """# What each effect costs, and what it costs where it is off

Made by `python docs/make_ablation.py`: msbvh ({commit}), {processor}, {cores} cores, {system}; {loads}.
Rows that were not measured say so, and which command makes them. Seconds are medians of one thread's, of a frame of 4
samples a pixel; on a machine that others use too only the ratios and their spread say much.

## With the effect

The base scene is one bumpy ball of still triangles under one distant light of no extent, without bounces and AOVs, through a
pinhole that stands still. Each row is that scene with what the effect *needs*, against the same with the effect, rendered in
turn; the ratio is the median of the rounds' own ratios, with the lowest and the highest in brackets. Some effects bring
geometry or rays of their own, which the columns show: a ratio is not the price of an instruction.

| effect | on top of | s | ratio | rays | tree bytes |
|---|---|---|---|---|---|"""

OMITTED = """
## Without its code

Each row is the base scene, which needs no effect, rendered by a build that has every effect and by one from which the code of
this one was left out (`-DMSBVH_OMIT_EFFECTS`). *Bits*: of the pixels. *Instructions*: of all tiles of a frame of 64 x 64 pixels
and 2,000 triangles by `valgrind --tool=callgrind --toggle-collect='msbvh::render_tile(*'`, by the kernels of SSE4 and of AVX2,
with and without; AVX-512 is not counted, which valgrind does not know. *Time*: without over with, the median of interleaved pairs
and its {confidence:.0%} interval by {resamples:,} resamples, as the second witness. Equal code may lie elsewhere in memory, so
that time may differ where instructions do not.

Deforming keys and moving instances share the kernels of moving trees: leaving out one of the two leaves those in. Displaced
triangle meshes and subdivision come from the front-end as triangles: of displacement the code of patches is left out, of
subdivision there is none. *All at once* is a build that knows nothing but still triangles under lights without extent. *Stage
marks* are no effect: they are what `msbvh plan --measure` looks at.

| effect | bits | instructions, SSE4 | instructions, AVX2 | time |
|---|---|---|---|---|"""

BESIDE = """
## Beside other effects

The same builds on the frames of the first table, of 32 x 32 pixels and 500 triangles: those of every other effect that does
without the one whose code was left out. *Equal*: on how many of them both builds count the same instructions. *Differ*: on the
rest, how many more the whole build takes of both frames, with that other effect and without, by the kernels of AVX2. Scenes of
more than still triangles share one variant of the code that reads surfaces, which knows all kinds of geometry and of motion, so
that what is off costs branches there. Less than nothing is the compiler's choice of what to inline.

| effect | equal | differ |
|---|---|---|"""


def page(machine: Machine, rows: Mapping[str, Row]) -> Iterator[str]:
    """Its lines. `rows`: by effect, in the order of the tables."""
    yield HEAD.format(**vars(machine), loads=_loads(rows))
    for effect, row in rows.items():
        if effect not in NO_EFFECTS:
            yield f"| {' | '.join(on_cells(effect, row.get('on')))} |"
    yield OMITTED.format(confidence=CONFIDENCE, resamples=RESAMPLES)
    for effect, row in rows.items():
        yield f"| {' | '.join(omitted_cells(effect, row.get('omitted')))} |"
    yield from unequal(rows)
    yield BESIDE
    for effect, row in rows.items():
        if effect != "all at once":
            yield f"| {' | '.join(beside_cells(effect, row.get('beside')))} |"


def _loads(rows: Mapping[str, Row]) -> str:
    """How busy the machine was: load averages of a minute."""
    loads = [table["load"] for row in rows.values() for table in row.values() if "load" in table]
    if not loads:
        return "nothing was measured"
    return f"load averages from {min(loads):.1f} to {max(loads):.1f} after each row"


def _not_measured(effect: str) -> str:
    return f"{NOT_MEASURED}: `--only {effect.lower().replace(' ', '-')}`"


def on_cells(effect: str, row: Row | None) -> list[str]:
    if row is None:
        return [effect, _not_measured(effect), "", "", "", ""]
    return [
        effect,
        row["needs"] or "the base scene",
        f"{row['without_seconds']:.4f} -> {row['with_seconds']:.4f}",
        f"**{row['ratio']:.3f}** [{row['ratio_low']:.3f}, {row['ratio_high']:.3f}]",
        f"{row['without_rays']:,} -> {row['with_rays']:,}",
        f"{row['without_bytes']:,} -> {row['with_bytes']:,}",
    ]


def omitted_cells(effect: str, row: Row | None) -> list[str]:
    if row is None:
        return [effect, _not_measured(effect), "", "", ""]
    name = f"{effect} (no code)" if effect in NO_CODE else effect
    bits = "equal" if bits_equal(row) else "**differ**"
    return [name, bits, _count(row["count"]["sse4"]), _count(row["count"]["avx2"]), _time(row["seconds"])]


def beside_cells(effect: str, row: Row | None) -> list[str]:
    if row is None:
        return [effect, _not_measured(effect), ""]
    extra = {other: whole / without - 1.0 for other, (whole, without) in row.items() if whole != without}
    differ = ", ".join(f"{other} {share:+.2%}" for other, share in extra.items())
    return [effect, f"{len(row) - len(extra)} of {len(row)}", differ]


def bits_equal(row: Row) -> bool:
    return all(with_all == without for with_all, without in row["hash"].values())


def _count(pair: Sequence[int]) -> str:
    with_all, without = pair
    if with_all == without:
        return f"{with_all:,}, equal"
    return f"{with_all:,} -> {without:,} ({without / with_all - 1.0:+.4%})"


def _time(pairs: Sequence[Sequence[float]]) -> str:
    if len(pairs) < 2:
        return NOT_MEASURED
    middle, low, high = interval([without / with_all for with_all, without in pairs])
    return f"{middle:.4f} [{low:.4f}, {high:.4f}], {len(pairs)} pairs"


def interval(values: Sequence[float]) -> tuple[float, float, float]:
    """The median, and its confidence interval by the bootstrap's percentiles (B. Efron, 1979); the same at every call."""
    pick = random.Random(1)
    medians = sorted(median(pick.choices(values, k=len(values))) for _ in range(RESAMPLES))
    tail = math.floor(0.5 * (1.0 - CONFIDENCE) * RESAMPLES)
    return median(values), medians[tail], medians[-1 - tail]


def unequal(rows: Mapping[str, Row]) -> Iterator[str]:
    """What an effect that is off costs after all, or that nothing does."""
    omitted = {effect: row["omitted"] for effect, row in rows.items() if "omitted" in row}
    if not omitted:
        return
    bits = [effect for effect, row in omitted.items() if not bits_equal(row)]
    costs = {effect: _extra(row) for effect, row in omitted.items() if _extra(row) != 0.0}
    yield ""
    yield f"Of {len(omitted)} builds, {len(omitted) - len(bits)} drew the same bits" + (
        f"; not those without {', '.join(bits)}." if bits else "."
    )
    if costs:
        yield "Instructions that the base scene spends on what it does not use, in the mean of both sets:"
        yield from (f"- {effect}: {share:+.4%}" for effect, share in costs.items())
    else:
        yield "All counted the same instructions."


def _extra(row: Row) -> float:
    return fmean(with_all / without - 1.0 for with_all, without in row["count"].values())
