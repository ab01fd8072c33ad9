"""The section of docs/performance.md on whole frames: of the report of `msbvh bench --frames --json`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product
from typing import Any

Row = dict[str, Any]

HEAD = """## Whole frames

Made by `{command}`{commit}: {processor}, {cores} cores;
{sides}. {width} x {height} pixels, {spp} samples, {bounces} bounces of indirect light, box filter, one sun,
surfaces of {looks}; seed {seed}; load average {load_average:.1f} before the run, which took {minutes:.0f} minutes.
{dirty}
Each frame is a process of its own, on as many processors as it has threads; the sides take turns. Figures are medians of
{repetitions} rounds. *read*: from the file to the renderer's scene, evaluated over the shutter. *build*: trees, and whatever
else comes before the first ray. *trace*: pixels. *process*: from the start of the process to its end, with *start* (the
interpreter and its libraries) and the picture's file. *CPU*: seconds that its threads ran, which other work on the machine
changes least. *MB*: the most that the process held at once. {errors}
A side's ratio is its figure over ours, from frames that stand side by side, with the lowest and the highest of the rounds
in brackets: above 1 we are better. {likeness}
"""

ERRORS = """*MSE*: the
mean over pixels and channels of (x - r)^2 / (r^2 + 0.01), where r is the same renderer's picture at {reference_spp} samples,
whose own noise is known from its halves and taken away (it is at most {share:.0%} of an error here).
"""

NO_ERRORS = "No noise was measured."

LIKENESS = """Sides are compared only where
their converged pictures are alike: means of channels within 1 %, and means of 8 x 8 pixels within 2 % (relative, root mean
square, without noise). *void* marks what is not.
"""

CYCLES = """
Cycles reads the same USD file by Blender's importer, in its best mode for it: as many motion steps as each scene needs
and no more, spatial splits, no tiles, no denoiser, no adaptive sampling. Its surfaces are equal ones, flat as USD has them:
displayColor is a Diffuse BSDF, metal a Glossy BSDF with multiple scattering, textured a Principled BSDF. Its sun is as bright
as ours (the importer makes it 4 times as bright); over metal and textured there is a plain sky too.
"""

DIRTY = """**Made from a tree with uncommitted changes**: the commit above does not reproduce it.
"""

COLUMNS = ("scene", "side", "read s", "build s", "trace s", "process s", "start s", "CPU s", "MB", "MSE")
RATIOS = ("trace", "process", "CPU", "trace x MSE", "process x MSE")
RATIO_KEYS = ("trace_ratio", "process_ratio", "cpu_ratio", "trace_mse_ratio", "process_mse_ratio")


USUAL = "displayColor"
"""The look that is not named."""
OWN = ("scenes", "looks", "seconds", "load_average")
"""What reports of one page may differ in."""


def joined(reports: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """One report of several that were made alike. Raises ValueError where they were not."""
    first, *others = (report["machine"] for report in reports)
    for other in others:
        unlike = [key for key in first if key not in OWN and first[key] != other[key]]
        if unlike:
            raise ValueError(
                f"{unlike[0]}: found {first[unlike[0]]} and {other[unlike[0]]}; expected reports made alike"
            )
    machine = {
        **first,
        **{key: _every(reports, key) for key in ("scenes", "looks")},
        "seconds": sum(report["machine"]["seconds"] for report in reports),
        "load_average": max(report["machine"]["load_average"] for report in reports),
    }
    return {"machine": machine, "rows": [row for report in reports for row in report["rows"]]}


def _every(reports: Sequence[dict[str, Any]], key: str) -> list[str]:
    """Each once."""
    return list(dict.fromkeys(name for report in reports for name in report["machine"][key]))


def section(report: dict[str, Any]) -> Iterator[str]:
    """The lines of the section: a table for each number of threads."""
    machine, rows = report["machine"], report["rows"]
    yield head(machine, rows)
    for threads in machine["threads"]:
        yield f"### {threads} thread{'s' if threads > 1 else ''}\n"
        yield f"| {' | '.join((*COLUMNS, *(f'**{name}** / ours' for name in RATIOS)))} |"
        yield "|---" * (len(COLUMNS) + len(RATIOS)) + "|"
        for row in rows:
            if row["threads"] == threads:
                yield f"| {' | '.join(cells(row))} |"
        yield ""
    yield from means(machine, rows)
    yield from likeness_table(rows)


def head(machine: dict[str, Any], rows: Sequence[Row]) -> str:
    commit = machine["commit"]
    shares = [row["reference_share"] for row in rows if row["reference_share"] is not None]
    alike = any(row["comparable"] is not None for row in rows)
    text = HEAD.format(
        **{
            **machine,
            "command": command_of(machine),
            "commit": f" ({commit})" if commit else "",
            "sides": "; ".join(f"{name}: {software}" for name, software in machine["sides"].items()),
            "width": machine["resolution"][0],
            "height": machine["resolution"][1],
            "bounces": machine["max_bounces"],
            "minutes": machine["seconds"] / 60,
            "looks": ", ".join(machine["looks"]),
            "dirty": DIRTY if commit is None or commit.endswith("-dirty") else "",
            "errors": ERRORS.format(**machine, share=max(shares)) if shares else NO_ERRORS,
            "likeness": LIKENESS if alike else "",
        }
    )
    return text + (CYCLES if "cycles" in machine["sides"] else "")


def command_of(machine: dict[str, Any]) -> str:
    """The command line that made the report; the folder of a peer and the place of an old build are the machine's own."""
    words = ["msbvh bench --frames"]
    words += ["--old COMMAND"] if "old" in machine["sides"] else []
    words += ["--peer cycles"] if "cycles" in machine["sides"] else []
    words += ["--quick"] if machine["quick"] else []
    words += [f"--scenes {','.join(machine['scenes'])}"] if machine["scenes"] != ["*"] else []
    words += [f"--looks {','.join(machine['looks'])}"] if machine["looks"] != [USUAL] else []
    words += [f"--threads {','.join(map(str, machine['threads']))}"]
    words += [f"--resolution {' '.join(map(str, machine['resolution']))} --spp {machine['spp']}"]
    words += [f"--reference-spp {machine['reference_spp']}"]
    words += [f"--max-bounces {machine['max_bounces']}"] if machine["max_bounces"] != 2 else []
    words += [f"--seed {machine['seed']}"] if machine["seed"] != 1 else []
    words += [f"--repetitions {machine['repetitions']}"]
    return " ".join(words)


