"""`msbvh plan` for people."""

from __future__ import annotations

from ..scene.coarser_tracks import CoarserTracks
from .measured import MeasuredEffect
from .report import MOST_PRIMS, EffectRow, PlanReport


def plan_text(report: PlanReport) -> str:
    """A line for each effect that is on, with those who ask for it; then the effects that are off, the geometry, the prims that
    are left out, and those with coarser tracks."""
    lines = [_line(row) for row in report.effects if row.on]
    off = [row.effect for row in report.effects if not row.on]
    if off:
        lines.append(f"{'off':20} {', '.join(off)}")
    base = report.base_bytes / report.geometry_bytes if report.geometry_bytes else 0.0
    lines.append(f"{'geometry':20} {report.geometry_bytes:,} bytes, {base:.1%} of them of no effect")
    if report.samples:
        lines.append(
            f'{"measured":20} by {report.samples:,} looks at what threads did; "about": traversal, split by a model'
        )
    lines += [_left_out(report, why) for why in dict.fromkeys(prim["why"] for prim in report.left_out)]
    if report.coarser_tracks.prims:
        lines.append(_coarser(report.coarser_tracks))
    return "\n".join(lines)


def _coarser(found: CoarserTracks) -> str:
    named = ", ".join(found.prims[:MOST_PRIMS])
    more = f", {len(found.prims) - MOST_PRIMS:,} more" if len(found.prims) > MOST_PRIMS else ""
    saved = f"{found.keys_saved:,} {'key' if found.keys_saved == 1 else 'keys'} fewer"
    return f"{'coarser tracks':20} {len(found.prims):,} outside of the picture throughout the shutter, {saved}: {named}{more}"


def _left_out(report: PlanReport, why: str) -> str:
    prims = [prim for prim in report.left_out if prim["why"] == why]
    named = ", ".join(prim["path"] for prim in prims[:MOST_PRIMS])
    more = f", {len(prims) - MOST_PRIMS:,} more" if len(prims) > MOST_PRIMS else ""
    return f"{'left out':20} {len(prims):,} that no ray can reach, {why} throughout the shutter: {named}{more}"


def _line(row: EffectRow) -> str:
    first = f"{row.prims[0]}: {row.why}" if row.prims else row.why
    more = row.prim_count - len(row.prims)
    also = ", ".join([*row.prims[1:], *([f"{more:,} more"] if more else [])])
    shares = [f"{row.geometry_share:.1%} of the geometry"] if row.geometry_bytes else []
    shares += [] if row.ray_share is None else [f"about {row.ray_share:.0%} of the rays' work"]
    if row.predicted and row.predicted["time_share"] is not None:
        bound = "at most" if row.predicted["by"] == "at most" else "about"
        shares.append(f"predicted to take {bound} {row.predicted['time_share']:.0%} of the render")
    shares += _measured(row.measured) if row.measured else []
    held = f" [{', '.join(shares)}]" if shares else ""
    return f"{row.effect:20} {first}{f'; also {also}' if also else ''}{held}"


def _measured(found: MeasuredEffect) -> list[str]:
    parts = []
    if found["time_share"] is not None:
        word = {"stage": "", "at most": "at most ", "model": "about "}[found["by"]]
        parts.append(f"took {word}{found['time_share']:.1%} of the render")
    if found["tree_share"] is not None:
        parts.append(f"holds about {found['tree_share']:.1%} of the trees")
    return parts
