"""Colours in the space that is rendered in: what attributes say of theirs, and the conversion (core/texture/plain_color.h).

A colour that nothing is said about is linear Rec.709. An attribute says what it is by its colorSpace, else the nearest
prim with a ColorSpaceAPI does.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field

import numpy as np
from pxr import Sdf, Usd

from .._core import Error, converted_colors
from .value_types import TOKEN
from .values import diagnostics, value

LINEAR_REC709 = "lin_rec709_scene"
RENDERING_SPACES = (LINEAR_REC709, "acescg")
"""OpenColorIO's names."""


@dataclass
class _Reading:
    """A frame that is being read."""

    space: str = LINEAR_REC709
    of_prims: dict[Sdf.Path, str] = field(default_factory=dict)


_reading: ContextVar[_Reading] = ContextVar("reading")
"""A context, as that of values.diagnostics(): colours are read in many places that know nothing else of this."""


@contextmanager
def rendered_in(space: str) -> Iterator[None]:
    """Colours that are read inside come out in that space."""
    token = _reading.set(_Reading(space))
    try:
        yield
    finally:
        _reading.reset(token)


def _current() -> _Reading:
    found = _reading.get(None)
    return _Reading() if found is None else found


def rendering_space() -> str:
    """Of the frame that is being read."""
    return _current().space


def color_space(attribute: Usd.Attribute) -> str:
    """What the stage says of the colours of an attribute, or of the file that it names: its own colorSpace, or that of the
    nearest prim with a ColorSpaceAPI; empty for neither."""
    if attribute.HasColorSpace():
        return str(attribute.GetColorSpace())
    return _of_prim(attribute.GetPrim(), _current().of_prims)


def _of_prim(prim: Usd.Prim, known: dict[Sdf.Path, str]) -> str:
    if not prim or prim.IsPseudoRoot():
        return ""
    path = prim.GetPath()
    if path not in known:
        own = ""
        if prim.HasAPI(Usd.ColorSpaceAPI):
            own = value(prim.GetAttribute("colorSpace:name"), Usd.TimeCode.Default(), TOKEN) or ""
        known[path] = str(own) or _of_prim(prim.GetParent(), known)
    return known[path]


def is_color(attribute: Usd.Attribute) -> bool:
    """Whether its values are colours, not other numbers."""
    return attribute.GetTypeName().role == Sdf.ValueRoleNames.Color or attribute.GetName() == "primvars:displayColor"


def rendered(colors: np.ndarray, attribute: Usd.Attribute | None) -> np.ndarray:
    """float32[N, 3], or [N, 4] with alpha, of an attribute in the space that is rendered in: the very same array where
    nothing is to be done. None: linear Rec.709. A space that nobody knows counts as that, with a warning."""
    space = rendering_space()
    given = color_space(attribute) if attribute is not None else ""
    if (given or LINEAR_REC709) == space:
        return colors
    flat = np.ascontiguousarray(colors[:, :3], np.float32)
    try:
        converted = converted_colors(flat, given, space)
    except Error as error:
        if attribute is None:
            raise
        message = f"{error}; taken as {LINEAR_REC709}"
        diagnostics().group(str(attribute.GetPrimPath()), attribute.GetName(), message)
        converted = converted_colors(flat, LINEAR_REC709, space)
    return np.concatenate([converted, colors[:, 3:]], axis=1) if colors.shape[1] > 3 else converted


def rendered_color(color: Sequence[float], attribute: Usd.Attribute | None) -> Sequence[float]:
    """One colour of three or four numbers, or the same object where nothing is to be done."""
    values = np.array([color], np.float32)
    found = rendered(values, attribute)
    return color if found is values else tuple(found[0].tolist())