def cells(row: Row) -> list[str]:
    seconds = [f"{row[key]:.2f}" for key in ("read_s", "build_s", "trace_s", "process_s", "start_s", "cpu_s")]
    error = "-" if row["relative_mse"] is None else f"{row['relative_mse']:.2e}"
    memory = f"{row['memory_bytes'] / (1 << 20):.0f}"
    return [_title(row), row["side"], *seconds, memory, error, *(ratio(row, key) for key in RATIO_KEYS)]


def _title(row: Row) -> str:
    return str(row["scene"]) if row["look"] == USUAL else f"{row['scene']}, {row['look']}"


def ratio(row: Row, key: str) -> str:
    if row["comparable"] is False:
        return "*void*"
    if row[key] is None:
        return "-"
    return f"**{row[key]:.2f}** [{row[f'{key}_low']:.2f}, {row[f'{key}_high']:.2f}]"


def means(machine: dict[str, Any], rows: Sequence[Row]) -> Iterator[str]:
    """Of the scenes' ratios, for each side, look and number of threads: geometric, as means of ratios must be."""
    for side, look, threads in product(list(machine["sides"])[1:], machine["looks"], machine["threads"]):
        chosen = [row for row in rows if (row["side"], row["look"], row["threads"]) == (side, look, threads)]
        said = [
            f"{name} {mean}" for name, key in zip(RATIOS, RATIO_KEYS, strict=True) if (mean := geometric(chosen, key))
        ]
        if said:
            count = f"{threads} thread{'s' if threads > 1 else ''}"
            yield f"- {side} over ours, geometric mean of {len(chosen)} scenes, {look}, {count}: {', '.join(said)}"
    yield ""


def geometric(rows: Sequence[Row], key: str) -> str:
    """Empty where a scene has no ratio: a mean of the others would flatter."""
    whole = 1.0
    for row in rows:
        if row[key] is None:
            return ""
        whole *= row[key]
    return f"{whole ** (1 / len(rows)):.2f}" if rows else ""


def likeness_table(rows: Sequence[Row]) -> Iterator[str]:
    """How the converged pictures differ from ours."""
    found = [row for row in rows if row["comparable"] is not None and row["threads"] == rows[0]["threads"]]
    if not found:
        return
    yield "### Whether the sides draw the same\n"
    yield "| scene | what moves | side | means differ | squares of 8 x 8 pixels differ | |"
    yield "|---|---|---|---|---|---|"
    for row in found:
        verdict = "alike" if row["comparable"] else "**void**"
        difference = f"{row['mean_difference']:.2%} | {row['shape_difference']:.2%}"
        yield f"| {_title(row)} | {row['says']} | {row['side']} | {difference} | {verdict} |"
    yield ""
