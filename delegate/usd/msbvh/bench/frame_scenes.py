"""The scenes of `msbvh bench --frames`: five kinds of motion, made by a generator and written as USD.

Only what every renderer can read: triangles of constant displayColor without normals, one camera with an open shutter,
one normalised distant light, native instances, xformOps and points with time samples. Nothing else may decide a
comparison: no quads (whose diagonal is a renderer's own choice), no velocities, no sky, no materials but those of frame_looks.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom, Vt

from .frame_looks import DISPLAY_COLOR, DOME, LOOKS, dress
from .looks import Look
from .scene_parts import FRAME, Shape, add_mesh, faces_for, setting, sheet, torus

SAMPLES_PER_FRAME = 8
"""Of deforming points: as many as make linear steps between them small beside the motion."""


@dataclass(frozen=True)
class FrameScene:
    """A scene of the benchmark."""

    name: str
    says: str
    """What moves in it, for reports."""
    fill: Callable[[Usd.Stage, float], None]
    """Defines its prims below the stage's root; the second argument scales how many faces a side has."""
    motion_steps: int
    """Cycles takes 2^n intervals over the shutter: the smallest n whose picture is that of a larger one."""
    looks: Mapping[str, Look | None] = field(default_factory=lambda: {"*": None})
    """Of meshes by name, or "*"; None: displayColor alone."""
    smooth: Sequence[str] = ()
    """Meshes with normals."""
    radiance: float = 0.0
    """Of its rectangular lights."""
    sky: str = ""
    """The image of its dome."""
    dome: float = 0.0
    """Radiance of a plain sky."""
    look: str = DISPLAY_COLOR
    """Of LOOKS: what every mesh has."""

    @property
    def title(self) -> str:
        """Of files."""
        return self.name if self.look == DISPLAY_COLOR else f"{self.name}-{self.look}"

    def dressed(self, look: str) -> FrameScene:
        """With one of LOOKS on every mesh."""
        return replace(self, looks={"*": LOOKS[look]}, look=look, dome=DOME if LOOKS[look] else 0.0)

    def write(self, path: Path, detail: float = 1.0) -> None:
        """Writes the scene. `detail` 1 is what is published; less is smaller, for tests."""
        stage = Usd.Stage.CreateNew(str(path))
        setting(stage)
        self.fill(stage, detail)
        dress(stage, self.look, FRAME, path.parent)
        stage.GetRootLayer().Save()


def _blade(faces: int) -> Shape:
    def place(u: np.ndarray, v: np.ndarray) -> Sequence[np.ndarray]:
        width, around = 1.0 - 0.5 * u, 2 * np.pi * v
        wave = 0.3 * np.sin(9.0 * u)
        return 1.0 + 5.0 * u, 0.8 * width * np.cos(around), 0.15 * width * np.sin(around) + wave

    return sheet(faces, place)


def _rotor(stage: Usd.Stage, detail: float) -> None:
    """Eight blades that turn by 72 degrees a frame."""
    turn = UsdGeom.Xform.Define(stage, "/rotor").AddRotateZOp()
    for frame in (FRAME - 1, FRAME + 1):
        turn.Set(72.0 * frame, frame)
    shape = _blade(faces_for(80, detail))
    for k in range(8):
        blade = add_mesh(stage, f"/rotor/blade_{k}", shape, (0.8, 0.3 + 0.05 * k, 0.2))
        blade.AddRotateZOp().Set(45.0 * k)


def _cloth(stage: Usd.Stage, detail: float) -> None:
    """Waves that run through a sheet; new points every eighth of a frame."""

    def at(frame: float) -> Shape:
        def place(u: np.ndarray, v: np.ndarray) -> Sequence[np.ndarray]:
            height = 1.2 * np.sin(6.0 * u + 3.0 * v + 2.5 * frame) + 0.5 * np.sin(17.0 * v - 4.0 * frame)
            return 10.0 * u - 5.0, 10.0 * v - 5.0, height

        return sheet(faces_for(220, detail), place)

    mesh = add_mesh(stage, "/cloth", at(FRAME), (0.3, 0.5, 0.8))
    for k in range(-SAMPLES_PER_FRAME, SAMPLES_PER_FRAME + 1):
        frame = FRAME + k / SAMPLES_PER_FRAME
        mesh.GetPointsAttr().Set(Vt.Vec3fArray.FromNumpy(at(frame).points), frame)


