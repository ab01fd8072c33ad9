"""Frames of small scenes in which one prim is bad: read, rendered, and looked at."""

from __future__ import annotations

from typing import Any

import numpy as np
from msbvh import _core
from msbvh.scene.reader import ReadResult, ReadSettings, read_frame
from pxr import Sdf, Usd

WIDTH, HEIGHT = 32, 18

CAMERA = """
def Camera "Cam" {
    double3 xformOp:translate = (0, 0, 20)
    uniform token[] xformOpOrder = ["xformOp:translate"]
    double shutter:open = -0.5
    double shutter:close = 0.5
}
"""
GOOD = """
def Mesh "Good" {
    int[] faceVertexCounts = [4]
    int[] faceVertexIndices = [0, 1, 2, 3]
    point3f[] points = [(1, -3, 0), (7, -3, 0), (7, 3, 0), (1, 3, 0)]
    uniform token subdivisionScheme = "none"
}
"""
"""A square in the right half of the picture."""


def stage_of(text: str, header: str = "") -> Usd.Stage:
    """A stage from USD's text format, without the first line."""
    layer = Sdf.Layer.CreateAnonymous(".usda")
    layer.ImportFromString(f"#usda 1.0\n{header}\n{text}")
    return Usd.Stage.Open(layer)


def retype(prim: Usd.Prim, name: str, kind: Sdf.ValueTypeName, value: Any) -> None:
    """Authors an attribute with another type than its schema's."""
    spec = prim.GetStage().GetRootLayer().GetPrimAtPath(prim.GetPath())
    if name in spec.properties:
        del spec.properties[name]
    Sdf.AttributeSpec(spec, name, kind).default = value


def render(stage: Usd.Stage, frame: float | None = 1.0, **settings: Any) -> tuple[ReadResult, np.ndarray]:
    """The frame as it was read, and its pixels, float32[HEIGHT, WIDTH, 4]."""
    result = read_frame(stage, frame, ReadSettings(width=WIDTH, height=HEIGHT, **settings))
    renderer = _core.Renderer(result.scene, width=result.camera.width, height=result.camera.height, spp=1, threads=1)
    return result, renderer.render()


def shows_good(pixels: np.ndarray) -> bool:
    """Whether the sound square is drawn, and every pixel is a number."""
    assert np.isfinite(pixels).all()
    return bool((pixels[7:11, 20:23, 3] == 1.0).all())


def messages(result: ReadResult) -> list[str]:
    """What was said beyond notes."""
    return [str(d) for d in result.diagnostics if d.severity != "note"]
