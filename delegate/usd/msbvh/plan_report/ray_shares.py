"""How much of the rays' work each effect's geometry takes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

from .. import _core

OF_GEOMETRY = (
    "deforming keys",
    "polynomial motion",
    "time remaps",
    "opacity",
    "curves",
    "points",
    "displacement",
    "subdivision",
)
"""Effects that prims ask for whose geometry rays meet."""
INSTANCES = "instances"
"""Asked for by what instances; rays meet what is instanced. Which of them moves is not told apart."""


def ray_shares(found: _core.FoundEffects, costs: _core.RayCosts) -> Mapping[str, float]:
    """Of effects that are on, in [0, 1], by the sampled rays' costs (core/cost/ray_costs.h). A prim may ask for several effects,
    so that shares may add up to more than 1. Other effects, such as a lens, have no geometry, and no share that can be told
    apart."""
    return by_geometry(found, costs, "share")


def by_geometry(
    found: _core.FoundEffects, costs: _core.RayCosts, quantity: Literal["share", "tree_bytes"]
) -> dict[str, float]:
    """What the prims that ask for each effect have of a quantity."""
    shares = {row["path"]: row[quantity] for row in costs["prims"]}
    instanced = sum(row[quantity] for row in costs["prims"] if row["instances"] > 0.0)
    result = {}
    for row in found["effects"]:
        if not row["asked_by"]:
            continue
        if row["effect"] == INSTANCES:
            result[row["effect"]] = instanced
        elif row["effect"] in OF_GEOMETRY:
            result[row["effect"]] = sum(shares.get(path, 0.0) for path in {path for path, _ in row["asked_by"]})
    return result
