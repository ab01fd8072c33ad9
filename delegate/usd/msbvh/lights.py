"""Lights of UsdLux as radiance: intensity, exposure, colour, temperature and normalisation multiplied out."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from pxr import Sdf, Usd, UsdLux

from .context import FrameContext
from .transforms import Motion

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


def read_light(prim: Usd.Prim, world_from_light: np.ndarray, context: FrameContext) -> dict | None:
    """The translator's keywords of a light at the frame, without its motion; None, with a warning, if
    unsupported.

    `world_from_light` is float64[4, 4] at the frame: normalisation is by the area in the world.
    """
    kind = SUPPORTED_LIGHTS.get(str(prim.GetTypeName()))
    path = str(prim.GetPath())
    if kind is None:
        context.diagnostics.group(
            path, "", f"lights of type {prim.GetTypeName() or 'none'} are not supported yet; left out"
        )
        return None
    try:
        light = _emitter(kind, prim, world_from_light, context.code)
    except _NotANumber as error:
        context.diagnostics.error(
            path, error.attribute, f"found {error.found!r}, expected {error.expected}; left out"
        )
        return None
    _warn_of_the_rest(prim, context)
    if kind == "sphere" and not _is_similarity(world_from_light):
        message = "found a transform that shears or scales unevenly; lit as the sphere of equal volume"
        context.diagnostics.group(path, "xformOpOrder", message)
    return light


class _NotANumber(Exception):
    """An attribute holds a value of another type."""

    def __init__(self, attribute: Usd.Attribute, found: object, expected: str) -> None:
        self.attribute, self.found, self.expected = attribute.GetName(), found, expected


def _number(attribute: Usd.Attribute, code: Usd.TimeCode) -> float:
    value = attribute.Get(code)
    try:
        return float(value)
    except (TypeError, ValueError):
        raise _NotANumber(attribute, value, "a number") from None


def _colour(attribute: Usd.Attribute, code: Usd.TimeCode) -> np.ndarray:
    value = attribute.Get(code)
    try:
        return np.array(value, np.float64).reshape(3)
    except (TypeError, ValueError):
        raise _NotANumber(attribute, value, "three numbers") from None


def _emitter(kind: str, prim: Usd.Prim, world_from_light: np.ndarray, code: Usd.TimeCode) -> dict:
    light = {"angle_degrees": 0.53, "radius": 0.5, "width": 1.0, "height": 1.0}
    for name in light:
        attribute = prim.GetAttribute("inputs:" + ("angle" if name == "angle_degrees" else name))
        if attribute:
            light[name] = _number(attribute, code)
    radiance = emission(UsdLux.LightAPI(prim), code)
    if UsdLux.LightAPI(prim).GetNormalizeAttr().Get(code):
        radiance = radiance / normalization(kind, light, world_from_light)
    if kind == "sphere" and light["radius"] == 0.0:
        radiance = (
            radiance / 4.0
        )  # Radiant intensity: what a small normalised sphere, pi r^2 L / (4 pi r^2), tends to.
    return {"name": str(prim.GetPath()), "kind": kind, "radiance": tuple(radiance.tolist()), **light}


def emission(light: UsdLux.LightAPI, code: Usd.TimeCode) -> np.ndarray:
    """intensity * 2^exposure * color, times the black body's colour where enabled: float64[3], infinite where
    it is too large."""
    with np.errstate(over="ignore", invalid="ignore"):  # The translator says what is not finite.
        strength = _number(light.GetIntensityAttr(), code) * np.exp2(_number(light.GetExposureAttr(), code))
        colour = strength * _colour(light.GetColorAttr(), code)
    if light.GetEnableColorTemperatureAttr().Get(code):
        kelvin = _number(light.GetColorTemperatureAttr(), code)
        colour = colour * np.array(UsdLux.BlackbodyTemperatureAsRgb(kelvin), np.float64)
    return colour


def normalization(kind: str, light: dict[str, float], world_from_light: np.ndarray) -> float:
    """What inputs:normalize divides by (UsdLux, "Light Contributions"): the world's area, for distant lights
    the cosine-weighted solid angle; 1 where that is 0."""
    axes = np.linalg.norm(world_from_light[:3, :3], axis=1)
    if kind == "sphere":
        a, b, c = light["radius"] * axes
        # Knud Thomsen's formula for ellipsoids, exact for spheres, otherwise within 1.1 %.
        p = 1.6075
        size = 4 * math.pi * (((a * b) ** p + (a * c) ** p + (b * c) ** p) / 3) ** (1 / p)
    elif kind == "rect":
        across = np.cross(world_from_light[0, :3], world_from_light[1, :3])
        size = light["width"] * light["height"] * float(np.linalg.norm(across))
    elif kind == "distant":
        half = math.radians(light["angle_degrees"]) / 2
        sine = math.sin(half) ** 2
        size = math.pi * (sine if half <= math.pi / 2 else 2.0 - sine)
    else:
        size = 1.0
    return size if size > 0.0 else 1.0


def _warn_of_the_rest(prim: Usd.Prim, context: FrameContext) -> None:
    """Names what a supported light has authored beyond what is drawn."""
    path = str(prim.GetPath())
    texture = prim.GetAttribute("inputs:texture:file")
    if texture and texture.Get(context.code):
        found = f"found @{texture.Get(context.code).path}@; not supported yet, lit by the plain colour"
        context.diagnostics.warning(path, texture.GetName(), found)
    for name, neutral in (
        ("inputs:shaping:cone:angle", 90.0),
        ("inputs:shaping:focus", 0.0),
        ("inputs:shaping:ies:file", Sdf.AssetPath()),
        ("inputs:diffuse", 1.0),
        ("inputs:shadow:enable", True),
    ):
        attribute = prim.GetAttribute(name)
        if attribute and attribute.HasAuthoredValue() and attribute.Get(context.code) != neutral:
            context.diagnostics.group(path, name, "not supported yet; lit without it")
    for name in ("lightLink", "shadowLink"):
        if _is_restricted(Usd.CollectionAPI(prim, name)):
            message = "light linking is not supported yet; the light reaches everything"
            context.diagnostics.group(path, f"collection:{name}", message)
    if prim.GetRelationship("light:filters").GetTargets():
        context.diagnostics.group(
            path, "light:filters", "light filters are not supported yet; lit without them"
        )


def _is_restricted(collection: Usd.CollectionAPI) -> bool:
    """Whether a light's collection may leave out prims; by default it holds all."""
    targets = (collection.GetIncludesRel(), collection.GetExcludesRel())
    return (
        any(relationship and relationship.GetTargets() for relationship in targets)
        or collection.GetIncludeRootAttr().Get() is False
        or collection.GetMembershipExpressionAttr().HasAuthoredValue()
    )


