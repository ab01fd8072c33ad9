"""Our alpha and the oracle's against the reference images beside the public scenes.

The references are another renderer's. Where its own settings change what is seen, or where nothing can be
projected, the scene is listed with the reason instead of an error.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from msbvh.output.images import read_alpha
from msbvh.scene.implicit import IMPLICIT_TYPES
from projection_oracle import Sampling, coverage
from pxr import Usd, UsdGeom
from shared_scenes import SharedScene, every_scene

BOUND = 1.3
"""Our error over the oracle's. The oracle has hardly any noise, 256 samples a pixel have some."""
SPP = 256
SAMPLING = Sampling(times=128, subpixels=4, round=True)

RENDERER_SPECIFIC = {
    "primvars:arnold:deform_keys": (None, "arnold:deform_keys decides how many keys its motion has"),
    "primvars:arnold:screen_window_min": ([(-1, -1)], "arnold:screen_window overrides the aperture"),
}
"""Attributes by which the other renderer departs from what USD says, unless they have this value."""
ARNOLD_SHAPES = {"ArnoldUsd", "ArnoldProcedural", "ArnoldAlembic", "ArnoldCurves", "ArnoldPolymesh"}


@dataclass(frozen=True)
class Comparison:
    """One scene of the other renderer's suite."""

    scene: SharedScene
    frame: float
    camera: str
    size: tuple[int, int]
    """Width and height of the reference; 0 where there is none."""
    excluded: str
    """Why the scene is not compared; empty where it is."""

    @property
    def reference(self) -> Path:
        return _reference(self.scene)

    def __str__(self) -> str:
        return self.scene.name


@dataclass(frozen=True)
class AlphaErrors:
    """Mean absolute errors of alpha over the whole image."""

    ours: float
    oracle: float

    @property
    def ratio(self) -> float:
        return self.ours / self.oracle


def comparisons() -> list[Comparison]:
    """The arnold_* scenes, in the index's order; [] without ../shared/scenes."""
    return [_comparison(scene) for scene in every_scene() if scene.name.startswith("arnold_")]


def alpha_errors(comparison: Comparison, folder: Path) -> AlphaErrors:
    """Renders a scene to `folder` and projects it. Raises RuntimeError where our renderer fails."""
    reference = read_alpha(comparison.reference)
    stage = Usd.Stage.Open(str(comparison.scene.path))
    projected = coverage(stage, comparison.frame, comparison.camera, comparison.size, SAMPLING)
    ours = _rendered(comparison, folder / f"{comparison}.exr")
    return AlphaErrors(*(float(np.abs(alpha - reference).mean()) for alpha in (ours, projected)))


def _rendered(comparison: Comparison, image: Path) -> np.ndarray:
    options = {
        "--frames": (comparison.frame,),
        "--camera": (comparison.camera,),
        "--resolution": comparison.size,
        "--conform": ("adjustApertureHeight",),
        "--spp": (SPP,),
        "--max-bounces": (0,),
    }
    flat = [str(word) for name, values in options.items() for word in (name, *values)]
    command = [sys.executable, "-m", "msbvh", "record", str(comparison.scene.path), str(image), *flat]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"{comparison}: exit code {done.returncode}: {done.stderr}")
    return read_alpha(image)


def _reference(scene: SharedScene) -> Path:
    return scene.folder / "ref" / "reference.tif"


def _comparison(scene: SharedScene) -> Comparison:
    if not _reference(scene).exists():
        return Comparison(scene, 0.0, "", (0, 0), "there is no reference image")
    alpha = read_alpha(_reference(scene))
    height, width = alpha.shape
    stage = Usd.Stage.Open(str(scene.path))
    prims = list(Usd.PrimRange.Stage(stage, Usd.TraverseInstanceProxies()))
    cameras = [str(prim.GetPath()) for prim in prims if prim.IsA(UsdGeom.Camera)]
    reasons = [
        *_reasons(prims),
        *([] if cameras else ["the stage has no camera; the reference's is elsewhere"]),
    ]
    if alpha.min() == 1.0:
        reasons.append("the reference's alpha is 1 everywhere: a dome light or a wall fills it")
    frame = float(scene.frame) if scene.frame else _first_frame(stage)
    return Comparison(scene, frame, cameras[0] if cameras else "", (width, height), "; ".join(reasons[:1]))


def _first_frame(stage: Usd.Stage) -> float:
    return stage.GetStartTimeCode() if stage.HasAuthoredTimeCodeRange() else 0.0


def _reasons(prims: list[Usd.Prim]) -> Iterator[str]:
    """Why a stage cannot be compared."""
    for prim in prims:
        for name, (harmless, reason) in RENDERER_SPECIFIC.items():
            value = prim.GetAttribute(name).Get() if prim.HasAttribute(name) else None
            if value is not None and (harmless is None or [tuple(v) for v in value] != harmless):
                yield f"{prim.GetPath()}: {reason}"
        window = prim.GetAttribute("dataWindowNDC")
        if window and tuple(window.Get()) != (0, 0, 1, 1):
            yield f"{prim.GetPath()}.dataWindowNDC: the reference is another part of the image"
        type_name = str(prim.GetTypeName())
        if type_name in ARNOLD_SHAPES:
            yield f"{prim.GetPath()}: {type_name} is Arnold's own"
        own_points = any(prim.IsA(kind) for kind in (UsdGeom.Mesh, UsdGeom.BasisCurves, UsdGeom.Points))
        drawn = own_points or type_name in IMPLICIT_TYPES
        if prim.IsA(UsdGeom.Gprim) and not drawn:
            yield f"{prim.GetPath()}: the oracle projects no {type_name}"
