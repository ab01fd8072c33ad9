"""Authored normals of what has points: primvars:normals before normals."""

from __future__ import annotations

from typing import Any

import numpy as np
from pxr import UsdGeom

from .._core import MeshInput
from ..motion.context import FrameContext, array
from ..motion.points import optional_samples
from ..stage.value_types import INTS
from ..stage.values import value


def add_normals(target: MeshInput, mesh: UsdGeom.PointBased, context: FrameContext, authored: frozenset[str]) -> None:
    if authored.isdisjoint(("normals", "primvars:normals")):
        return
    for name, given in _normals(mesh, context).items():
        setattr(target, name, given)


def _normals(mesh: UsdGeom.PointBased, context: FrameContext) -> dict[str, Any]:
    """The translator's names of authored normals: primvars:normals, which may be indexed, before normals (UsdGeomPointBased)."""
    primvar = UsdGeom.PrimvarsAPI(mesh).GetPrimvar("normals")
    indices = None
    if primvar and primvar.HasAuthoredValue():
        attribute, interpolation = primvar.GetAttr(), primvar.GetInterpolation()
        indices = array(value(primvar.GetIndicesAttr(), context.code, INTS), np.int32) if primvar.IsIndexed() else None
    else:
        attribute, interpolation = mesh.GetNormalsAttr(), mesh.GetNormalsInterpolation()
    if not attribute.HasAuthoredValue():
        return {}
    samples = optional_samples(attribute, context)
    if not samples or not any(len(values) for _, values in samples):
        return {}
    return {
        "normals": samples,
        "normals_interpolation": str(interpolation),
        "normals_indices": indices,
    }
