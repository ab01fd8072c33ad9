"""What of a light does not change over the shutter: its image, IES profile, focus tint, shadows and links."""

from __future__ import annotations

from pathlib import PurePosixPath
from typing import Any

from pxr import Gf, Sdf, Usd

from .._core import Error, LightLook
from ..motion.context import FrameContext
from ..motion.held_values import any_but, values_within
from ..stage.rendering_space import color_space, rendered_color, rendering_space
from ..stage.value_types import ASSET, BOOL, FLOAT, FLOAT3, TOKEN, Kind
from ..stage.values import Unreadable, might_vary, value
from .light_links import Links
from .light_texture import read_ies_profile, read_light_image

FORMATS = {"automatic": "latlong", "latlong": "latlong", "angular": "angular", "mirroredBall": "mirroredBall"}


def light_look(prim: Usd.Prim, kind: str, links: Links, context: FrameContext) -> LightLook:
    """By the frame's values. What cannot be read or has no effect is named."""
    look = LightLook()
    _name_no_area(prim, kind, context)
    _add_image(look, prim, kind, context)
    _add_shaping(look, prim, kind, context)
    _add_shadow(look, prim, context)
    lit, shadowed = links.of(prim)
    look.set_links(lit, shadowed)
    return look


def input_at_frame(prim: Usd.Prim, name: str, kind: Kind, fallback: Any, context: FrameContext) -> Any:
    """An input by its name, at the frame; the fallback where there is none or it is of another type, which is named."""
    attribute = prim.GetAttribute(f"inputs:{name}")
    if not attribute:
        return fallback
    try:
        found = value(attribute, context.code, kind)
    except Unreadable as fault:
        context.diagnostics.warning(str(prim.GetPath()), attribute.GetName(), fault.message)
        return fallback
    return fallback if found is None else found


_SIDES = {"rect": ("width", "height"), "disk": ("radius",), "cylinder": ("radius", "length")}


def _name_no_area(prim: Usd.Prim, kind: str, context: FrameContext) -> None:
    """What has none gives no light; a sphere without a radius is a point, and shines."""
    for name in _SIDES.get(kind, ()):
        attribute = prim.GetAttribute(f"inputs:{name}")
        if attribute and not any_but(0.0, attribute, context.shutter):
            context.diagnostics.group(
                str(prim.GetPath()), f"inputs:{name}", f"found 0: a {kind} light without area emits nothing"
            )


def _add_image(look: LightLook, prim: Usd.Prim, kind: str, context: FrameContext) -> None:
    attribute = prim.GetAttribute("inputs:texture:file")
    if not attribute or not (value(attribute, context.code, ASSET) or might_vary(attribute)):
        return
    assets = [asset for asset in values_within(attribute, context.shutter) if isinstance(asset, Sdf.AssetPath)]
    assets = [asset for asset in assets if asset]
    if not assets:
        return
    path, name = str(prim.GetPath()), attribute.GetName()
    if kind not in ("dome", "rect"):
        context.diagnostics.group(path, name, f"found a texture on a {kind} light; expected a dome or a rect; left out")
        return
    layout = "rect"
    if kind == "dome":
        given = str(input_at_frame(prim, "texture:format", TOKEN, "automatic", context))
        if given not in FORMATS:
            message = f"found {given}, expected one of {', '.join(FORMATS)}; lit by the plain colour"
            context.diagnostics.warning(path, "inputs:texture:format", message)
            return
        layout = FORMATS[given]
    if len({asset.path for asset in assets}) > 1:
        message = "found more than one texture within the shutter; the first lights all of it"
        context.diagnostics.warning(path, name, message)
    try:
        resolved = assets[0].resolvedPath
        if not resolved:
            raise ValueError("no such file")
        picture = read_light_image(resolved, color_space(attribute), layout, rendering_space())
    except (ValueError, Error) as fault:
        message = f"found @{assets[0].path}@, which cannot be read ({fault}); lit by the plain colour"
        context.diagnostics.warning(path, name, message)
        return
    look.set_image(picture)
    if picture.mended:
        message = f"found NaN or infinity in {picture.mended} texels of @{assets[0].path}@; took 0, or 65504"
        context.diagnostics.warning(path, name, message)


def _color(prim: Usd.Prim, name: str, context: FrameContext) -> tuple[float, float, float]:
    found = input_at_frame(prim, name, FLOAT3, Gf.Vec3f(0), context)
    attribute = prim.GetAttribute(f"inputs:{name}")
    red, green, blue = rendered_color(found, attribute) if attribute else found
    return red, green, blue


def _add_shaping(look: LightLook, prim: Usd.Prim, kind: str, context: FrameContext) -> None:
    if kind in ("distant", "dome", "mesh"):
        _name_shaping(prim, kind, context)
        return
    look.set_focus_tint(_color(prim, "shaping:focusTint", context))
    asset = input_at_frame(prim, "shaping:ies:file", ASSET, None, context)
    if not asset:
        return
    scale = float(input_at_frame(prim, "shaping:ies:angleScale", FLOAT, 0.0, context))
    normalize = bool(input_at_frame(prim, "shaping:ies:normalize", BOOL, False, context))
    try:
        if not asset.resolvedPath:
            raise ValueError("no such file")
        look.set_ies(read_ies_profile(asset.resolvedPath), scale, normalize)
    except (ValueError, Error) as fault:
        name = PurePosixPath(asset.path).name
        message = f"found @{name}@, which cannot be read ({fault}); lit without it"
        context.diagnostics.warning(str(prim.GetPath()), "inputs:shaping:ies:file", message)


def _name_shaping(prim: Usd.Prim, kind: str, context: FrameContext) -> None:
    """Neither has a place that it shines from."""
    for name, neutral in (
        ("inputs:shaping:cone:angle", 90.0),
        ("inputs:shaping:focus", 0.0),
        ("inputs:shaping:ies:file", Sdf.AssetPath()),
    ):
        attribute = prim.GetAttribute(name)
        if attribute and attribute.HasAuthoredValue() and any_but(neutral, attribute, context.shutter):
            context.diagnostics.group(str(prim.GetPath()), name, f"shapes no {kind} light; lit without it")


def _add_shadow(look: LightLook, prim: Usd.Prim, context: FrameContext) -> None:
    gamma = float(input_at_frame(prim, "shadow:falloffGamma", FLOAT, 1.0, context))
    if not 0.0 < gamma < float("inf"):
        message = f"found {gamma:g}, expected a finite number above 0; took 1"
        context.diagnostics.warning(str(prim.GetPath()), "inputs:shadow:falloffGamma", message)
        gamma = 1.0
    look.set_shadow(
        bool(input_at_frame(prim, "shadow:enable", BOOL, True, context)),
        _color(prim, "shadow:color", context),
        float(input_at_frame(prim, "shadow:distance", FLOAT, -1.0, context)),
        float(input_at_frame(prim, "shadow:falloff", FLOAT, -1.0, context)),
        gamma,
    )


def pole_turn(prim: Usd.Prim, context: FrameContext) -> bool:
    """Whether a dome's top is +z, a quarter turn about x from the +y of its image (UsdLuxDomeLight_1's poleAxis)."""
    if prim.GetTypeName() != "DomeLight_1":
        return False
    axis = value(prim.GetAttribute("poleAxis"), context.code, TOKEN)
    if axis not in ("Y", "Z"):
        return bool(context.stage.GetPseudoRoot().GetMetadata("upAxis") == "Z")
    return axis == "Z"
