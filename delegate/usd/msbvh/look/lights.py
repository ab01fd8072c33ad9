"""Lights of UsdLux as radiance: intensity, exposure, colour, temperature and normalisation multiplied out."""

from __future__ import annotations

from typing import Any

import numpy as np
from pxr import Sdf, Usd, UsdLux

from .._core import Density
from ..motion.context import FrameContext
from ..motion.held_values import any_but, values_within
from ..motion.transforms import Motion
from ..motion.turns import report_too_fast
from ..stage.value_types import ASSET, BOOL
from ..stage.values import Unreadable, might_vary, value
from .light_values import LightSamples, Switches, radiances, sample_light

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
        samples, at_frame = sample_light(prim, switches, context.shutter)
    except Unreadable as fault:
        context.diagnostics.error(path, fault.attribute, f"{fault.message}; the light is left out")
        return 0
    _warn_of_the_rest(prim, context)
    if kind == "sphere" and not all(map(_is_similarity, motion.at_time(context.shutter.frame01))):
        message = "found a transform that shears or scales unevenly; lit as the sphere of equal volume"
        context.diagnostics.group(path, "xformOpOrder", message)
    for index in range(motion.count):
        report_too_fast(motion.turns(index), path, context.diagnostics)
        light = _keywords(kind, samples, at_frame, motion, index, context)
        translator.add_light(name=path, kind=kind, **light, **_place(motion, index, context.held))
    return motion.count


def _times01(motion: Motion, held: bool) -> list[float]:
    """Where the transform of a light is evaluated, for lines between."""
    return motion.dense_times01(Density.LIGHT, held)


def _place(motion: Motion, index: int, held: bool) -> dict:
    """One of the motion's transforms."""
    times01 = _times01(motion, held)
    place = motion.at_times(times01)[:, index]
    last = 1 if (place == place[0]).all() else len(times01)
    return {"times01": np.array(times01[:last]), "world_from_light": np.ascontiguousarray(place[:last])}


def _keywords(
    kind: str, samples: LightSamples, at_frame: LightSamples, motion: Motion, index: int, context: FrameContext
) -> dict:
    """The values at the frame, and over the shutter where they change."""
    frame_matrix = motion.at_time(context.shutter.frame01)[index]
    if samples.still:
        at_frame = samples
    radiance = radiances(kind, at_frame, frame_matrix[None])[0]
    angle, radius, width, height = at_frame.sizes[0].tolist()
    light = {
        "radiance": tuple(radiance.tolist()),
        "angle_degrees": angle,
        "radius": radius,
        "width": width,
        "height": height,
    }
    if samples.still and samples.normalize[0] and not motion.still:
        samples = samples.at(_times01(motion, context.held))
    if samples.still:
        return light
    matrices = np.repeat(frame_matrix[None], len(samples.times01), axis=0)
    if samples.normalize.any():
        matrices = np.array([motion.at_time(time01)[index] for time01 in samples.times01.tolist()])
    over_shutter = radiances(kind, samples, matrices)
    if (over_shutter == over_shutter[0]).all() and (samples.sizes == samples.sizes[0]).all():
        return light
    with np.errstate(over="ignore"):  # The translator says what is not finite.
        light["radiances"] = over_shutter.astype(np.float32)
    light["values_times01"] = samples.times01
    light["sizes"] = samples.sizes.astype(np.float32)
    return light


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


def _is_similarity(matrix: np.ndarray) -> bool:
    """Whether float64[4, 4] keeps spheres round, but for what single precision rounds; not said of NaN."""
    with np.errstate(invalid="ignore"):
        gram = matrix[:3, :3] @ matrix[:3, :3].T
        uneven = np.abs(gram - np.eye(3) * gram.trace() / 3).max()
    return not uneven > 1e-5 * gram.trace()


def camera_light(times01: np.ndarray, world_from_camera: np.ndarray) -> dict:
    """usdrecord's light at the camera, for stages without lights: the translator's keywords."""
    light = {"name": "camera light", "kind": "camera", "radiance": (1.0, 1.0, 1.0)}
    sizes = {"angle_degrees": 0.0, "radius": 0.0, "width": 0.0, "height": 0.0}
    return {**light, **sizes, "times01": times01, "world_from_light": world_from_camera}