def _tumble(prim: UsdGeom.Xformable, random: np.random.Generator, reach: Sequence[float], speed: float) -> None:
    """Flies and turns at constant speeds. `reach`: half the box that it starts in; `speed`: units a frame, at most."""
    start, along = random.uniform(-1, 1, 3) * reach, random.uniform(-1, 1, 3) * speed
    turn = random.uniform(-180, 180, 3)
    move, rotate = prim.AddTranslateOp(), prim.AddRotateXYZOp()
    for frame in (FRAME - 1, FRAME, FRAME + 1):
        move.Set(Gf.Vec3d(*(start + along * (frame - FRAME))), frame)
        rotate.Set(Gf.Vec3f(*(turn * frame)), frame)


def _parts(stage: Usd.Stage, detail: float) -> None:
    """Two thousand small meshes, each with a transform of its own."""
    random = np.random.default_rng(1)
    shape = torus(faces_for(7, detail, least=3), 0.3, 0.12)
    for k in range(_count(2000, detail)):
        red, green, blue = random.uniform(0.2, 0.9, 3).tolist()
        mesh = add_mesh(stage, f"/parts/part_{k}", shape, (red, green, blue))
        _tumble(mesh, random, (7.0, 7.0, 3.0), 0.5)


def _crowd(stage: Usd.Stage, detail: float) -> None:
    """Three thousand native instances of three prototypes."""
    random = np.random.default_rng(2)
    prototypes = ("/prototypes/thin", "/prototypes/round", "/prototypes/thick")
    stage.CreateClassPrim("/prototypes")
    for k, path in enumerate(prototypes):
        UsdGeom.Xform.Define(stage, path)
        add_mesh(stage, f"{path}/mesh", torus(faces_for(40, detail), 0.4, 0.1 + 0.05 * k), (0.3 + 0.2 * k, 0.6, 0.4))
    for k in range(_count(3000, detail)):
        instance = UsdGeom.Xform.Define(stage, f"/crowd/one_{k}")
        instance.GetPrim().GetReferences().AddInternalReference(Sdf.Path(prototypes[k % 3]))
        instance.GetPrim().SetInstanceable(True)
        _tumble(instance, random, (9.0, 9.0, 3.0), 0.5)


def _still(stage: Usd.Stage, detail: float) -> None:
    """Twelve rings; nothing moves."""
    shape = torus(faces_for(90, detail), 1.2, 0.5)
    for k in range(12):
        mesh = add_mesh(stage, f"/set/ring_{k}", shape, (0.7, 0.2 + 0.05 * k, 0.5))
        column, row = k % 4, k // 4
        mesh.AddTranslateOp().Set(Gf.Vec3d((column - 1.5) * 3.0, (row - 1) * 3.0, (row - 1) * 1.5))
        mesh.AddRotateXYZOp().Set(Gf.Vec3f(20.0 * k, 0.0, 35.0 * k))


def _count(full: int, detail: float) -> int:
    return max(24, round(full * detail))


_SCENES = (
    FrameScene("rotor", "eight rigid blades on a turning hub", _rotor, 1),
    FrameScene("cloth", "one sheet whose points deform", _cloth, 2),
    FrameScene("parts", "two thousand meshes that fly and tumble", _parts, 2),
    FrameScene("crowd", "three thousand instances that fly and tumble", _crowd, 2),
    FrameScene("still", "a set that stands still", _still, 1),
)

SCENES: Mapping[str, FrameScene] = {scene.name: scene for scene in _SCENES}
"""In the order of the report."""
