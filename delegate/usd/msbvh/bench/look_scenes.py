"""Scenes that show one look each, for pictures beside another renderer's (docs/make_look_sheets.py).

All have the camera and the ground of scene_parts, and one subject in the middle; images are written beside the scene.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np
from pxr import Gf, Usd, UsdGeom, UsdLux, Vt

from .frame_scenes import FrameScene
from .looks import Look, bind, checker, set_st, write_image
from .scene_parts import FRAME, Colour, Shape, add_mesh, sheet, torus

RADIANCE = 12.0
"""Of the rectangular light."""
SKY = "sky.exr"
RADIUS = 3.0
METAL: Colour = (0.9, 0.6, 0.35)
PAINT: Colour = (0.3, 0.4, 0.6)
Fill = Callable[[Usd.Stage, float], None]


def ball(faces: int = 160) -> tuple[Shape, np.ndarray]:
    """A sphere about the z axis, with its normals: two triangles a square, none at the poles' corners."""

    def place(u: np.ndarray, v: np.ndarray) -> Sequence[np.ndarray]:
        around, up = 2 * np.pi * u, np.pi * (v - 0.5)
        return RADIUS * np.cos(up) * np.cos(around), RADIUS * np.cos(up) * np.sin(around), RADIUS * np.sin(up)

    shape = sheet(faces, place)
    corners = shape.points[shape.triangles]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    shape = Shape(shape.points, shape.triangles[area > 1e-6])
    return shape, shape.points / RADIUS


def plane() -> tuple[Shape, np.ndarray]:
    """Leans towards the camera; its coordinates, one a corner: float64[C, 2]."""

    def place(u: np.ndarray, v: np.ndarray) -> Sequence[np.ndarray]:
        return 9.0 * u - 4.5, 4.0 * v - 2.0, 5.0 * v - 2.9

    shape = sheet(1, place)
    across = np.array([(u, v) for u in (0.0, 1.0) for v in (0.0, 1.0)])
    return shape, across[shape.triangles.ravel()]


def _ball(look: Look | None, *lights: str) -> Fill:
    def fill(stage: Usd.Stage, detail: float) -> None:
        _lights(stage, lights)
        shape, normals = ball()
        mesh = add_mesh(stage, "/subject", shape, PAINT)
        mesh.CreateNormalsAttr(Vt.Vec3fArray.FromNumpy(normals))
        mesh.SetNormalsInterpolation(UsdGeom.Tokens.vertex)
        if look:
            bind(mesh, look.define(stage, "/looks/subject"))

    return fill


def _plane(look: Look, *lights: str) -> Fill:
    def fill(stage: Usd.Stage, detail: float) -> None:
        _lights(stage, lights)
        shape, st = plane()
        mesh = add_mesh(stage, "/subject", shape, PAINT)
        set_st(mesh, st)
        bind(mesh, look.define(stage, "/looks/subject"))

    return fill


def _turning(look: Look, *lights: str) -> Fill:
    """A ring that rolls by 60 degrees a frame and flies."""

    def fill(stage: Usd.Stage, detail: float) -> None:
        _lights(stage, lights)
        mesh = add_mesh(stage, "/subject", torus(96, 2.2, 0.7), METAL)
        move, turn = mesh.AddTranslateOp(), mesh.AddRotateXYZOp()
        for frame in (FRAME - 1, FRAME, FRAME + 1):
            move.Set(Gf.Vec3d(2.5 * (frame - FRAME), 0.0, 0.8), frame)
            turn.Set(Gf.Vec3f(60.0 + 60.0 * (frame - FRAME), 20.0, 0.0), frame)
        bind(mesh, look.define(stage, "/looks/subject"))

    return fill


def _lights(stage: Usd.Stage, lights: Sequence[str]) -> None:
    """Of sun, rect and sky: those that there are."""
    if "sun" not in lights:
        stage.RemovePrim("/sun")
    if "rect" in lights:
        rect = UsdLux.RectLight.Define(stage, "/rect")
        rect.CreateIntensityAttr(RADIANCE)
        rect.CreateWidthAttr(6.0)
        rect.CreateHeightAttr(4.0)
        view = Gf.Matrix4d().SetLookAt(Gf.Vec3d(-7, -7, 8), Gf.Vec3d(0, 0, -0.5), Gf.Vec3d(0, 0, 1))
        rect.AddTransformOp().Set(view.GetInverse())
    if "sky" in lights:
        dome = UsdLux.DomeLight.Define(stage, "/sky")
        dome.CreateTextureFileAttr(f"./{SKY}")
        dome.CreateTextureFormatAttr("latlong")
        dome.AddRotateXOp().Set(90.0)


