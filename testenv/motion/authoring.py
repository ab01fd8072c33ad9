"""What the rules' scenes are written with: the registry of rules, one camera, a few flat shapes.

Every scene looks along -z at the plane z = 0, of which the image shows 12 x 6 units (8 pixels a unit, the
origin in the middle). Shapes are a few units large and move by units within the shutter.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pxr import Gf, Usd, UsdGeom

FRAME = 10.0
SHUTTER = (-0.25, 0.5)
"""Asymmetric: a sign error does not hide."""
SIZE = (96, 48)
CAMERA = "/Camera"

Vector = tuple[float, ...]


@dataclass(frozen=True)
class Rule:
    """One rule about motion, and how its scene is written."""

    name: str
    topic: str
    """The section of rules that it belongs to."""
    statement: str
    """What a renderer does that follows the rule, in a line."""
    mistake: str
    """What a renderer does that does not; the scene is such that this is seen."""
    author: Callable[[Scene], None]
    frames: Sequence[float]
    """Rendered one after the other in one run; the last is compared."""
    stage: Mapping[str, Any]
    """Arguments of Scene."""
    slack: float
    slack_reason: str

    @property
    def camera(self) -> str:
        """The camera's path."""
        return self.stage.get("rig", "") + CAMERA

    def write(self, folder: Path, mistaken: bool = False) -> Path:
        """The scene in `folder`, or one whose plain reading is the picture of the mistake."""
        scene = Scene(folder, mistaken, **self.stage)
        self.author(scene)
        path = folder / f"{self.name}{'.mistake' if mistaken else ''}.usda"
        comment = f"{self.name}: {self.statement}. Written by make_scenes.py; edit that instead."
        if not scene.stage.GetRootLayer().Export(str(path), comment=comment):
            raise OSError(f"{path}: cannot be written")
        return path


STILL = "the frame's pose alone, without blur"
RULES: dict[str, Rule] = {}


def rule(
    topic: str,
    statement: str,
    mistake: str = STILL,
    frames: Sequence[float] = (FRAME,),
    slack: float = 0.0,
    slack_reason: str = "",
    **stage: Any,
) -> Callable[[Callable[[Scene], None]], Callable[[Scene], None]]:
    """Registers the function that writes a rule's scene under its own name."""

    def register(author: Callable[[Scene], None]) -> Callable[[Scene], None]:
        name = author.__name__
        if name in RULES:
            raise ValueError(f"two rules are called {name}")
        RULES[name] = Rule(name, topic, statement, mistake, author, frames, stage, slack, slack_reason)
        return author

    return register


class Scene:
    """A stage with a camera, and short words for what rules need."""

    def __init__(
        self,
        folder: Path,
        mistaken: bool = False,
        shutter: tuple[float, float] = SHUTTER,
        time_codes_per_second: float = 24.0,
        frames_per_second: float = 24.0,
        rig: str = "",
    ) -> None:
        """`rig`: an Xform that the camera is to stand under."""
        self.folder = folder
        self.mistaken = mistaken
        """Whether to write what a mistaken renderer would see."""
        self.stage = Usd.Stage.CreateInMemory()
        self.stage.SetTimeCodesPerSecond(time_codes_per_second)
        self.stage.SetFramesPerSecond(frames_per_second)
        self.stage.SetStartTimeCode(0)
        self.stage.SetEndTimeCode(20)
        UsdGeom.SetStageUpAxis(self.stage, UsdGeom.Tokens.y)
        UsdGeom.SetStageMetersPerUnit(self.stage, 1.0)
        if rig:
            UsdGeom.Xform.Define(self.stage, rig)
        self.camera = UsdGeom.Camera.Define(self.stage, rig + CAMERA)
        self.camera.CreateHorizontalApertureAttr(24.0)
        self.camera.CreateVerticalApertureAttr(12.0)
        self.camera.CreateFocalLengthAttr(40.0)
        self.camera.CreateClippingRangeAttr(Gf.Vec2f(0.1, 1000.0))
        self.set_shutter(*shutter)
        self.eye = self.camera.AddTranslateOp()
        self.eye.Set(Gf.Vec3d(0, 0, 20))

    def set_shutter(self, opening: float, closing: float) -> None:
        self.camera.CreateShutterOpenAttr(opening)
        self.camera.CreateShutterCloseAttr(closing)

    def polygon(self, path: str, corners: Iterable[Vector]) -> UsdGeom.Mesh:
        """One flat face; corners in the plane z = 0 where they have two coordinates."""
        points = spatial(corners)
        mesh = UsdGeom.Mesh.Define(self.stage, path)
        mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
        mesh.CreateFaceVertexCountsAttr([len(points)])
        mesh.CreateFaceVertexIndicesAttr(range(len(points)))
        mesh.CreatePointsAttr(points)
        return mesh

    def square(self, path: str, x: float = 0.0, y: float = 0.0, side: float = 1.5) -> UsdGeom.Mesh:
        """Around (x, y)."""
        return self.polygon(path, box(x, y, side, side))

    def bar(self, path: str, x: float = 0.0, y: float = 0.0) -> UsdGeom.Mesh:
        """Long and thin: shows how it turns."""
        return self.polygon(path, box(x, y, 4.4, 0.5))

    def wedge(self, path: str) -> UsdGeom.Mesh:
        """A triangle at the origin without any symmetry: shows order, sides and pivots."""
        return self.polygon(path, [(0, 0), (2, 0), (0, 1)])

    def points_between(self, mesh: UsdGeom.Mesh, offsets: Mapping[float, Vector]) -> None:
        """Time-sampled points: the mesh's own, displaced."""
        attribute = mesh.GetPointsAttr()
        own = attribute.Get()
        attribute.Clear()
        for time, offset in offsets.items():
            attribute.Set([p + Gf.Vec3f(*spatial([offset])[0]) for p in own], time)


def box(x: float, y: float, width: float, height: float) -> list[Vector]:
    """The corners of a rectangle around (x, y)."""
    w, h = width / 2, height / 2
    return [(x - w, y - h), (x + w, y - h), (x + w, y + h), (x - w, y + h)]


def spatial(vectors: Iterable[Vector]) -> list[Gf.Vec3f]:
    """Three coordinates each; z = 0 where only two are given."""
    return [Gf.Vec3f(*vector) if len(vector) == 3 else Gf.Vec3f(*vector, 0.0) for vector in vectors]


def samples(target: Any, values: Mapping[float, Any]) -> None:
    """Time samples of an attribute or xformOp."""
    for time, value in values.items():
        target.Set(value, time)


def slide(prim: Any, places: Mapping[float, Vector]) -> UsdGeom.XformOp:
    """A translate op with time samples."""
    operation = UsdGeom.Xformable(prim).AddTranslateOp()
    samples(operation, {time: Gf.Vec3d(*place[:2], *(place[2:] or (0.0,))) for time, place in places.items()})
    return operation


def turn(prim: Any, degrees: Mapping[float, float]) -> UsdGeom.XformOp:
    """A rotateZ op with time samples."""
    operation = UsdGeom.Xformable(prim).AddRotateZOp()
    samples(operation, degrees)
    return operation


def place(prim: Any, x: float, y: float, z: float = 0.0) -> UsdGeom.XformOp:
    """A still translate op."""
    operation = UsdGeom.Xformable(prim).AddTranslateOp()
    operation.Set(Gf.Vec3d(x, y, z))
    return operation
