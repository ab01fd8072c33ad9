"""What the surfaces of `msbvh bench --frames` are: displayColor alone, or one UsdPreviewSurface on every mesh."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from pxr import Usd, UsdGeom, UsdLux

from ..stage import values
from .looks import Look, bind, checker, set_st, write_image

DISPLAY_COLOR = "displayColor"
LOOKS: Mapping[str, Look | None] = {
    DISPLAY_COLOR: None,
    "metal": Look(metallic=1.0, roughness=0.3),
    "textured": Look(image="checker.png", roughness=0.5),
}
"""Names as --looks has them. None: no material."""
DOME = 0.5
"""Radiance of the sky over surfaces that shine: a sun alone leaves nearly all of them black."""
SIDE, CELLS = 1024, 8
SCALE = 0.5
"""Of coordinates, from places."""


def dress(stage: Usd.Stage, name: str, frame: float, folder: Path) -> None:
    """Binds a look of LOOKS to every mesh, with coordinates and images where it needs them, under a plain sky."""
    look = LOOKS[name]
    if look is None:
        return
    UsdLux.DomeLight.Define(stage, "/dome").CreateIntensityAttr(DOME)
    material = look.define(stage, f"/looks/{name}")
    if look.image:
        write_image(folder / look.image, checker(SIDE, CELLS))
    for prim in stage.TraverseAll():
        if mesh := UsdGeom.Mesh(prim):
            if look.textured:
                set_st(mesh, from_above(mesh, frame))
            bind(mesh, material)


def from_above(mesh: UsdGeom.Mesh, frame: float) -> np.ndarray:
    """Coordinates by x and y, tilted so that what is upright has some too; float64[corners, 2]."""
    points = np.array(values.raw(mesh.GetPointsAttr(), frame), np.float64)
    at = points[:, :2] + points[:, 2:] * (0.31, 0.47)
    return np.asarray(SCALE * at[np.array(values.raw(mesh.GetFaceVertexIndicesAttr(), frame))])
