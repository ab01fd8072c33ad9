"""Primvars that the renderer shades with: displayColor and displayOpacity, indexed and inherited ones too."""

from __future__ import annotations

import numpy as np
from pxr import Usd, UsdGeom

from .context import FrameContext, array

PrimvarInput = tuple[str, np.ndarray, np.ndarray | None]
"""Interpolation, float32[K] or float32[K, 3], int32 indices or None."""


def read_primvar(
    prim: Usd.Prim, name: str, columns: int | None, context: FrameContext
) -> PrimvarInput | None:
    """A primvar at the frame, its own or inherited; None where none is authored.

    `columns` is 3 for colours, None for scalars. A value of another type is left out with a warning.
    """
    primvar = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance(name)
    value = primvar.Get(context.code) if primvar else None
    if value is None:
        return None
    expected = "float[]" if columns is None else f"an array of {columns} floats"
    try:
        values = array(value, np.float32, columns)
    except (TypeError, ValueError):
        found = f"found a {type(value).__name__}, expected {expected}; ignored"
        context.diagnostics.warning(str(prim.GetPath()), primvar.GetName(), found)
        return None
    if not len(values):
        return None
    indices = array(primvar.GetIndices(context.code), np.int32) if primvar.IsIndexed() else None
    return str(primvar.GetInterpolation()), values, indices


def primvar_source(prim: Usd.Prim, name: str) -> str:
    """The path of the attribute that a primvar comes from; empty where none is authored."""
    primvar = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance(name)
    return str(primvar.GetAttr().GetPath()) if primvar else ""