def write_images(folder: Path) -> None:
    """What the scenes read."""
    write_image(folder / "checker.png", checker(512, 6))
    x, y = np.meshgrid((np.arange(256) + 0.5) / 256, (np.arange(256) + 0.5) / 256)
    slope = np.stack([0.5 * np.sin(2 * np.pi * 4 * x), 0.5 * np.sin(2 * np.pi * 3 * y), np.ones_like(x)], axis=-1)
    write_image(folder / "waves.png", 0.5 + 0.5 * slope / np.linalg.norm(slope, axis=-1, keepdims=True))
    holes = np.hypot((x * 5) % 1.0 - 0.5, (y * 4) % 1.0 - 0.5) > 0.33
    write_image(folder / "holes.png", np.repeat(holes[..., None], 3, axis=-1).astype(float))
    write_image(folder / SKY, sky(128, 64))


def sky(width: int, height: int) -> np.ndarray:
    """A bright patch, a dim one on another side, and a gradient; linear, float64[height, width, 3]."""
    x, y = np.meshgrid((np.arange(width) + 0.5) / width, (np.arange(height) + 0.5) / height)
    picture = np.stack([0.3 + 0.2 * x, 0.4 + 0.1 * y, 0.7 - 0.4 * y], axis=-1)
    for east, north, size, colour in ((0.3, 0.25, 0.07, (9.0, 7.0, 5.0)), (0.72, 0.4, 0.05, (1.0, 3.0, 6.0))):
        near = np.exp(-(((x - east) / size) ** 2 + ((y - north) / (2 * size)) ** 2))
        picture += near[..., None] * colour
    return picture


def _scene(name: str, says: str, fill: Fill, look: Look | None, sky: bool = False) -> FrameScene:
    smooth = ("subject",) if name not in PLANES else ()
    looks = {"*": None, "subject": look}
    return FrameScene(name, says, fill, 4, looks, smooth, RADIANCE, SKY if sky else "")


PLANES = ("texture", "normal map", "cutout", "moving metal")
"""Subjects without normals."""


def _scenes() -> Sequence[FrameScene]:
    metal = Look(METAL, metallic=1.0, roughness=0.3)
    rough = Look(PAINT, roughness=0.6)
    coat = Look((0.6, 0.08, 0.05), roughness=0.6, coat=1.0, coat_roughness=0.15)
    texture = Look(image="checker.png", roughness=0.7)
    waves = Look(PAINT, roughness=0.4, normal="waves.png")
    glow = Look(PAINT, roughness=0.5, emission=(0.8, 0.35, 0.1))
    cutout = Look((0.7, 0.5, 0.2), roughness=0.8, cutout="holes.png")
    return (
        _scene("diffuse", "displayColor, a sun", _ball(None, "sun"), None),
        _scene("metal", "roughness 0.3, an image dome", _ball(metal, "sky"), metal, sky=True),
        _scene("dielectric", "roughness 0.6, a rectangular light", _ball(rough, "rect"), rough),
        _scene("clear coat", "coat 1, roughness 0.15, a rectangular light", _ball(coat, "rect"), coat),
        _scene("texture", "an image of the colour, a sun", _plane(texture, "sun"), texture),
        _scene("normal map", "an image of normals, a rectangular light", _plane(waves, "rect"), waves),
        _scene("emission", "a ball that shines, a rectangular light", _ball(glow, "rect"), glow),
        _scene("image dome", "displayColor, an image dome", _ball(None, "sky"), None, sky=True),
        _scene("cutout", "an image of opacity, a threshold, a sun", _plane(cutout, "sun"), cutout),
        _scene(
            "moving metal",
            "a ring that flies, a rectangular light and a dome",
            _turning(metal, "rect", "sky"),
            metal,
            sky=True,
        ),
    )


LOOK_SCENES: Mapping[str, FrameScene] = {scene.name: scene for scene in _scenes()}
"""In the order of the sheet."""
