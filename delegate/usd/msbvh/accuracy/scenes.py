"""The scenes that `msbvh accuracy` looks at where it is given none: kinds of motion and of shape, each with its own weak point.

Written as USD by a generator, seeded. They stand in the setting of the frame benchmark: its camera, shutter, sun and ground.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom, UsdShade, UsdSkel, Vt

from ..bench.scene_parts import FRAME, add_mesh, faces_for, setting, sheet, torus

FRAMES_AFTER = 3
"""On each stage, for what is kept from frame to frame."""
STEPS = 8
"""Time samples a frame of what deforms."""
TYPES = Sdf.ValueTypeNames


@dataclass(frozen=True)
class BuiltIn:
    """A scene of the built-in set."""

    name: str
    says: str
    fill: Callable[[Usd.Stage, float], None]
    """Defines its prims; the second argument scales how many there are: 1 is what is published."""

    def write(self, path: Path, detail: float = 1.0) -> None:
        path.unlink(missing_ok=True)
        stage = Usd.Stage.CreateNew(str(path))
        setting(stage)
        stage.SetEndTimeCode(FRAME + FRAMES_AFTER)
        self.fill(stage, detail)
        stage.GetRootLayer().Save()


def _times() -> np.ndarray:
    """Of samples, over all frames and half a frame more on either side, so that every shutter is covered."""
    return np.arange(-STEPS, (FRAMES_AFTER + 1) * STEPS + 1) / STEPS + FRAME


def _rotor(stage: Usd.Stage, detail: float) -> None:
    """Six blades, and a ring that none of them touches, at 200 degrees a frame."""
    turn = UsdGeom.Xform.Define(stage, "/rotor").AddRotateZOp()
    for frame in (FRAME - 1, FRAME + FRAMES_AFTER + 1):
        turn.Set(200.0 * frame, frame)

    def place(u: np.ndarray, v: np.ndarray) -> list[np.ndarray]:
        around, width = 2 * np.pi * v, 1.0 - 0.5 * u
        return [0.8 + 4.7 * u, 0.7 * width * np.cos(around), 0.12 * width * np.sin(around) + 0.2 * np.sin(6.0 * u)]

    blade = sheet(faces_for(60, detail), place)
    for k in range(6):
        add_mesh(stage, f"/rotor/blade_{k}", blade, (0.8, 0.3 + 0.08 * k, 0.2)).AddRotateZOp().Set(60.0 * k)
    add_mesh(stage, "/rotor/hub", torus(faces_for(30, detail), 0.6, 0.3), (0.3, 0.3, 0.35))


def _debris(stage: Usd.Stage, detail: float) -> None:
    """A burst: instances with velocities, accelerations and turns; the stage says nothing of any other frame."""
    random = np.random.default_rng(3)
    count = max(24, round(1200 * detail))
    instancer = UsdGeom.PointInstancer.Define(stage, "/burst")
    paths = [f"/burst/pieces/piece_{k}" for k in range(3)]
    for k, path in enumerate(paths):
        piece = torus(faces_for(8, detail, least=4), 0.25, 0.1 + 0.04 * k)
        add_mesh(stage, path, piece, (0.75, 0.35 + 0.15 * k, 0.2))
    instancer.CreatePrototypesRel().SetTargets([Sdf.Path(path) for path in paths])
    ways = random.normal(size=(count, 3))
    ways[:, 2] = np.abs(ways[:, 2])
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    speeds = random.uniform(2.0, 30.0, (count, 1))
    positions = ways * random.uniform(0.5, 5.0, (count, 1)) - (0, 0, 2)
    arrays = {
        instancer.CreatePositionsAttr(): positions,
        instancer.CreateVelocitiesAttr(): ways * speeds,
        instancer.CreateAccelerationsAttr(): random.normal(0.0, 120.0, (count, 3)),
        instancer.CreateAngularVelocitiesAttr(): random.normal(0.0, 1500.0, (count, 3)),
    }
    for attribute, values in arrays.items():
        attribute.Set(Vt.Vec3fArray.FromNumpy(values.astype(np.float32)), FRAME)
    instancer.CreateOrientationsAttr().Set(Vt.QuathArray([Gf.Quath(1)] * count), FRAME)
    instancer.CreateProtoIndicesAttr(Vt.IntArray.FromNumpy((np.arange(count) % 3).astype(np.int32)))


def _character(stage: Usd.Stage, detail: float) -> None:
    """Five arms of six joints that whip about: linear blend skinning of a subdivided cage."""
    for arm in range(5):
        _arm(stage, f"/arms/arm_{arm}", arm, detail)


def _arm(stage: Usd.Stage, path: str, arm: int, detail: float) -> None:
    joints, length = 6, 1.0
    root = UsdSkel.Root.Define(stage, path)
    root.AddTranslateOp().Set(Gf.Vec3d(2.4 * (arm - 2), 0.0, -2.8))
    names = ["/".join(f"j{k}" for k in range(n + 1)) for n in range(joints)]
    rest = [Gf.Matrix4d().SetTranslate(Gf.Vec3d(0, 0, length if k else 0.0)) for k in range(joints)]
    bind = [Gf.Matrix4d().SetTranslate(Gf.Vec3d(0, 0, length * k)) for k in range(joints)]
    skeleton = UsdSkel.Skeleton.Define(stage, f"{path}/skeleton")
    skeleton.CreateJointsAttr(names)
    skeleton.CreateRestTransformsAttr(rest)
    skeleton.CreateBindTransformsAttr(bind)
    animation = UsdSkel.Animation.Define(stage, f"{path}/skeleton/animation")
    animation.CreateJointsAttr(names)
    animation.CreateTranslationsAttr([Gf.Vec3f(matrix.ExtractTranslation()) for matrix in rest])
    animation.CreateScalesAttr([Gf.Vec3h(1, 1, 1)] * joints)
    rotations = animation.CreateRotationsAttr()
    for time in _times()[::2]:
        angles = [22.0 * np.sin(2.6 * time + 0.9 * k + arm) for k in range(joints)]
        axis = Gf.Vec3d(np.cos(arm), np.sin(arm), 0.0)
        rotations.Set(Vt.QuatfArray([Gf.Quatf(Gf.Rotation(axis, angle).GetQuat()) for angle in angles]), float(time))
    faces = faces_for(14, detail)

    def place(u: np.ndarray, v: np.ndarray) -> list[np.ndarray]:
        around, radius = 2 * np.pi * v, 0.5 - 0.3 * u
        return [radius * np.cos(around), radius * np.sin(around), joints * length * u]

    skin, points = _quads(stage, f"{path}/skin", faces, place, (0.8, 0.55 - 0.05 * arm, 0.4 + 0.08 * arm), closed=True)
    heights = points[:, 2] / length
    first = np.clip(np.floor(heights).astype(np.int32), 0, joints - 1)
    second, share = np.minimum(first + 1, joints - 1), np.clip(heights - first, 0.0, 1.0)
    binding = UsdSkel.BindingAPI.Apply(skin.GetPrim())
    binding.CreateSkeletonRel().SetTargets([skeleton.GetPath()])
    indices = np.stack([first, second], axis=1).astype(np.int32).ravel()
    weights = np.stack([1.0 - share, share], axis=1).astype(np.float32).ravel()
    binding.CreateJointIndicesPrimvar(False, 2).Set(Vt.IntArray.FromNumpy(indices))
    binding.CreateJointWeightsPrimvar(False, 2).Set(Vt.FloatArray.FromNumpy(weights))
    UsdSkel.BindingAPI.Apply(skeleton.GetPrim()).CreateAnimationSourceRel().SetTargets([animation.GetPath()])


def _quads(
    stage: Usd.Stage,
    path: str,
    faces: int,
    place: Callable[[np.ndarray, np.ndarray], list[np.ndarray]],
    colour: tuple[float, float, float],
    closed: bool = False,
) -> tuple[UsdGeom.Mesh, np.ndarray]:
    """A catmullClark cage of `faces` x `faces` quads over [0, 1] x [0, 1], and its points, float32[N, 3]; closed: v = 0 and v = 1
    are the same points."""
    columns = faces if closed else faces + 1
    u, v = np.meshgrid(np.linspace(0, 1, faces + 1), np.arange(columns) / faces, indexing="ij")
    points = np.stack(place(u, v), axis=-1).reshape(-1, 3).astype(np.float32)
    row, column = (part.ravel() for part in np.meshgrid(np.arange(faces), np.arange(faces), indexing="ij"))
    beside = (column + 1) % columns
    corners = [
        row * columns + column,
        (row + 1) * columns + column,
        (row + 1) * columns + beside,
        row * columns + beside,
    ]
    mesh = UsdGeom.Mesh.Define(stage, path)
    mesh.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(points))
    mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(np.stack(corners, axis=1).astype(np.int32).ravel()))
    mesh.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(np.full(faces * faces, 4, np.int32)))
    mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.catmullClark)
    mesh.CreateDisplayColorAttr([Gf.Vec3f(*colour)])
    mesh.CreateDoubleSidedAttr(True)
    return mesh, points


def _hair(stage: Usd.Stage, detail: float) -> None:
    """Four thousand hairs on a head that shakes about its axis: the further out, the later, by samples of the points."""
    random = np.random.default_rng(4)
    count, controls = max(64, round(4000 * detail)), 8
    ways = random.normal(size=(count, 3))
    ways[:, 2] = np.abs(ways[:, 2]) * 1.2 - 0.3
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    curl = random.uniform(0.0, 2 * np.pi, (count, 1))
    along = np.linspace(0.0, 1.0, controls)[None, :]
    curves = UsdGeom.BasisCurves.Define(stage, "/head/hair")
    curves.CreateTypeAttr(UsdGeom.Tokens.cubic)
    curves.CreateBasisAttr(UsdGeom.Tokens.bspline)
    curves.CreateWrapAttr(UsdGeom.Tokens.pinned)
    curves.CreateCurveVertexCountsAttr(Vt.IntArray.FromNumpy(np.full(count, controls, np.int32)))
    widths = np.tile(np.linspace(0.05, 0.01, controls), count).astype(np.float32)
    curves.CreateWidthsAttr(Vt.FloatArray.FromNumpy(widths))
    curves.SetWidthsInterpolation(UsdGeom.Tokens.vertex)
    curves.CreateDisplayColorAttr([Gf.Vec3f(0.45, 0.28, 0.15)])
    points = curves.CreatePointsAttr()
    for time in _times():
        at = ways[:, None, :] * (2.0 + 2.6 * along)[..., None]
        at[..., 0] += 0.25 * along * np.sin(9.0 * along + curl)
        at[..., 1] += 0.25 * along * np.cos(9.0 * along + curl)
        at[..., 2] -= 1.5 * along**2
        angle = 0.35 * np.sin(5.0 * time - 1.1 * along)
        turned = np.cos(angle) * at[..., 0] - np.sin(angle) * at[..., 1]
        at[..., 1] = np.sin(angle) * at[..., 0] + np.cos(angle) * at[..., 1]
        at[..., 0] = turned
        points.Set(Vt.Vec3fArray.FromNumpy(at.reshape(-1, 3).astype(np.float32)), float(time))
    ball = UsdGeom.Sphere.Define(stage, "/head/skull")
    ball.CreateRadiusAttr(2.0)
    ball.CreateDisplayColorAttr([Gf.Vec3f(0.8, 0.6, 0.5)])
    turn = ball.AddRotateZOp()
    for time in _times():
        turn.Set(float(np.degrees(0.35 * np.sin(5.0 * time))), float(time))


def _displaced(stage: Usd.Stage, detail: float) -> None:
    """A subdivided ball with spikes by displacement that turns and swells."""
    material = UsdShade.Material.Define(stage, "/look")
    surface = UsdShade.Shader.Define(stage, "/look/surface")
    surface.CreateIdAttr("UsdPreviewSurface")
    surface.CreateInput("diffuseColor", TYPES.Color3f).Set(Gf.Vec3f(0.3, 0.6, 0.75))
    reader = UsdShade.Shader.Define(stage, "/look/height")
    reader.CreateIdAttr("UsdPrimvarReader_float")
    reader.CreateInput("varname", TYPES.String).Set("height")
    surface.CreateInput("displacement", TYPES.Float).ConnectToSource(reader.CreateOutput("result", TYPES.Float))
    material.CreateSurfaceOutput().ConnectToSource(surface.ConnectableAPI(), "surface")
    material.CreateDisplacementOutput().ConnectToSource(surface.ConnectableAPI(), "displacement")
    faces = faces_for(36, detail)

    def place(u: np.ndarray, v: np.ndarray) -> list[np.ndarray]:
        tilt, around = np.pi * (0.02 + 0.96 * u), 2 * np.pi * v
        return [3.2 * np.sin(tilt) * np.cos(around), 3.2 * np.sin(tilt) * np.sin(around), 3.2 * np.cos(tilt)]

    ball, points = _quads(stage, "/ball", faces, place, (0.3, 0.6, 0.75), closed=True)
    UsdShade.MaterialBindingAPI.Apply(ball.GetPrim()).Bind(material)
    waves = np.sin(5.0 * points[:, 0]) * np.sin(5.0 * points[:, 1]) * np.sin(5.0 * points[:, 2])
    UsdGeom.PrimvarsAPI(ball).CreatePrimvar("height", TYPES.FloatArray, UsdGeom.Tokens.vertex).Set(
        Vt.FloatArray.FromNumpy((0.6 * waves).astype(np.float32))
    )
    for time in _times():
        swell = 1.0 + 0.12 * np.sin(5.0 * time + 2.0 * points[:, 2:])
        ball.GetPointsAttr().Set(Vt.Vec3fArray.FromNumpy((points * swell).astype(np.float32)), float(time))
    turn = ball.AddRotateZOp()
    for frame in (FRAME - 1, FRAME + FRAMES_AFTER + 1):
        turn.Set(90.0 * frame, frame)


_SCENES = (
    BuiltIn("rotor", "six rigid blades at 200 degrees a frame", _rotor),
    BuiltIn("debris", "1200 instances thrown apart, by velocities, accelerations and angular velocities", _debris),
    BuiltIn("character", "five skinned arms, subdivided, that whip about", _character),
    BuiltIn("hair", "four thousand hairs on a head that shakes", _hair),
    BuiltIn("displaced", "a subdivided, displaced ball that turns and swells", _displaced),
)

SCENES: Mapping[str, BuiltIn] = {scene.name: scene for scene in _SCENES}
"""In the order of the report."""
