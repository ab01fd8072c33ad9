"""What each effect took of a render, by what its threads were found at."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Literal, TypedDict

from .. import _core
from .ray_shares import by_geometry


class MeasuredEffect(TypedDict):
    """Of an effect that is on."""

    time_share: float | None
    """Of the threads' time in the frame's stages, in [0, 1]. None: it cannot be told apart, as with lights that move, or
    nothing was sampled."""
    by: Literal["stage", "at most", "model"]
    """stage: threads were found at work that nothing else asks for. at most: at work that the effect is a part of. model: the
    time in which rays went through the trees was measured, and split among prims by what a sample of them met
    (core/cost/ray_costs.h)."""
    tree_share: float | None
    """Of the trees' bytes, split among prims by their leaf entries. None: it has no geometry, or no costs are known."""


_OWN_STAGES: dict[str, Callable[[_core.StageSamples], bool]] = {
    "opacity": lambda row: row["stage"] == "opacity",
    "AOVs": lambda row: row["stage"] == "AOVs",
    "area lights": lambda row: row["stage"] == "area lights",
    "dome light": lambda row: row["stage"] == "dome light",
    "indirect light": lambda row: row["bounced"],
}
"""Effects with work of their own. Of opacity the part of shadow rays is left out, of area lights the sampling of those that
are not met by chance: both are in "direct"."""
_PART_OF_STAGES: dict[str, Callable[[_core.StageSamples], bool]] = {
    "image dome": lambda row: row["stage"] in ("direct", "area lights"),
    "light controls": lambda row: row["stage"] in ("direct", "area lights"),
    "lens": lambda row: row["stage"] == "generate",
    "camera motion": lambda row: row["stage"] == "generate",
    "specular": lambda row: row["stage"] == "looks",
    "textures": lambda row: row["stage"] == "looks",
    "refraction": lambda row: row["stage"] in ("looks", "scatter"),
    "fibre": lambda row: row["stage"] in ("looks", "scatter"),
}
"""Effects that are a part of such work."""


def measured_effects(
    found: _core.FoundEffects, stages: Sequence[_core.StageSamples], costs: _core.RayCosts | None = None
) -> dict[str, MeasuredEffect]:
    """Of the effects that are on; empty where nothing was sampled. An effect's work may be another's too (a bounce that sees
    the dome), so that shares may add up to more than 1."""
    all_samples = sum(row["samples"] for row in stages)
    if not all_samples:
        return {}

    def share(is_its: Callable[[_core.StageSamples], bool]) -> float:
        return sum(row["samples"] for row in stages if is_its(row)) / all_samples

    tracing = share(lambda row: row["tracing"])
    rays = by_geometry(found, costs, "share") if costs else {}
    held = by_geometry(found, costs, "tree_bytes") if costs else {}
    all_bytes = sum(row["tree_bytes"] for row in costs["prims"]) if costs else 0.0
    result: dict[str, MeasuredEffect] = {}
    for row in found["effects"]:
        effect = row["effect"]
        if not row["asked_by"]:
            continue
        measured = MeasuredEffect(time_share=None, by="model", tree_share=None)
        if effect in _OWN_STAGES:
            measured["time_share"], measured["by"] = share(_OWN_STAGES[effect]), "stage"
        elif effect in _PART_OF_STAGES:
            measured["time_share"], measured["by"] = share(_PART_OF_STAGES[effect]), "at most"
        elif effect in rays:
            measured["time_share"] = tracing * rays[effect]
        if effect in held and all_bytes:
            measured["tree_share"] = held[effect] / all_bytes
        result[effect] = measured
    return result
