"""Curves and points as the translator takes them: their topology and their widths; all else is as with meshes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, cast

import numpy as np
from pxr import Usd, UsdGeom

from .._core import MeshInput
from ..motion.context import FrameContext, array
from ..motion.held_values import warn_of_change
from ..motion.points import Samples, changes, rate_times, sample_points
from ..motion.times import sample_times
from ..stage.value_types import DOUBLE2S, DOUBLES, FLOAT3S, INTS, TOKEN, Kind
from ..stage.values import Unreadable, required, value
from .normals import add_normals
from .part import Part
from .primvars import FoundPrimvar, find_primvar, sample_primvar

CURVES = (UsdGeom.BasisCurves, UsdGeom.HermiteCurves, UsdGeom.NurbsCurves)

DEFAULT_WIDTH = 1.0
"""Where none is authored, as the translator has it."""


def is_round(prim: Usd.Prim) -> bool:
    """Whether a prim is drawn as curves or as points."""
    return prim.IsA(UsdGeom.Points) or any(prim.IsA(kind) for kind in CURVES)


def read_round(target: MeshInput, prim: Usd.Prim, context: FrameContext, part: Part) -> Samples:
    """Fills in the target. Returns the points.

    `context` has the prim's own shutter. Nothing is checked here that the translator checks. Raises Unreadable.
    """
    shape = UsdGeom.PointBased(prim)
    samples, carried_by = sample_points(shape, context, "velocities" in part.authored)
    if prim.IsA(UsdGeom.Points):
        target.round = "points"
    else:
        _read_curves(target, UsdGeom.Curves(prim), context, part.authored)
    if prim.IsA(UsdGeom.HermiteCurves):
        samples = _with_tips(samples, shape, bool(carried_by), context)
        carried_by = {
            name: [(time01, np.tile(each, (2, 1))) for time01, each in carried_by[name]] for name in carried_by
        }
    target.widths = _read_widths(prim, context, part.authored)
    found: dict[str, Any] = {**carried_by, **rate_times(context, part.scales.velocity)}
    for name, given in found.items():
        setattr(target, name, given)
    return samples


def reach_of(target: MeshInput) -> float:
    """How far curves or points reach beyond their points: half of the largest width."""
    if target.widths is None:
        return 0.5 * DEFAULT_WIDTH
    _, values, _ = target.widths
    every = np.concatenate([each for _, each in values]) if isinstance(values, list) else values
    sound = every[np.isfinite(every)]
    return 0.5 * float(sound.max(initial=0.0))


def _read_curves(target: MeshInput, curves: UsdGeom.Curves, context: FrameContext, authored: frozenset[str]) -> None:
    prim, code = curves.GetPrim(), context.code
    target.round = "curves"
    counts = curves.GetCurveVertexCountsAttr()
    target.curve_vertex_counts = array(required(counts, code, INTS), np.int32)
    target.topology_varies = changes(counts, context)
    add_normals(target, curves, context, authored)
    if prim.IsA(UsdGeom.HermiteCurves):
        target.curve_type = "hermite"
    elif prim.IsA(UsdGeom.NurbsCurves):
        target.curve_type = "nurbs"
        _read_splines(target, prim, context, authored)
    else:
        basis = UsdGeom.BasisCurves(prim)
        target.curve_type = value(basis.GetTypeAttr(), code, TOKEN)
        target.curve_basis = value(basis.GetBasisAttr(), code, TOKEN)
        target.curve_wrap = value(basis.GetWrapAttr(), code, TOKEN)


def _read_splines(target: MeshInput, prim: Usd.Prim, context: FrameContext, authored: frozenset[str]) -> None:
    """What makes B-splines of control points, as it is at the frame."""

    def at_frame(name: str, kind: Kind) -> Any:
        attribute = prim.GetAttribute(name)
        warn_of_change(attribute, ", as the topology", context.shutter, context.diagnostics)
        return required(attribute, context.code, kind)

    target.curve_orders = array(at_frame("order", INTS), np.int32)
    target.curve_knots = array(at_frame("knots", DOUBLES), np.float64)
    if "ranges" in authored:
        target.curve_ranges = array(at_frame("ranges", DOUBLE2S), np.float64, 2).ravel()
    if "pointWeights" in authored:
        target.curve_weights = array(at_frame("pointWeights", DOUBLES), np.float64)


def _with_tips(samples: Samples, shape: UsdGeom.PointBased, carried: bool, context: FrameContext) -> Samples:
    """The points of Hermite curves, and as many tips of their tangents: a transform places both alike. Raises
    Unreadable where the numbers differ."""
    shutter, points = context.shutter, shape.GetPointsAttr()
    tangents = UsdGeom.HermiteCurves(shape.GetPrim()).GetTangentsAttr()
    times = [] if carried else sample_times([points, tangents], shutter)
    poses: list[tuple[float | None, np.ndarray, Usd.TimeCode]]
    if times:
        codes = [Usd.TimeCode(time) for time in times]
        poses = [
            (shutter.time01(code.GetValue()), array(required(points, code, FLOAT3S), np.float32, 3), code)
            for code in codes
        ]
    else:
        poses = [
            (time01, pose, context.code if time01 is None else shutter.time_code(time01))
            for time01, pose in samples.values
        ]
    found = []
    for time01, pose, code in poses:
        along = array(required(tangents, code, FLOAT3S), np.float32, 3)
        if len(along) != len(pose):
            raise Unreadable(
                str(shape.GetPath()), "tangents", f"found {len(along)} values, expected {len(pose)}, as many as points"
            )
        found.append((time01, np.concatenate([pose, pose + along])))
    return Samples(found, samples.held)


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
    found_widths = sample_primvar(FoundPrimvar(prim, plain, None, attribute, False), context)
    if found_widths is None and attribute.HasAuthoredValue():  # of another type, which has been said
        return "constant", np.array([DEFAULT_WIDTH], np.float32), None
    return found_widths
