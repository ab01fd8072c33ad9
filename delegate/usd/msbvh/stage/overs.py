"""Prims that nobody defines: mere overs, which keeps them and all below them out of the picture."""

from __future__ import annotations

from pxr import Sdf, Usd

from ..base.errors import Diagnostics


def report_overs(stage: Usd.Stage, diagnostics: Diagnostics) -> None:
    """Names the outermost ones, for a stage that shows nothing."""
    prims = iter(Usd.PrimRange.Stage(stage, Usd.PrimAllPrimsPredicate))
    for prim in prims:
        if prim.GetSpecifier() == Sdf.SpecifierOver and not prim.IsInstanceProxy():
            prims.PruneChildren()
            message = "found an over, expected a def: a prim that nothing defines is not drawn, nor what is below it"
            diagnostics.group(str(prim.GetPath()), "", message)
