"""The cards of model:drawMode: quads in a model's box, or where their textures were rendered from (UsdGeomModelAPI)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from pxr import Usd, UsdGeom

from ..look.texture_files import texture_files
from ..look.texture_matrix import screen_from_world
from ..look.texture_mean import texture_mean
from ..motion.context import FrameContext
from ..motion.held_values import warn_of_change
from ..stage.rendering_space import rendered_color
from ..stage.value_types import ASSET, TOKEN
from ..stage.values import value

_AXES, _SIDES = "XYZ", ("Pos", "Neg")
_QUAD = np.array([(1, 1), (0, 1), (0, 0), (1, 0)], float)
"""Of the two other axes, in their cyclic order: counter-clockwise seen from the positive end of the axis."""
_SCREEN = np.array([(1, -1, 0, 1), (-1, -1, 0, 1), (-1, 1, 0, 1), (1, 1, 0, 1)], float)
"""The corners of a picture."""


@dataclass
class Cards:
    """Quads, each with what is seen on it."""

    places: np.ndarray
    """float64[K, 4, 3]: shares of the box, or points where `absolute`."""
    absolute: bool
    colours: np.ndarray
    """float32[K, 3]."""
    opacities: np.ndarray
    """float32[K]."""


@dataclass
class _Face:
    """One side of an axis."""

    attribute: Usd.Attribute
    files: list[str]
    mean: np.ndarray | None = None
    """float64[4]: colour and alpha that stand in for its texture; None: it names none."""


def read_cards(prim: Usd.Prim, colour: np.ndarray, context: FrameContext) -> Cards:
    """The cards of a model. `colour`: float32[3], of what has no texture, or one that cannot be read."""
    geometry = value(prim.GetAttribute("model:cardGeometry"), context.code, TOKEN) or UsdGeom.Tokens.cross
    visibility = prim.GetAttribute("model:cardVisibility")
    if visibility and value(visibility, context.code, TOKEN) == "simple":
        message = "found 'simple', which is not supported yet; every card is drawn"
        context.diagnostics.group(str(prim.GetPath()), visibility.GetName(), message)
    faces = [[_read_face(prim, axis, side, colour, context) for side in _SIDES] for axis in _AXES]
    if geometry == UsdGeom.Tokens.fromTexture:
        return _from_textures(faces, context)
    if geometry not in (UsdGeom.Tokens.box, UsdGeom.Tokens.cross):
        message = f"found '{geometry}', expected cross, box or fromTexture; took cross"
        context.diagnostics.warning(str(prim.GetPath()), "model:cardGeometry", message)
    return _in_box(faces, geometry == UsdGeom.Tokens.box, np.append(colour, 1.0))


def _read_face(prim: Usd.Prim, axis: str, side: str, colour: np.ndarray, context: FrameContext) -> _Face:
    attribute = prim.GetAttribute(f"model:cardTexture{axis}{side}")
    if not attribute:
        return _Face(attribute, [])
    asset = value(attribute, context.code, ASSET)
    warn_of_change(attribute, "", context.shutter, context.diagnostics)
    if asset is None or not asset.path:
        return _Face(attribute, [])
    files = texture_files(asset, attribute)
    mean = texture_mean(files, "auto")
    if mean is None:
        drawn = f"@{asset.path}@ cannot be read, drawn as model:drawModeColor"
    else:
        drawn = "drawn as the mean of its texture"
    message = f"textures of cards are not evaluated yet; {drawn}"
    context.diagnostics.group(str(prim.GetPath()), attribute.GetName(), message)
    if mean is None:
        return _Face(attribute, files, np.append(colour, 1.0))
    return _Face(attribute, files, np.array([*rendered_color(mean[:3], None), mean[3]]))


def _in_box(faces: list[list[_Face]], box: bool, plain: np.ndarray) -> Cards:
    """An axis without textures has no cards, unless none has any; a side without one shows the other's. Both sides of a
    cross are one quad, which shows the mean of both."""
    places, seen = [], []
    bare = all(face.mean is None for axis in faces for face in axis)
    for axis, sides in enumerate(faces):
        means = [face.mean for face in sides if face.mean is not None] or ([plain] if bare else [])
        if not means:
            continue
        if not box:
            places.append(_quad(axis, 0.5))
            seen.append(np.mean(means, axis=0))
            continue
        for place, face in ((1.0, sides[0]), (0.0, sides[1])):
            places.append(_quad(axis, place))
            seen.append(means[0] if face.mean is None else face.mean)
    return _cards(np.array(places), False, seen)


def _quad(axis: int, place: float) -> np.ndarray:
    corners = np.full((4, 3), place)
    corners[:, [(axis + 1) % 3, (axis + 2) % 3]] = _QUAD
    return corners if place > 0 else corners[::-1]


def _from_textures(faces: list[list[_Face]], context: FrameContext) -> Cards:
    places, seen = [], []
    for face in (face for axis in faces for face in axis if face.mean is not None):
        matrix = screen_from_world(face.files[0]) if face.files else None
        if matrix is None:
            message = "found no invertible worldtoscreen in the texture's metadata, expected one; the card is not drawn"
            context.diagnostics.warning(str(face.attribute.GetPrimPath()), face.attribute.GetName(), message)
            continue
        corners = _SCREEN @ np.linalg.inv(matrix)
        places.append(corners[:, :3] / corners[:, 3:])
        seen.append(face.mean)
    return _cards(np.array(places).reshape(-1, 4, 3), True, seen)


def _cards(places: np.ndarray, absolute: bool, seen: list[np.ndarray | None]) -> Cards:
    values = np.array(seen, np.float32).reshape(-1, 4)
    return Cards(places, absolute, np.ascontiguousarray(values[:, :3]), np.ascontiguousarray(values[:, 3]))
