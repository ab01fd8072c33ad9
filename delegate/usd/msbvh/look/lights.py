"""Lights of UsdLux as radiance: intensity, exposure, colour, temperature and normalisation multiplied out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from pxr import Sdf, Usd, UsdLux

from .._core import is_similarity, light_times01, placed_light
from ..motion.context import FrameContext
from ..motion.transforms import Motion
from ..motion.turns import report_too_fast
from ..stage.value_types import BOOL, TOKEN
from ..stage.values import Unreadable, value
from .light_links import Links
from .light_look import light_look, pole_turn
from .light_values import Switches, sample_light
from .portals import Portal, placed_portals

SUPPORTED_LIGHTS = {
    "DistantLight": "distant",
    "DomeLight": "dome",
    "DomeLight_1": "dome",
    "SphereLight": "sphere",
    "RectLight": "rect",
    "DiskLight": "disk",
    "CylinderLight": "cylinder",
}
SYNC_MODES = ("materialGlowTintsLight", "independent", "noMaterialResponse")
_TOP_IS_Z = np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])
"""A quarter turn about x, for row vectors: +y to +z, +z to -y."""


def is_light(prim: Usd.Prim) -> bool:
    """Whether a prim emits light: by its type or, as meshes do, by an applied schema."""
    return prim.HasAPI(UsdLux.LightAPI)


def shining_mesh(prim: Usd.Prim) -> Sdf.Path | None:
    """The geometry whose triangles are a light: a mesh's own, or what a GeometryLight names; None for other lights."""
    if prim.HasAPI(UsdLux.MeshLightAPI):
        return prim.GetPath()
    if prim.GetTypeName() != "GeometryLight":
        return None
    targets = UsdLux.GeometryLight(prim).GetGeometryRel().GetForwardedTargets()
    return targets[0] if targets else Sdf.Path.emptyPath


def add_mesh_light(translator: Any, prim: Usd.Prim, geometry: Sdf.Path, context: FrameContext, links: Links) -> int:
    """Hands down a light whose triangles shine wherever they stand. Returns how many: none, with an error or a warning,
    if it cannot be read."""
    path, is_mesh = str(prim.GetPath()), geometry == prim.GetPath()
    if geometry.isEmpty:
        context.diagnostics.warning(path, "geometry", "found no geometry, expected the path of a mesh; left out")
        return 0
    sync = value(prim.GetAttribute("light:materialSyncMode"), context.code, TOKEN) if is_mesh else "independent"
    if sync not in SYNC_MODES:
        message = f"found {sync}, expected one of {', '.join(SYNC_MODES)}; took {SYNC_MODES[0]}"
        context.diagnostics.warning(path, "light:materialSyncMode", message)
        sync = SYNC_MODES[0]
    try:
        light = sample_light(prim, Switches(), context.shutter)
    except Unreadable as fault:
        context.diagnostics.error(path, fault.attribute, f"{fault.message}; the light is left out")
        return 0
    _name_filters(prim, context)
    still = Motion(context.shutter, 1, True, lambda _: np.eye(4)[None])
    placed = placed_light("mesh", light, still, 0, [0.0], context.shutter.frame01)
    translator.add_light(
        name=path,
        kind="mesh",
        look=light_look(prim, "mesh", links, context),
        surface=str(geometry),
        material_sync=sync,
        normalize=bool(value(UsdLux.LightAPI(prim).GetNormalizeAttr(), context.code, BOOL)),
        **placed,
    )
    return 1


def add_lights(
    translator: Any,
    prim: Usd.Prim,
    switches: Switches,
    motion: Motion,
    context: FrameContext,
    links: Links,
    portals: Sequence[Portal] = (),
) -> int:
    """Hands a light down once for each of the motion's places, over the shutter. Returns how many: none, with
    a warning, if it is unsupported.

    `switches` turn it on or off inside the shutter; `portals` guide the sampling of a dome.
    """
    kind = SUPPORTED_LIGHTS.get(str(prim.GetTypeName()))
    path = str(prim.GetPath())
    if kind is None:
        context.diagnostics.group(path, "", _left_out(prim))
        return 0
    try:
        light = sample_light(prim, switches, context.shutter)
    except Unreadable as fault:
        context.diagnostics.error(path, fault.attribute, f"{fault.message}; the light is left out")
        return 0
    _name_filters(prim, context)
    look = light_look(prim, kind, links, context)
    turned = kind == "dome" and pole_turn(prim, context)
    frame01 = context.shutter.frame01
    if kind == "sphere" and not all(map(is_similarity, motion.at_time(frame01))):
        message = "found a transform that shears or scales unevenly; lit as the sphere of equal volume"
        context.diagnostics.group(path, "xformOpOrder", message)
    times01 = light_times01(motion, context.held)
    for index in range(motion.count):
        report_too_fast(motion.turns(index), path, context.diagnostics)
        placed = placed_light(kind, light, motion, index, times01, frame01)
        if turned:
            placed["world_from_light"] = _TOP_IS_Z @ placed["world_from_light"]
        if portals:
            placed["portals"] = placed_portals(portals, context)
        translator.add_light(name=path, kind=kind, look=look, **placed)
    return motion.count


def _name_filters(prim: Usd.Prim, context: FrameContext) -> None:
    if prim.GetRelationship("light:filters").GetTargets():
        message = "light filters are not supported yet; lit without them"
        context.diagnostics.group(str(prim.GetPath()), "light:filters", message)


def _left_out(prim: Usd.Prim) -> str:
    if prim.GetTypeName() == "PortalLight":
        return "no dome light lists it in its portals; ignored (portals only reduce noise)"
    if prim.HasAPI(UsdLux.VolumeLightAPI):
        return "volume lights (VolumeLightAPI) are not supported yet; left out"
    return f"lights of type {prim.GetTypeName() or 'none'} are not supported yet; left out"


def camera_light(times01: np.ndarray, world_from_camera: np.ndarray) -> dict:
    """usdrecord's light at the camera, for stages without lights: the translator's keywords."""
    light = {"name": "camera light", "kind": "camera", "radiance": (1.0, 1.0, 1.0)}
    sizes = {"angle_degrees": 0.0, "radius": 0.0, "width": 0.0, "height": 0.0}
    return {**light, **sizes, "times01": times01, "world_from_light": world_from_camera}
