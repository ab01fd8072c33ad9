"""Primvars that the renderer shades with: indexed, inherited and moving ones."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from pxr import Usd, UsdGeom

from .._core import knots_within
from ..motion.context import FrameContext, array
from ..motion.held_values import Stretch, changes_within, values_within
from ..motion.times import sample_times
from ..stage.rendering_space import rendered
from ..stage.value_types import COLOR_PRIMVAR, COORDINATE_PRIMVAR, FLOAT_PRIMVAR, INTS, VECTOR4_PRIMVAR, Kind
from ..stage.values import Unreadable, ignore, might_vary, required, value

PrimvarInput = tuple[str, np.ndarray, np.ndarray | None]
"""Interpolation, float32[K] or float32[K, 3], int32 indices or None."""

MovingPrimvar = tuple[str, np.ndarray | list[tuple[float, np.ndarray]], np.ndarray | None]
"""The same; where the values change inside the shutter, (time01, values) at increasing times, linear between
them."""


@dataclass(slots=True)
class FoundPrimvar:
    """A primvar that a prim has or inherits."""

    prim: Usd.Prim
    """Which has it or inherits it."""
    primvar: UsdGeom.Primvar
    columns: int | None
    """3 for colours, 2 for texture coordinates, 4 for other vectors, None for scalars."""
    attribute: Usd.Attribute
    indexed: bool

    @property
    def kind(self) -> Kind:
        """Of the values."""
        return {None: FLOAT_PRIMVAR, 2: COORDINATE_PRIMVAR, 4: VECTOR4_PRIMVAR}.get(self.columns, COLOR_PRIMVAR)

    def rendered(self, values: np.ndarray) -> np.ndarray:
        """Its values; of colours in the space that is rendered in."""
        return rendered(values, self.attribute) if self.columns in (3, 4) and len(values) else values


def find_primvar(
    prim: Usd.Prim, name: str, columns: int | None, authored: frozenset[str] | None = None
) -> FoundPrimvar | None:
    """The prim's own or an inherited one; None where none is authored. `authored`: the names of the prim's properties
    that have opinions, which spare USD most of the search."""
    full = f"primvars:{name}"
    if authored is not None and full in authored:
        attribute = prim.GetAttribute(full)
        if attribute and attribute.HasAuthoredValue():
            primvar = UsdGeom.Primvar(attribute)
            indexed = f"{full}:indices" in authored and primvar.IsIndexed()
            return FoundPrimvar(prim, primvar, columns, attribute, indexed)
    primvar = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance(name)
    return FoundPrimvar(prim, primvar, columns, primvar.GetAttr(), primvar.IsIndexed()) if primvar else None


def read_primvar(found: FoundPrimvar, code: Usd.TimeCode) -> PrimvarInput | None:
    """A primvar at a time. A value of another type is left out with a warning."""
    try:
        values = array(required(found.attribute, code, found.kind), np.float32, found.columns)
        if not len(values):
            return None
        values = found.rendered(values)
        indices = None
        if found.indexed:
            indices = array(required(found.primvar.GetIndicesAttr(), code, INTS), np.int32)
        return str(found.primvar.GetInterpolation()), values, indices
    except Unreadable as fault:
        ignore(fault)
        return None


def sample_primvar(found: FoundPrimvar, context: FrameContext, stretch: Stretch | None = None) -> MovingPrimvar | None:
    """Like read_primvar(), over the shutter, or over that part of it. Indices are those of the frame or the part:
    where they change, held_by() says into which parts the shutter falls.

    Values that cannot be interpolated, since their number changes or one is not finite, are held, with a
    warning.
    """
    at_code = read_primvar(found, context.code if stretch is None else stretch.code)
    if at_code is None or not context.shutter.moving or not _may_vary(found):
        return at_code
    interpolation, values, indices = at_code
    path, name = str(found.prim.GetPath()), found.primvar.GetName()
    if stretch is None and (context.held or indices is not None) and held_by(found, context):
        return at_code
    samples = _samples(found, context, stretch)
    if all(np.array_equal(sample, values) for _, sample in samples):
        return at_code
    if any(len(sample) != len(values) for _, sample in samples):
        message = f"the number of values changes within the shutter; held the frame's {len(values)}"
        context.diagnostics.warning(path, name, message)
        return at_code
    if not np.isfinite(values).all():
        return at_code  # The translator says so: with nothing to hold, one message is enough.
    if not all(np.isfinite(sample).all() for _, sample in samples):
        message = "found a value within the shutter that is not finite; held the frame's values"
        context.diagnostics.warning(path, name, message)
        return at_code
    return interpolation, samples, indices


def _may_vary(found: FoundPrimvar) -> bool:
    """Whether its values or its indices may change over time."""
    return might_vary(found.attribute) or (found.indexed and might_vary(found.primvar.GetIndicesAttr()))


def held_by(found: FoundPrimvar, context: FrameContext) -> list[Usd.Attribute]:
    """What of a primvar holds until its next sample, and changes within the shutter: indices, and the values where
    their number changes with the indices, or the stage holds all values. Each value of theirs has a track of its own.
    """
    if not context.shutter.moving:
        return []
    held = []
    if found.indexed and changes_within(found.primvar.GetIndicesAttr(), context.shutter):
        held.append(found.primvar.GetIndicesAttr())
    if not (context.held or found.indexed) or not might_vary(found.attribute):
        return held
    first, *others = values_within(found.attribute, context.shutter)
    if any(value != first if context.held else len(value or ()) != len(first or ()) for value in others):
        held.append(found.attribute)
    return held


def _samples(found: FoundPrimvar, context: FrameContext, stretch: Stretch | None) -> list[tuple[float, np.ndarray]]:
    """time01 and values; none where the attribute does not vary over the shutter."""
    shutter, kind = context.shutter, found.kind
    times = sample_times([found.attribute], shutter)
    if stretch is None or stretch.shown is None:
        codes = [(shutter.time01(time), Usd.TimeCode(time)) for time in times]
    else:
        knots = knots_within([shutter.time01(time) for time in times], stretch.shown) if times else []
        codes = [(time01, shutter.time_code(time01)) for time01 in knots]
    return [
        (time01, found.rendered(np.asarray(value(found.attribute, code, kind) or kind.exact())))
        for time01, code in codes
    ]


def primvar_source(prim: Usd.Prim, name: str) -> str:
    """The path of the attribute that a primvar comes from; empty where none is authored."""
    primvar = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance(name)
    return str(primvar.GetAttr().GetPath()) if primvar else ""


def constant_primvar(
    primvar: MovingPrimvar | None, name: str, path: str, context: FrameContext
) -> MovingPrimvar | None:
    """An implicit shape has no vertices of its own that a primvar could vary over."""
    if primvar is None or primvar[0] == "constant":
        return primvar
    interpolation, values, indices = primvar
    samples = values if isinstance(values, list) else [(0.0, values)]
    count = len(samples[0][1])
    if count > 1:
        message = f"found {count} {interpolation} values on an implicit shape; drew the first"
        context.diagnostics.warning(path, f"primvars:{name}", message)
    first = [(time01, v[:1] if indices is None else v[indices[:1]]) for time01, v in samples]
    return "constant", first if isinstance(values, list) else first[0][1], None
