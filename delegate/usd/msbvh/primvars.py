"""Primvars that the renderer shades with: displayColor and displayOpacity, indexed and inherited ones too."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from pxr import Usd, UsdGeom

from .context import FrameContext, array
from .times import JUMP_TIME01, sample_times
from .value_types import COLOR_PRIMVAR, FLOAT_PRIMVAR, INTS, Kind
from .values import Unreadable, ignore, required, value

PrimvarInput = tuple[str, np.ndarray, np.ndarray | None]
"""Interpolation, float32[K] or float32[K, 3], int32 indices or None."""

MovingPrimvar = tuple[str, np.ndarray | list[tuple[float, np.ndarray]], np.ndarray | None]
"""The same; where the values change inside the shutter, (time01, values) at increasing times, linear between
them. Two samples within JUMP_TIME01 make a jump."""


def read_primvar(
    prim: Usd.Prim, name: str, columns: int | None, context: FrameContext
) -> PrimvarInput | None:
    """A primvar at the frame, its own or inherited; None where none is authored.

    `columns` is 3 for colours, None for scalars. A value of another type is left out with a warning.
    """
    primvar = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance(name)
    return _at_frame(primvar, primvar.GetAttr(), columns, context) if primvar else None


def _at_frame(
    primvar: UsdGeom.Primvar, attribute: Usd.Attribute, columns: int | None, context: FrameContext
) -> PrimvarInput | None:
    """`attribute` is the primvar's."""
    code, indices = context.code, None
    kind = FLOAT_PRIMVAR if columns is None else COLOR_PRIMVAR
    try:
        values = array(required(attribute, code, kind), np.float32, columns)
        if len(values) and primvar.IsIndexed():
            indices = array(required(primvar.GetIndicesAttr(), code, INTS), np.int32)
    except Unreadable as fault:
        ignore(fault)
        return None
    return (str(primvar.GetInterpolation()), values, indices) if len(values) else None


def sample_primvar(
    prim: Usd.Prim, name: str, columns: int | None, context: FrameContext
) -> MovingPrimvar | None:
    """Like read_primvar(), over the shutter. Indices are those of the frame.

    Values that cannot be interpolated, since their number changes or one is not finite, are held, with a
    warning.
    """
    primvar = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance(name)
    if not primvar:
        return None
    attribute = primvar.GetAttr()
    at_frame = _at_frame(primvar, attribute, columns, context)
    if at_frame is None or not context.shutter.moving:
        return at_frame
    interpolation, values, indices = at_frame
    if indices is not None and _changes(primvar.GetIndicesAttr(), INTS, context):
        message = "the indices change within the shutter; held those of the frame"
        context.diagnostics.warning(str(prim.GetPath()), primvar.GetName(), message)
    samples = _samples(attribute, FLOAT_PRIMVAR if columns is None else COLOR_PRIMVAR, context)
    if all(np.array_equal(sample, values) for _, sample in samples):
        return at_frame
    if any(len(sample) != len(values) for _, sample in samples):
        message = f"the number of values changes within the shutter; held the frame's {len(values)}"
        context.diagnostics.warning(str(prim.GetPath()), primvar.GetName(), message)
        return at_frame
    if not np.isfinite(values).all():
        return at_frame  # The translator says so: with nothing to hold, one message is enough.
    if not all(np.isfinite(sample).all() for _, sample in samples):
        message = "found a value within the shutter that is not finite; held the frame's values"
        context.diagnostics.warning(str(prim.GetPath()), primvar.GetName(), message)
        return at_frame
    return interpolation, _with_jumps(samples) if context.held else samples, indices


def warn_of_change(prim: Usd.Prim, name: str, columns: int | None, context: FrameContext) -> None:
    """For primvars that are read at the frame only."""
    primvar = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance(name)
    if _changes(primvar.GetAttr(), FLOAT_PRIMVAR if columns is None else COLOR_PRIMVAR, context):
        message = "changes within the shutter, which is not supported for instances; held the frame's values"
        context.diagnostics.warning(str(prim.GetPath()), primvar.GetName(), message)


def _samples(
    attribute: Usd.Attribute, kind: Kind, context: FrameContext
) -> list[tuple[float, np.ndarray]]:
    """time01 and values; none where the attribute does not vary over the shutter."""
    shutter = context.shutter
    return [
        (shutter.time01(time), np.asarray(value(attribute, time, kind) or kind.exact()))
        for time in sample_times([attribute], shutter)
    ]


def _changes(attribute: Usd.Attribute, kind: Kind, context: FrameContext) -> bool:
    """Compares values, not sample counts."""
    samples = _samples(attribute, kind, context)
    return any(not np.array_equal(values, samples[0][1]) for _, values in samples)


def _with_jumps(samples: list[tuple[float, np.ndarray]]) -> list[tuple[float, np.ndarray]]:
    """Each value until an instant before the next."""
    result = samples[:1]
    for (_, old), (time01, new) in pairwise(samples):
        result += [(time01 - JUMP_TIME01, old), (time01, new)]
    return result


def primvar_source(prim: Usd.Prim, name: str) -> str:
    """The path of the attribute that a primvar comes from; empty where none is authored."""
    primvar = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance(name)
    return str(primvar.GetAttr().GetPath()) if primvar else ""
