"""Curves and points as the translator takes them: their topology and their widths; all else is as with meshes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, cast

import numpy as np
from pxr import Usd, UsdGeom

from .._core import MeshInput
from ..motion.context import FrameContext, array
from ..motion.points import Samples, changes, rate_times, sample_points
from ..stage.value_types import INTS, TOKEN
from ..stage.values import required, value
from .part import Part
from .primvars import FoundPrimvar, find_primvar, sample_primvar


def is_round(prim: Usd.Prim) -> bool:
    """Whether a prim is drawn as curves or as points."""
    return prim.IsA(UsdGeom.BasisCurves) or prim.IsA(UsdGeom.Points)


def read_round(target: MeshInput, prim: Usd.Prim, context: FrameContext, part: Part) -> Samples:
    """Fills in the target. Returns the points.

    `context` has the prim's own shutter. Nothing is checked here that the translator checks.
    """
    shape = UsdGeom.PointBased(prim)
    samples, carried_by = sample_points(shape, context, "velocities" in part.authored)
    if prim.IsA(UsdGeom.BasisCurves):
        _read_topology(target, UsdGeom.BasisCurves(prim), context, part.authored)
    else:
        target.round = "points"
    target.widths = _read_widths(prim, context, part.authored)
    found: dict[str, Any] = {**carried_by, **rate_times(context, part.scales.velocity)}
    for name, given in found.items():
        setattr(target, name, given)
    return samples


def _read_topology(
    target: MeshInput, curves: UsdGeom.BasisCurves, context: FrameContext, authored: frozenset[str]
) -> None:
    code = context.code
    target.round = "curves"
    target.curve_type = value(curves.GetTypeAttr(), code, TOKEN)
    target.curve_basis = value(curves.GetBasisAttr(), code, TOKEN)
    target.curve_wrap = value(curves.GetWrapAttr(), code, TOKEN)
    counts = curves.GetCurveVertexCountsAttr()
    target.curve_vertex_counts = array(required(counts, code, INTS), np.int32)
    target.topology_varies = changes(counts, context)
    target.has_normals = not authored.isdisjoint(("normals", "primvars:normals"))


@dataclass(frozen=True)
class _PlainWidths:
    """The attribute `widths` as a primvar."""

    prim: Usd.Prim

    def GetInterpolation(self) -> str:
        if self.prim.IsA(UsdGeom.Points):
            return str(UsdGeom.Points(self.prim).GetWidthsInterpolation())
        return str(UsdGeom.Curves(self.prim).GetWidthsInterpolation())

    def GetName(self) -> str:
        return "widths"


def _read_widths(prim: Usd.Prim, context: FrameContext, authored: frozenset[str]) -> Any:
    """primvars:widths before widths, as UsdGeomPointBased says of normals."""
    if "primvars:widths" in authored:
        found = find_primvar(prim, "widths", None, authored)
        return sample_primvar(found, context) if found else None
    if "widths" not in authored:
        return None
    attribute = prim.GetAttribute("widths")
    plain = cast(UsdGeom.Primvar, _PlainWidths(prim))
    return sample_primvar(FoundPrimvar(prim, plain, None, attribute, False), context)
