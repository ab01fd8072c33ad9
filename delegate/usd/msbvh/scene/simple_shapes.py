"""Implicit prims as unit shapes under a scale: what many of them may have in common.

A sphere is the unit sphere scaled by its radius, a cylinder the unit cylinder scaled by radius and height,
and so on: prims that differ in nothing else can share a mesh. Only plain cases are taken, where nothing is
animated but transform and visibility and every value is sound; the others stand for themselves, with their
messages.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from pxr import Gf, Usd, Vt

from .._core import UnitForm, unit_form
from ..motion.context import FrameContext
from ..motion.times import Shutter, sample_times
from ..stage.rendering_space import rendered_color
from ..stage.values import might_vary, raw
from .implicit import IMPLICIT_TYPES
from .part import Part
from .primvars import find_primvar, sample_primvar

COLOUR, OPACITY = "primvars:displayColor", "primvars:displayOpacity"


class Alike(NamedTuple):
    """What shapes have in common that share a mesh."""

    kind: str
    """Prim type."""
    parameters: tuple[float, ...]
    """Of the unit shape."""
    opacity: float | None


class Simple(NamedTuple):
    """An implicit prim as a unit shape."""

    part: Part
    alike: Alike
    form: UnitForm
    colour: Gf.Vec3f | None
    binds: bool
    """It may have a material."""


@dataclass(frozen=True)
class _Recipe:
    """How prims of a type with the same authored properties are read; most of a crowd have the same."""

    kind: str
    fallbacks: tuple[float, ...]
    """Of the parameters."""
    authored: tuple[tuple[int, str], ...]
    """The parameters that are read, by their number."""
    axis: bool
    colour: bool
    opacity: bool
    binds: bool
    """It may have a material of its own."""
    plain: bool
    """Nothing is authored that only a shape of its own can have."""


class SimpleShapes:
    """Reads implicit prims as unit shapes."""

    def __init__(self, context: FrameContext) -> None:
        self._context = context
        self._code = context.code
        self._recipes: dict[tuple[str, frozenset[str]], _Recipe] = {}
        self._parent = Usd.Prim()
        self._above = _Above()

    def read(self, part: Part) -> Simple | None:
        """None for a shape that stands for itself."""
        prim, authored = part.prim, part.authored
        key = prim.GetTypeName(), authored
        recipe = self._recipes.get(key) or self._recipes.setdefault(key, _recipe(*key))
        above = self._inherited(part)
        if not recipe.plain or above.skinned:
            return None
        shutter = self._context.shutter.scaled(part.scales.blur)
        values = list(recipe.fallbacks)
        for index, name in recipe.authored:
            value = self._steady(prim.GetAttribute(name), shutter)
            if type(value) is not float:
                return None
            values[index] = value
        axis = raw(prim.GetAttribute("axis"), self._code) if recipe.axis else "Z"
        if axis not in ("X", "Y", "Z"):
            return None
        colour, opacity = above.colour, above.opacity
        if recipe.colour:
            attribute = prim.GetAttribute(COLOUR)
            colour = _single(self._steady(attribute, shutter))
            if colour is not _ODD and (shown := rendered_color(colour, attribute)) is not colour:
                colour = Gf.Vec3f(*shown)
        if recipe.opacity:
            opacity = _single(self._steady(prim.GetAttribute(OPACITY), shutter))
        form = unit_form(recipe.kind, values, axis)
        if form is None or colour is _ODD or opacity is _ODD:
            return None
        binds = recipe.binds or above.binds
        return Simple(part, Alike(recipe.kind, form.parameters, opacity), form, colour, binds)

    def _steady(self, attribute: Usd.Attribute, shutter: Shutter) -> object:
        """The value at the frame; None where it changes within the shutter."""
        found = raw(attribute, self._code)
        if shutter.moving and might_vary(attribute):
            if any(raw(attribute, time) != found for time in sample_times([attribute], shutter)):
                return None
        return found

    def _inherited(self, part: Part) -> _Above:
        """Siblings come one after the other."""
        parent = part.prim.GetParent()
        if parent != self._parent:
            names = part.inherited
            self._parent = parent
            self._above = _Above(
                colour=self._inherited_value(parent, COLOUR, names),
                opacity=self._inherited_value(parent, OPACITY, names),
                skinned=any(name.startswith("primvars:skel:") for name in names),
                binds=any(name.startswith("material:binding") for name in names),
            )
        return self._above

    def _inherited_value(self, parent: Usd.Prim, name: str, names: frozenset[str]) -> object:
        if name not in names:
            return None
        columns = 3 if name == COLOUR else None
        found = find_primvar(parent, name.removeprefix("primvars:"), columns)
        sampled = sample_primvar(found, self._context) if found else None
        if sampled is None:
            return None
        interpolation, values, indices = sampled
        if interpolation != "constant" or not isinstance(values, np.ndarray) or indices is not None:
            return _ODD
        return _single((Vt.Vec3fArray if name == COLOUR else Vt.FloatArray).FromNumpy(values))


@dataclass(frozen=True)
class _Above:
    """What siblings inherit."""

    colour: Any = None
    opacity: Any = None
    skinned: bool = False
    binds: bool = False


_ODD = object()
"""In place of a value: there are several, or it moves, or it is no colour."""


def _recipe(kind: str, authored: frozenset[str]) -> _Recipe:
    definition = Usd.SchemaRegistry().FindConcretePrimDefinition(kind)
    parameters = IMPLICIT_TYPES[kind].parameters
    odd = (f"{COLOUR}:indices", f"{OPACITY}:indices")
    return _Recipe(
        kind=kind,
        fallbacks=tuple(definition.GetAttributeFallbackValue(name) for name in parameters),
        authored=tuple((index, name) for index, name in enumerate(parameters) if name in authored),
        axis="axis" in authored,
        colour=COLOUR in authored,
        opacity=OPACITY in authored,
        binds=any(name.startswith("material:binding") for name in authored),
        plain=not any(name in odd or name.startswith(("skel:", "primvars:skel:")) for name in authored),
    )


def _single(values: object) -> Any:
    """The one element of an array of colours or opacities."""
    if isinstance(values, Vt.Vec3fArray | Vt.FloatArray) and len(values) == 1:
        return values[0]
    return _ODD
