"""Primvars that the renderer shades with: displayColor and displayOpacity, indexed and inherited ones too."""

from __future__ import annotations

import numpy as np
from pxr import Usd, UsdGeom

from ..motion.context import FrameContext, array
from ..motion.held_values import Stretch, changes_within, values_within
from ..motion.times import JUMP_TIME01, Shutter, sample_times
from ..stage.value_types import COLOR_PRIMVAR, FLOAT_PRIMVAR, INTS, Kind
from ..stage.values import Unreadable, ignore, might_vary, required, value

PrimvarInput = tuple[str, np.ndarray, np.ndarray | None]
"""Interpolation, float32[K] or float32[K, 3], int32 indices or None."""

MovingPrimvar = tuple[str, np.ndarray | list[tuple[float, np.ndarray]], np.ndarray | None]
"""The same; where the values change inside the shutter, (time01, values) at increasing times, linear between
them."""


def read_primvar(
    prim: Usd.Prim, name: str, columns: int | None, context: FrameContext, code: Usd.TimeCode | None = None
) -> PrimvarInput | None:
    """A primvar at the frame or at `code`, its own or inherited; None where none is authored.

    `columns` is 3 for colours, None for scalars. A value of another type is left out with a warning.
    """
    primvar = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance(name)
    if not primvar:
        return None
    try:
        return _at(primvar, columns, context.code if code is None else code)
    except Unreadable as fault:
        ignore(fault)
        return None


def _at(primvar: UsdGeom.Primvar, columns: int | None, code: Usd.TimeCode) -> PrimvarInput | None:
    values = array(required(primvar.GetAttr(), code, _kind(columns)), np.float32, columns)
    if not len(values):
        return None
    indices = array(required(primvar.GetIndicesAttr(), code, INTS), np.int32) if primvar.IsIndexed() else None
    return str(primvar.GetInterpolation()), values, indices


def sample_primvar(
    prim: Usd.Prim, name: str, columns: int | None, context: FrameContext, stretch: Stretch | None = None
) -> MovingPrimvar | None:
    """Like read_primvar(), over the shutter, or over that part of it. Indices are those of the frame or the part:
    where they change, held_by() says into which parts the shutter falls.

    Values that cannot be interpolated, since their number changes or one is not finite, are held, with a
    warning.
    """
    at_code = read_primvar(prim, name, columns, context, stretch and stretch.code)
    if at_code is None or not context.shutter.moving:
        return at_code
    interpolation, values, indices = at_code
    primvar = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance(name)
    path = str(prim.GetPath())
    if stretch is None and (context.held or indices is not None) and held_by(prim, name, context):
        return at_code
    samples = _samples(primvar.GetAttr(), _kind(columns), context, stretch)
    if all(np.array_equal(sample, values) for _, sample in samples):
        return at_code
    if any(len(sample) != len(values) for _, sample in samples):
        message = f"the number of values changes within the shutter; held the frame's {len(values)}"
        context.diagnostics.warning(path, primvar.GetName(), message)
        return at_code
    if not np.isfinite(values).all():
        return at_code  # The translator says so: with nothing to hold, one message is enough.
    if not all(np.isfinite(sample).all() for _, sample in samples):
        message = "found a value within the shutter that is not finite; held the frame's values"
        context.diagnostics.warning(path, primvar.GetName(), message)
        return at_code
    return interpolation, samples, indices


def _kind(columns: int | None) -> Kind:
    return FLOAT_PRIMVAR if columns is None else COLOR_PRIMVAR


def held_by(prim: Usd.Prim, name: str, context: FrameContext) -> list[Usd.Attribute]:
    """What of a primvar holds until its next sample, and changes within the shutter: indices, and the values where
    their number changes with the indices, or the stage holds all values. Each value of theirs has a track of its own.
    """
    primvar = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance(name)
    if not primvar or not context.shutter.moving:
        return []
    attribute, held = primvar.GetAttr(), []
    if primvar.IsIndexed() and changes_within(primvar.GetIndicesAttr(), context.shutter):
        held.append(primvar.GetIndicesAttr())
    if not might_vary(attribute) or not (context.held or primvar.IsIndexed()):
        return held
    first, *others = values_within(attribute, context.shutter)
    if any(value != first if context.held else len(value or ()) != len(first or ()) for value in others):
        held.append(attribute)
    return held


def _samples(
    attribute: Usd.Attribute, kind: Kind, context: FrameContext, stretch: Stretch | None
) -> list[tuple[float, np.ndarray]]:
    """time01 and values; none where the attribute does not vary over the shutter."""
    shutter = context.shutter
    times = sample_times([attribute], shutter)
    if stretch is None or stretch.shown is None:
        codes = [(shutter.time01(time), Usd.TimeCode(time)) for time in times]
    else:
        knots = _knots(times, stretch.shown, shutter) if times else []
        codes = [(time01, shutter.time_code(time01)) for time01 in knots]
    return [(time01, np.asarray(value(attribute, code, kind) or kind.exact())) for time01, code in codes]


def _knots(times: list[float], shown: np.ndarray, shutter: Shutter) -> list[float]:
    """time01 between which values are linear in parts of the shutter: their ends, an instant before each closing, and
    what is authored within."""
    authored = [shutter.time01(time) for time in times]
    knots: list[float] = []
    for begin, end in shown.tolist():
        last = min(end, 1.0) - JUMP_TIME01
        knots += [begin, *(time01 for time01 in authored if begin < time01 < last)]
        knots += [last] if last > begin else []
    return knots


def primvar_source(prim: Usd.Prim, name: str) -> str:
    """The path of the attribute that a primvar comes from; empty where none is authored."""
    primvar = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance(name)
    return str(primvar.GetAttr().GetPath()) if primvar else ""
