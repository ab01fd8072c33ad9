"""Colours in the space that is rendered in: what attributes say of theirs, and the conversion (core/texture/plain_color.h).

A colour that nothing is said about is linear Rec.709. An attribute says what it is by its colorSpace, else the nearest
prim with a ColorSpaceAPI does.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar

import numpy as np
from pxr import Sdf, Usd

from .._core import Error, converted_colors
from .values import diagnostics

LINEAR_REC709 = "lin_rec709_scene"
RENDERING_SPACES = (LINEAR_REC709, "acescg")
"""OpenColorIO's names."""


_space: ContextVar[str] = ContextVar("rendering_space", default=LINEAR_REC709)
"""A context, as that of values.diagnostics(): colours are read in many places that know nothing else of this."""


@contextmanager
def rendered_in(space: str) -> Iterator[None]:
    """Colours that are read inside come out in that space."""
    token = _space.set(space)
    try:
        yield
    finally:
        _space.reset(token)


def rendering_space() -> str:
    """Of the frame that is being read."""
    return _space.get()


def color_space(attribute: Usd.Attribute) -> str:
    """What the stage says of the colours of an attribute, or of the file that it names: its own colorSpace, or that of the
    nearest prim with a ColorSpaceAPI; empty for neither."""
    return str(Usd.ColorSpaceAPI.ComputeColorSpaceName(attribute, None))


_COLOR_NAMES = ("primvars:displayColor", "model:drawModeColor")
"""Colours whatever their type."""


def is_color(attribute: Usd.Attribute) -> bool:
    """Whether its values are colours, not other numbers."""
    return attribute.GetTypeName().role == Sdf.ValueRoleNames.Color or attribute.GetName() in _COLOR_NAMES


def _given(attribute: Usd.Attribute | None) -> str | None:
    """What an attribute's colours are converted from; None: from nothing."""
    if attribute is not None and not is_color(attribute):
        return None
    given = color_space(attribute) if attribute is not None else ""
    return None if (given or LINEAR_REC709) == rendering_space() else given


def rendered(colors: np.ndarray, attribute: Usd.Attribute | None) -> np.ndarray:
    """float32[N, 3], or [N, 4] with alpha, of an attribute in the space that is rendered in: the very same array where
    nothing is to be done, or the attribute is none of colours. None: linear Rec.709. A space that nobody knows counts as
    that, with a warning."""
    given, space = _given(attribute), rendering_space()
    if given is None:
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
    if _given(attribute) is None:
        return color
    return tuple(rendered(np.array([color], np.float32), attribute)[0].tolist())
