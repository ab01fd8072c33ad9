"""A stand-in for a prim whose values convert to the types that USD's own computations take: with others they go on
without a word, as if nothing were authored."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from pxr import Usd

from .stage_metadata import time_codes_per_second
from .value_types import FLOAT3S, INTS, QUATERNIONS
from .values import raw, targets, value

_KINDS = {
    "points": FLOAT3S,
    "positions": FLOAT3S,
    "scales": FLOAT3S,
    "velocities": FLOAT3S,
    "accelerations": FLOAT3S,
    "angularVelocities": FLOAT3S,
    "orientations": QUATERNIONS,
    "orientationsf": QUATERNIONS,
    "protoIndices": INTS,
}


@dataclass(frozen=True)
class Twin:
    """A prim, and the stage that it lives on."""

    prim: Usd.Prim
    stage: Usd.Stage


def typed_twin(prim: Usd.Prim, code: Usd.TimeCode) -> Twin:
    """The prim itself where the arrays that move it are of its schema's types, else a prim of that type on a stage of
    its own with these arrays converted."""
    authored = [(name, prim.GetAttribute(name)) for name in _KINDS if prim.HasAttribute(name)]
    authored = [(name, attribute) for name, attribute in authored if attribute.HasAuthoredValue()]
    if all(_is_exact(attribute, code) for _, attribute in authored):
        return Twin(prim, prim.GetStage())
    source, stage = prim.GetStage(), Usd.Stage.CreateInMemory()
    stage.SetTimeCodesPerSecond(time_codes_per_second(source))
    stage.SetInterpolationType(source.GetInterpolationType())
    twin = stage.DefinePrim("/twin", prim.GetTypeName())
    for name, attribute in authored:
        copy = twin.GetAttribute(name)
        for time in attribute.GetTimeSamples() or [Usd.TimeCode.Default()]:
            found = value(attribute, time, _KINDS[name])
            if found is not None:
                copy.Set(_as_schema(found, copy), time)
    if prim.HasRelationship("prototypes"):
        count = len(targets(prim, "prototypes"))
        twin.GetRelationship("prototypes").SetTargets([f"/twin/p{i}" for i in range(count)])
    return Twin(twin, stage)


def _is_exact(attribute: Usd.Attribute, code: Usd.TimeCode) -> bool:
    found = raw(attribute, code)
    return found is None or type(found) is type(attribute.GetTypeName().defaultValue)


def _as_schema(found: object, copy: Usd.Attribute) -> object:
    """Quaternions are stored in half precision by some attributes."""
    exact = type(copy.GetTypeName().defaultValue)
    return found if type(found) is exact else exact.FromNumpy(np.asarray(found).astype(np.asarray(exact(1)).dtype))
