"""Blades that turn any number of times within the shutter, by every source of rotation, and where they truly are."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from pxr import Gf, Sdf, Ts, Usd, UsdGeom, UsdSkel, Vt

FRAME, SHUTTER = 1.0, (-0.25, 0.25)
OPEN, LENGTH = FRAME + SHUTTER[0], SHUTTER[1] - SHUTTER[0]
RADIUS, HALF_WIDTH = 5.0, 0.4
BLADE = ((0.0, -HALF_WIDTH, 0.0), (RADIUS, -HALF_WIDTH, 0.0), (RADIUS, HALF_WIDTH, 0.0), (0.0, HALF_WIDTH, 0.0))
DISTANCE = 20.0
DOUBLE = UsdGeom.XformOp.PrecisionDouble


def pixels_per_unit(width: int) -> float:
    """At the blade, in front of the camera of new_stage()."""
    return width / (36.0 / 50.0 * DISTANCE)


def new_stage() -> Usd.Stage:
    stage = Usd.Stage.CreateInMemory()
    stage.SetTimeCodesPerSecond(24.0)
    camera = UsdGeom.Camera.Define(stage, "/cam")
    camera.AddTranslateOp().Set(Gf.Vec3d(0, 0, DISTANCE))
    camera.CreateShutterOpenAttr(SHUTTER[0])
    camera.CreateShutterCloseAttr(SHUTTER[1])
    camera.CreateFocalLengthAttr(50.0)
    camera.CreateHorizontalApertureAttr(36.0)
    camera.CreateVerticalApertureAttr(24.0)
    return stage


def blade(stage: Usd.Stage, path: str = "/blade") -> UsdGeom.Mesh:
    mesh = UsdGeom.Mesh.Define(stage, path)
    mesh.CreateSubdivisionSchemeAttr("none")
    mesh.CreateFaceVertexCountsAttr([4])
    mesh.CreateFaceVertexIndicesAttr([0, 1, 2, 3])
    mesh.CreatePointsAttr([Gf.Vec3f(*point) for point in BLADE])
    return mesh


def turn(xformable: UsdGeom.Xformable, turns: float) -> None:
    """Two samples far outside the shutter, `turns` within it."""
    degrees = 360.0 * turns / LENGTH
    op = xformable.AddRotateZOp(DOUBLE)
    op.Set(0.0, 0.0)
    op.Set(2.0 * degrees, 2.0)


def by_op(turns: float) -> Usd.Stage:
    stage = new_stage()
    turn(blade(stage), turns)
    return stage


def by_three_angles(turns: float) -> Usd.Stage:
    stage = new_stage()
    op = blade(stage).AddRotateXYZOp(DOUBLE)
    op.Set(Gf.Vec3d(0.0), 0.0)
    op.Set(Gf.Vec3d(0.0, 0.0, 720.0 * turns / LENGTH), 2.0)
    return stage


def by_parent(turns: float) -> Usd.Stage:
    stage = new_stage()
    turn(UsdGeom.Xform.Define(stage, "/hub"), turns)
    blade(stage, "/hub/blade")
    return stage


def by_two_parents(turns: float) -> Usd.Stage:
    """Each turns half as often."""
    stage = new_stage()
    for path in ("/hub", "/hub/hub"):
        turn(UsdGeom.Xform.Define(stage, path), turns / 2.0)
    blade(stage, "/hub/hub/blade")
    return stage


def _spline(knots: list[tuple[float, float]], interpolation: Ts.InterpMode) -> Ts.Spline:
    spline = Ts.Spline("double")
    for time, value in knots:
        knot = Ts.Knot("double")
        knot.SetTime(time)
        knot.SetValue(value)
        knot.SetNextInterpolation(interpolation)
        knot.SetPreTanWidth(0.1)
        knot.SetPostTanWidth(0.1)
        spline.SetKnot(knot)
    return spline


def by_spline(turns: float) -> Usd.Stage:
    stage = new_stage()
    op = blade(stage).AddRotateZOp(DOUBLE)
    op.GetAttr().SetSpline(_spline([(0.0, 0.0), (2.0, 720.0 * turns / LENGTH)], Ts.InterpLinear))
    return stage


def by_looping_spline(turns: float) -> Usd.Stage:
    """One turn, over and over."""
    if turns == 0.0:
        return by_spline(0.0)
    stage = new_stage()
    spline = _spline([(0.0, 0.0), (LENGTH / turns, 360.0)], Ts.InterpLinear)
    spline.SetPostExtrapolation(Ts.Extrapolation(Ts.ExtrapLoopRepeat))
    blade(stage).AddRotateZOp(DOUBLE).GetAttr().SetSpline(spline)
    return stage


def by_eased_spline(turns: float) -> Usd.Stage:
    """Slow, fast and slow again: no period."""
    stage = new_stage()
    op = blade(stage).AddRotateZOp(DOUBLE)
    op.GetAttr().SetSpline(_spline([(OPEN, 0.0), (OPEN + LENGTH, 360.0 * turns)], Ts.InterpCurve))
    return stage


def by_angular_velocity(turns: float) -> Usd.Stage:
    stage = new_stage()
    instancer = UsdGeom.PointInstancer.Define(stage, "/instancer")
    instancer.CreatePositionsAttr().Set([Gf.Vec3f(0)], FRAME)
    instancer.CreateOrientationsfAttr().Set([Gf.Quatf(1, 0, 0, 0)], FRAME)
    rate = 360.0 * turns / LENGTH * stage.GetTimeCodesPerSecond()
    instancer.CreateAngularVelocitiesAttr().Set([Gf.Vec3f(0, 0, rate)], FRAME)
    instancer.CreateProtoIndicesAttr([0])
    blade(stage, "/instancer/blade")
    instancer.CreatePrototypesRel().AddTarget("/instancer/blade")
    return stage


def by_native_instance(turns: float) -> Usd.Stage:
    """The blade turns inside of what is instanced."""
    stage = new_stage()
    stage.CreateClassPrim("/rotor")
    turn(blade(stage, "/rotor/blade"), turns)
    instance = UsdGeom.Xform.Define(stage, "/instance").GetPrim()
    instance.GetReferences().AddInternalReference("/rotor")
    instance.SetInstanceable(True)
    return stage


def by_turning_instances(turns: float) -> Usd.Stage:
    """Native instances turn, this one beside others at other rates (out of sight)."""
    stage = new_stage()
    stage.CreateClassPrim("/rotor")
    blade(stage, "/rotor/blade")
    for index, rate in enumerate((turns, 0.3 * turns, 7.0)):
        instance = UsdGeom.Xform.Define(stage, f"/instance{index}")
        instance.AddTranslateOp().Set(Gf.Vec3d(0, 0, 1000 * index))
        turn(instance, rate)
        instance.GetPrim().GetReferences().AddInternalReference("/rotor")
        instance.GetPrim().SetInstanceable(True)
    return stage


def by_skeleton(turns: float) -> Usd.Stage:
    """One joint; its samples are a third of a turn apart, since joints turn along the shorter arc."""
    stage = new_stage()
    UsdSkel.Root.Define(stage, "/root")
    skeleton = UsdSkel.Skeleton.Define(stage, "/root/skeleton")
    identity = Vt.Matrix4dArray([Gf.Matrix4d(1.0)])
    skeleton.CreateJointsAttr(["joint"])
    skeleton.CreateBindTransformsAttr(identity)
    skeleton.CreateRestTransformsAttr(identity)
    animation = UsdSkel.Animation.Define(stage, "/root/animation")
    animation.CreateJointsAttr(["joint"])
    animation.CreateTranslationsAttr([Gf.Vec3f(0)])
    animation.CreateScalesAttr([Gf.Vec3h(1)])
    steps = int(np.ceil(3.0 * turns)) or 1
    for step in range(steps + 1):
        angle = 360.0 * turns * step / steps
        rotation = Gf.Quatf(Gf.Rotation(Gf.Vec3d(0, 0, 1), angle).GetQuat())
        animation.CreateRotationsAttr().Set(Vt.QuatfArray([rotation]), OPEN + LENGTH * step / steps)
    UsdSkel.BindingAPI.Apply(skeleton.GetPrim()).CreateAnimationSourceRel().AddTarget("/root/animation")
    mesh = blade(stage, "/root/blade")
    binding = UsdSkel.BindingAPI.Apply(mesh.GetPrim())
    binding.CreateSkeletonRel().AddTarget("/root/skeleton")
    binding.CreateJointIndicesPrimvar(False, 1).Set(Vt.IntArray([0] * 4))
    binding.CreateJointWeightsPrimvar(False, 1).Set(Vt.FloatArray([1.0] * 4))
    return stage


def on_the_way(turns: float) -> Usd.Stage:
    """It flies while it turns: no period."""
    stage = new_stage()
    mesh = blade(stage)
    move = mesh.AddTranslateOp()
    move.Set(Gf.Vec3d(-4, 0, 0), 0.0)
    move.Set(Gf.Vec3d(4, 0, 0), 2.0)
    turn(mesh, turns)
    return stage


def while_it_grows(turns: float) -> Usd.Stage:
    """Its points change beneath the turn."""
    stage = new_stage()
    mesh = blade(stage)
    turn(mesh, turns)
    for time, width in ((0.0, 1.0), (2.0, 1.5)):
        mesh.GetPointsAttr().Set([Gf.Vec3f(x, width * y, z) for x, y, z in BLADE], time)
    return stage


def by_camera_roll(turns: float) -> Usd.Stage:
    stage = new_stage()
    blade(stage)
    turn(UsdGeom.Camera.Get(stage, "/cam"), turns)
    return stage


@dataclass(frozen=True)
class Source:
    """How a blade turns."""

    stage: Callable[[float], Usd.Stage]
    periodic: bool
    """It repeats, so that a track of few segments can follow any number of turns."""

    @property
    def name(self) -> str:
        return self.stage.__name__


SOURCES = [
    *(
        Source(stage, True)
        for stage in (
            by_op, by_three_angles, by_parent, by_two_parents, by_spline, by_looping_spline, by_angular_velocity,
            by_native_instance, by_turning_instances,
        )
    ),
    *(Source(stage, False) for stage in (by_eased_spline, by_skeleton, on_the_way, while_it_grows)),
]  # fmt: skip


def true_points(stage: Usd.Stage, time01: float) -> np.ndarray:
    """float64[4, 3]: the blade's corners in the world by usd-core's own evaluation."""
    time = OPEN + LENGTH * time01
    prim = next(p for p in Usd.PrimRange.Stage(stage, Usd.TraverseInstanceProxies()) if p.GetName() == "blade")
    points = np.array(UsdGeom.Mesh(prim).GetPointsAttr().Get(time), np.float64)
    instancer = UsdGeom.PointInstancer(stage.GetPrimAtPath("/instancer"))
    if instancer:
        matrix = np.array(instancer.ComputeInstanceTransformsAtTime(time, FRAME)[0])
    elif stage.GetPrimAtPath("/root"):
        cache = UsdSkel.Cache()
        root = UsdSkel.Root.Get(stage, Sdf.Path("/root"))
        cache.Populate(root, Usd.PrimDefaultPredicate)
        query = cache.GetSkelQuery(UsdSkel.Skeleton.Get(stage, "/root/skeleton"))
        matrix = np.array(query.ComputeSkinningTransforms(time)[0])
    else:
        matrix = np.array(UsdGeom.XformCache(time).GetLocalToWorldTransform(prim))
    return points @ matrix[:3, :3] + matrix[3, :3]
