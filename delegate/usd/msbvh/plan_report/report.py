"""Each effect, on or off, who asks for it, and the geometry that it holds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from .. import _core
from ..scene.coarser_tracks import CoarserTracks
from .measured import MeasuredEffect, measured_effects
from .pilot import Traced
from .ray_shares import ray_shares


@dataclass(frozen=True)
class EffectRow:
    """One effect of a scene."""

    effect: str
    on: bool
    prims: list[str]
    """The first MOST_PRIMS that ask for it, in the scene's order; none where a setting does."""
    prim_count: int
    """Of all that ask."""
    why: str
    """Of the first; empty where the effect is off."""
    geometry_bytes: int
    """Of positions, indices and transforms: core/plan/effect_bytes.h says which are an effect's. Counted before
    trees are built. What nothing shows is held as well, so an effect that is off may hold some."""
    geometry_share: float
    """Of all the scene's geometry, in [0, 1]; these and the base's add up to 1."""
    ray_share: float | None
    """Of the rays' work, in [0, 1], predicted by a few rays: ray_shares(). None: no rays were traced, or the effect has no
    geometry of its own."""
    predicted: MeasuredEffect | None
    """What it took of a small render ahead of the frame's. None: no rays were traced, or the effect is off."""
    measured: MeasuredEffect | None
    """What it took of a render. None: nothing was rendered, or the effect is off."""


@dataclass(frozen=True)
class PlanReport:
    """All effects of a scene, in the order of core/plan/effect_plan.h."""

    effects: list[EffectRow]
    base_bytes: int
    """Of geometry that no effect brings: still triangles."""
    geometry_bytes: int
    """Of the base and all effects."""
    samples: int
    """Of what the render's threads were found at; 0: nothing was rendered."""
    left_out: list[_core.LeftOut]
    """Prims that are not in the scene, because no ray can reach them."""
    coarser_tracks: CoarserTracks
    """Of what moves outside of the picture."""


MOST_PRIMS = 3
NO_TRACKS = CoarserTracks([], 0, 0)


def plan_report(
    scene: _core.Scene,
    frame_rays: Traced | None = None,
    *,
    max_bounces: int = 2,
    refraction: bool = False,
    left_out: Sequence[_core.LeftOut] = (),
    coarser: CoarserTracks = NO_TRACKS,
) -> PlanReport:
    """`frame_rays`: None, nothing was traced; `left_out`, `coarser`: what reading the scene left out, and what it gave fewer
    keys. Raises _core.Error for a scene that is wrong."""
    frame_rays = frame_rays or Traced()
    found = _core.effects(scene, max_bounces=max_bounces, refraction=refraction)
    shares = ray_shares(found, frame_rays.costs) if frame_rays.costs else {}
    predicted = measured_effects(found, frame_rays.pilot, frame_rays.costs)
    measured = measured_effects(found, frame_rays.stages, frame_rays.costs)
    total = found["base_bytes"] + sum(row["geometry_bytes"] for row in found["effects"])
    rows = [
        _row(row, total, shares.get(row["effect"]), predicted.get(row["effect"]), measured.get(row["effect"]))
        for row in found["effects"]
    ]
    looks = sum(row["samples"] for row in frame_rays.stages)
    return PlanReport(rows, found["base_bytes"], total, looks, list(left_out), coarser)


def _row(
    found: _core.FoundEffect,
    total: int,
    ray_share: float | None,
    predicted: MeasuredEffect | None,
    measured: MeasuredEffect | None,
) -> EffectRow:
    asked_by = found["asked_by"]
    prims = [prim for prim, _ in asked_by if prim]
    return EffectRow(
        effect=found["effect"],
        on=bool(asked_by),
        prims=prims[:MOST_PRIMS],
        prim_count=len(prims),
        why=asked_by[0][1] if asked_by else "",
        geometry_bytes=found["geometry_bytes"],
        geometry_share=found["geometry_bytes"] / total if total else 0.0,
        ray_share=ray_share,
        predicted=predicted,
        measured=measured,
    )


def plain(report: PlanReport) -> dict[str, Any]:
    """For JSON."""
    found = report.coarser_tracks
    coarser = {**vars(found), "prims": found.prims[:MOST_PRIMS], "prim_count": len(found.prims)}
    return {**vars(report), "effects": [vars(row) for row in report.effects], "coarser_tracks": coarser}


def first_reasons(report: PlanReport) -> list[dict[str, str]]:
    """Effects that are on, with the first who asks: as `plan` in --stats."""
    return [
        {"effect": row.effect, "prim": row.prims[0] if row.prims else "", "why": row.why}
        for row in report.effects
        if row.on
    ]
