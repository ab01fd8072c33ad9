"""`msbvh verify` for people."""

from __future__ import annotations

from .checks import Probe, Verdict

HEADER = ("probe", "instruction set", "rays", "judged", "wrong")


def verdict_text(verdict: Verdict) -> str:
    """A headline, an aligned table of the probes, and a line for each defect."""
    invariants = "broken" if verdict.broken_invariant else "hold"
    closed = f"{verdict.closed_meshes:,} of {verdict.meshes:,} meshes are closed"
    lines = [f"{verdict.scene}: the invariants of all trees {invariants}; {closed}"]
    rows = [_cells(probe) for probe in verdict.probes]
    widths = [max(map(len, column)) for column in zip(HEADER, *rows, strict=True)]
    lines.extend(_line(row, widths) for row in (HEADER, *rows))
    if verdict.broken_invariant:
        lines.append(f"broken: {verdict.broken_invariant}")
    lines.extend(
        f"wrong, {probe.probe}, {probe.instruction_set}: {probe.first}" for probe in verdict.probes if probe.wrong
    )
    return "\n".join(lines)


def summary_text(verdicts: list[Verdict]) -> str:
    """What all of it says."""
    rays = sum(probe.rays for verdict in verdicts for probe in verdict.probes)
    judged = sum(probe.judged for verdict in verdicts for probe in verdict.probes)
    wrong = sum(probe.wrong for verdict in verdicts for probe in verdict.probes)
    return f"{rays:,} rays, {judged:,} of them judged by the oracle: {wrong:,} wrong"


def _cells(probe: Probe) -> tuple[str, ...]:
    return probe.probe, probe.instruction_set, f"{probe.rays:,}", f"{probe.judged:,}", f"{probe.wrong:,}"


def _line(cells: tuple[str, ...], widths: list[int]) -> str:
    text, numbers = cells[:2], cells[2:]
    left = [f"{cell:{width}}" for cell, width in zip(text, widths[:2], strict=True)]
    right = [f"{cell:>{width}}" for cell, width in zip(numbers, widths[2:], strict=True)]
    return "  " + "  ".join([*left, *right])
