"""Prims that usdrecord may draw and we don't: never without a word."""

from __future__ import annotations

from pxr import Usd, UsdGeom, UsdSkel

from ..look.lights import is_light

_DRAW_NOTHING = (UsdSkel.Root, UsdSkel.Skeleton)
"""Boundable types that only place or move others."""


def why_not_drawn(prim: Usd.Prim) -> str | None:
    """The message about a prim that is neither a shape nor instances; None where there is nothing to draw.

    Whatever has an extent may be drawn by somebody: gprims, volumes and particle fields among them, and procedurals.
    The fields of a volume have none; they are drawn by the volume, or by nobody.
    """
    name = prim.GetTypeName()
    if not name:
        return None
    if not prim.GetPrimTypeInfo().GetSchemaType():
        return f"prim type '{name}' is unknown; not drawn"
    if not prim.IsA(UsdGeom.Boundable) or is_light(prim) or any(prim.IsA(kind) for kind in _DRAW_NOTHING):
        return None
    return f"prims of type {name} are not supported yet; not drawn"
