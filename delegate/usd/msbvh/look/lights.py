"""Lights of UsdLux as radiance: intensity, exposure, colour, temperature and normalisation multiplied out."""

from __future__ import annotations

from typing import Any

import numpy as np
from pxr import Sdf, Usd, UsdLux

from .._core import is_similarity, light_times01, placed_light
from ..motion.context import FrameContext
from ..motion.held_values import any_but, values_within
from ..motion.transforms import Motion
from ..motion.turns import report_too_fast
from ..stage.value_types import ASSET, BOOL
from ..stage.values import Unreadable, might_vary, value
from .light_values import Switches, sample_light

SUPPORTED_LIGHTS = {
    "DistantLight": "distant",
    "DomeLight": "dome",
    "DomeLight_1": "dome",
    "SphereLight": "sphere",
    "RectLight": "rect",
}


def is_light(prim: Usd.Prim) -> bool:
    """Whether a prim emits light: by its type or, as meshes do, by an applied schema."""
    return prim.HasAPI(UsdLux.LightAPI)


def add_lights(
    translator: Any,
    prim: Usd.Prim,
    switches: Switches,
    motion: Motion,
    context: FrameContext,
) -> int:
    """Hands a light down once for each of the motion's places, over the shutter. Returns how many: none, with
    a warning, if it is unsupported.

    `switches` turn it on or off inside the shutter.
    """
    kind = SUPPORTED_LIGHTS.get(str(prim.GetTypeName()))
    path = str(prim.GetPath())
    if kind is None:
        context.diagnostics.group(
            path, "", f"lights of type {prim.GetTypeName() or 'none'} are not supported yet; left out"
        )
        return 0
    try:
        light = sample_light(prim, switches, context.shutter)
    except Unreadable as fault:
        context.diagnostics.error(path, fault.attribute, f"{fault.message}; the light is left out")
        return 0
    _warn_of_the_rest(prim, context)
    frame01 = context.shutter.frame01
    if kind == "sphere" and not all(map(is_similarity, motion.at_time(frame01))):
        message = "found a transform that shears or scales unevenly; lit as the sphere of equal volume"
        context.diagnostics.group(path, "xformOpOrder", message)
    times01 = light_times01(motion, context.held)
    for index in range(motion.count):
        report_too_fast(motion.turns(index), path, context.diagnostics)
        translator.add_light(name=path, kind=kind, **placed_light(kind, light, motion, index, times01, frame01))
    return motion.count


def _warn_of_the_rest(prim: Usd.Prim, context: FrameContext) -> None:
    """Names what a supported light has authored beyond what is drawn."""
    path = str(prim.GetPath())
    texture = prim.GetAttribute("inputs:texture:file")
    textures = []
    if texture and (value(texture, context.code, ASSET) or might_vary(texture)):
        found = values_within(texture, context.shutter)
        textures = [asset for asset in found if isinstance(asset, Sdf.AssetPath) and asset]
    if textures:
        message = f"found @{textures[0].path}@; not supported yet, lit by the plain colour"
        context.diagnostics.warning(path, texture.GetName(), message)
    for name, neutral in (
        ("inputs:shaping:cone:angle", 90.0),
        ("inputs:shaping:focus", 0.0),
        ("inputs:shaping:ies:file", Sdf.AssetPath()),
        ("inputs:diffuse", 1.0),
        ("inputs:shadow:enable", True),
    ):
        attribute = prim.GetAttribute(name)
        if not attribute or not attribute.HasAuthoredValue():
            continue
        if any_but(neutral, attribute, context.shutter):
            context.diagnostics.group(path, name, "not supported yet; lit without it")
    for name in ("lightLink", "shadowLink"):
        if _is_restricted(Usd.CollectionAPI(prim, name)):
            message = "light linking is not supported yet; the light reaches everything"
            context.diagnostics.group(path, f"collection:{name}", message)
    if prim.GetRelationship("light:filters").GetTargets():
        context.diagnostics.group(path, "light:filters", "light filters are not supported yet; lit without them")


def _is_restricted(collection: Usd.CollectionAPI) -> bool:
    """Whether a light's collection may leave out prims; by default it holds all."""
    targets = (collection.GetIncludesRel(), collection.GetExcludesRel())
    return (
        any(relationship and relationship.GetTargets() for relationship in targets)
        or value(collection.GetIncludeRootAttr(), Usd.TimeCode.Default(), BOOL) is False
        or collection.GetMembershipExpressionAttr().HasAuthoredValue()
    )


def camera_light(times01: np.ndarray, world_from_camera: np.ndarray) -> dict:
    """usdrecord's light at the camera, for stages without lights: the translator's keywords."""
    light = {"name": "camera light", "kind": "camera", "radiance": (1.0, 1.0, 1.0)}
    sizes = {"angle_degrees": 0.0, "radius": 0.0, "width": 0.0, "height": 0.0}
    return {**light, **sizes, "times01": times01, "world_from_light": world_from_camera}
