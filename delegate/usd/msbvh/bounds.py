"""The bounds of what a stage shows, whatever single prims say of theirs."""

from __future__ import annotations

import numpy as np
from pxr import Gf, Tf, Usd, UsdGeom

from .errors import Diagnostics
from .tokens import inherited_purpose
from .value_types import FLOAT3S
from .values import value
from .xform_ops import world_transform

LARGEST_COORDINATE = 2.0**60
"""What single precision can square and multiply; see core/geometry/triangle_mesh.h."""


def stage_bounds(
    stage: Usd.Stage, code: Usd.TimeCode, purposes: list[str], diagnostics: Diagnostics
) -> Gf.Range3d:
    """USD's bounds of the stage; prim by prim where an authored extent makes nonsense of them. Empty for nothing."""
    cache = UsdGeom.BBoxCache(code, purposes, useExtentsHint=True)
    bounds = _world_bound(cache, stage.GetPseudoRoot())
    if bounds is not None:
        return bounds
    bounds = Gf.Range3d()
    prims = iter(Usd.PrimRange.Stage(stage, Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)))
    for prim in prims:
        if not prim.IsA(UsdGeom.Boundable):
            continue
        prims.PruneChildren()
        own = _world_bound(cache, prim)
        if own is None and _is_shown(cache, prim, purposes):
            own = _from_points(cache, prim, code, diagnostics)
        bounds.UnionWith(own or Gf.Range3d())
    return bounds


def _world_bound(cache: UsdGeom.BBoxCache, prim: Usd.Prim) -> Gf.Range3d | None:
    """None for bounds that nothing can have. Errors on single prims, which USD raises once, leave the others'."""
    for _ in range(2):
        try:
            found = cache.ComputeWorldBound(prim).ComputeAlignedRange()
            break
        except Tf.ErrorException:
            found = Gf.Range3d()
    # Without points USD's bounds are the largest floats, not empty.
    finite = all(abs(x) < LARGEST_COORDINATE for x in (*found.min, *found.max))
    return found if finite and not found.IsEmpty() else None


def _is_shown(cache: UsdGeom.BBoxCache, prim: Usd.Prim, purposes: list[str]) -> bool:
    imageable = UsdGeom.Imageable(prim)
    shown = imageable.ComputeVisibility(cache.GetTime()) != UsdGeom.Tokens.invisible
    return shown and inherited_purpose(prim) in purposes


def _from_points(
    cache: UsdGeom.BBoxCache, prim: Usd.Prim, code: Usd.TimeCode, diagnostics: Diagnostics
) -> Gf.Range3d | None:
    """From a prim's points, where it has any; says so where its extent is to blame."""
    if not prim.IsA(UsdGeom.PointBased):
        return None
    points = np.asarray(value(UsdGeom.PointBased(prim).GetPointsAttr(), code, FLOAT3S) or np.zeros((0, 3)))
    points = points[(np.abs(points) < LARGEST_COORDINATE).all(axis=1)]
    if not len(points):
        return None
    extent = UsdGeom.Boundable(prim).GetExtentAttr()
    if extent.HasAuthoredValue():
        message = "found no finite box, expected the box around the points; framed these"
        diagnostics.warning(str(prim.GetPath()), "extent", message)
    to_world = world_transform(UsdGeom.XformCache(code), prim)
    box = Gf.Range3d(Gf.Vec3d(*map(float, points.min(axis=0))), Gf.Vec3d(*map(float, points.max(axis=0))))
    bounds = Gf.BBox3d(box, to_world).ComputeAlignedRange()
    return bounds if all(abs(x) < LARGEST_COORDINATE for x in (*bounds.min, *bounds.max)) else None