def _is_similarity(matrix: np.ndarray) -> bool:
    """Whether float64[4, 4] keeps spheres round, but for what single precision rounds; not said of NaN."""
    with np.errstate(invalid="ignore"):
        gram = matrix[:3, :3] @ matrix[:3, :3].T
        uneven = np.abs(gram - np.eye(3) * gram.trace() / 3).max()
    return not uneven > 1e-5 * gram.trace()


def add_lights(translator: Any, light: dict, motion: Motion, level: int) -> None:
    """Hands a light down once for each of the motion's places, each sampled at a level of the grid."""
    times01, matrices = motion.times01(level), motion.at_level(level)
    for index in range(motion.count):
        place = matrices[:, index]
        last = 1 if (place == place[0]).all() else len(times01)
        translator.add_light(
            **light, times01=np.array(times01[:last]), world_from_light=np.ascontiguousarray(place[:last])
        )


def camera_light(times01: np.ndarray, world_from_camera: np.ndarray) -> dict:
    """usdrecord's light at the camera, for stages without lights: the translator's keywords."""
    light = {"name": "camera light", "kind": "camera", "radiance": (1.0, 1.0, 1.0)}
    sizes = {"angle_degrees": 0.0, "radius": 0.0, "width": 0.0, "height": 0.0}
    return {**light, **sizes, "times01": times01, "world_from_light": world_from_camera}
