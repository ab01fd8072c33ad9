"""Tokens that prims inherit, computed from values that come through the gate: USD's own computations pass over
values of another type without a word."""

from __future__ import annotations

from collections.abc import Iterator

from pxr import Usd, UsdGeom

from .value_types import BOOL, TOKEN
from .values import value


def inherited_purpose(prim: Usd.Prim) -> str:
    """UsdGeom.Imageable.ComputePurpose(): the nearest that is authored at or above, among imageable prims."""
    for each in _at_and_above(prim):
        if not each.IsA(UsdGeom.Imageable):
            break
        found = _authored(each, "purpose")
        if found:
            return found
    return str(UsdGeom.Tokens.default_)


def draw_mode(prim: Usd.Prim) -> str:
    """UsdGeom.ModelAPI.ComputeModelDrawMode(): the nearest that is authored and says something."""
    for each in _at_and_above(prim):
        if not each.IsModel():
            break
        found = _authored(each, "model:drawMode")
        if found and found != UsdGeom.Tokens.inherited:
            return found
    return str(UsdGeom.Tokens.default_)


def applied_draw_mode(prim: Usd.Prim) -> str:
    """What takes the place of a prim and all below it: origin, bounds or cards; default where it is drawn in full.

    Draw modes apply to models: to components, to others by model:applyDrawMode (UsdGeomModelAPI).
    """
    default = str(UsdGeom.Tokens.default_)
    if not prim.IsModel() or prim.IsPseudoRoot():
        return default
    if prim.IsComponent():
        return draw_mode(prim)
    applied = prim.GetAttribute("model:applyDrawMode")
    return draw_mode(prim) if applied and value(applied, Usd.TimeCode.Default(), BOOL) else default


def _at_and_above(prim: Usd.Prim) -> Iterator[Usd.Prim]:
    while prim and not prim.IsPseudoRoot():
        yield prim
        prim = prim.GetParent()


def _authored(prim: Usd.Prim, name: str) -> str | None:
    attribute = prim.GetAttribute(name)
    if not attribute or not attribute.HasAuthoredValue():
        return None
    return value(attribute, Usd.TimeCode.Default(), TOKEN)
