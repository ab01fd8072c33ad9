"""Scenes with one fault each, beside a square that is sound. Frame 10, shutter from 9.5 to 10.5."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux, UsdSkel, Vt
from recording import Shot

NAN, INF, HUGE = math.nan, math.inf, 1e30

Fill = Callable[[Shot], None]


@dataclass(frozen=True)
class Fault:
    """What is wrong, and the one line about it."""

    name: str
    fill: Fill
    subject: str
    """The prim and the attribute that the line starts with."""
    words: tuple[str, ...]
    """What the line says as well: found and expected."""

    def __str__(self) -> str:
        return self.name


FAULTS: list[Fault] = []


def fault(subject: str, *words: str, **variants: tuple) -> Callable[[Callable], Callable]:
    """Registers a scene; each of `variants` is the function's further arguments."""

    def register(function: Callable) -> Callable:
        for variant, arguments in (variants or {"": ()}).items():
            name = function.__name__ + (f"-{variant}" if variant else "")
            filled = lambda shot, arguments=arguments: function(shot, *arguments)  # noqa: E731
            FAULTS.append(Fault(name, filled, subject, words))
        return function

    return register


SQUARE = [(-1.0, -1.0, 0.0), (1.0, -1.0, 0.0), (1.0, 1.0, 0.0), (-1.0, 1.0, 0.0)]


def scene_with(fill: Fill, shutter: tuple[float, float] = (-0.5, 0.5)) -> Usd.Stage:
    """The fault stands left of the middle, /World/Good right of it."""
    shot = Shot(shutter)
    UsdGeom.Xform.Define(shot.stage, "/World")
    good = square(shot, "/World/Good")
    move = good.AddTranslateOp()
    move.Set(Gf.Vec3d(4, -0.25, 0), 9)
    move.Set(Gf.Vec3d(4, 0.25, 0), 11)
    fill(shot)
    return shot.stage


def square(shot: Shot, path: str, x: float = 0.0) -> UsdGeom.Mesh:
    return shot.mesh(path, [(x + p[0], *p[1:]) for p in SQUARE])


def bad_mesh(shot: Shot) -> UsdGeom.Mesh:
    return square(shot, "/World/Bad", -4.0)


def vec3s(*values: tuple[float, float, float]) -> Vt.Vec3fArray:
    return Vt.Vec3fArray([Gf.Vec3f(*value) for value in values])


def left(*values: tuple[float, float, float]) -> Vt.Vec3fArray:
    """The bad square's points, or as many as `values` in their place."""
    return vec3s(*((p[0] - 4.0, *p[1:]) for p in (values or SQUARE)))


def with_value(bad: float, count: int = 4) -> list[tuple[float, float, float]]:
    """`count` zeros of which the second is `bad`."""
    return [(bad if i == 1 else 0.0, 0.0, 0.0) for i in range(count)]


# Meshes.


@fault("/World/Bad.points", "expected", nan=(NAN,), inf=(INF,), huge=(HUGE,))
def one_sample_of_points(shot: Shot, bad: float) -> None:
    points = bad_mesh(shot).GetPointsAttr()
    for time in (9.0, 9.5, 10.0, 10.25, 11.0):
        values = left()
        if time == 10.25:
            values[1] = Gf.Vec3f(bad, 0, 0)
        points.Set(values, time)


@fault("/World/Bad.velocities", "value 1", "expected", nan=(NAN,), inf=(INF,))
def velocities(shot: Shot, bad: float) -> None:
    mesh = bad_mesh(shot)
    mesh.GetPointsAttr().Set(left(), 10)
    mesh.CreateVelocitiesAttr().Set(vec3s(*with_value(bad)), 10)


@fault("/World/Bad.accelerations", "value 1", "expected", nan=(NAN,), inf=(INF,))
def accelerations(shot: Shot, bad: float) -> None:
    mesh = bad_mesh(shot)
    mesh.GetPointsAttr().Set(left(), 10)
    mesh.CreateVelocitiesAttr().Set(vec3s(*with_value(1.0)), 10)
    mesh.CreateAccelerationsAttr().Set(vec3s(*with_value(bad)), 10)


@fault("/World/Bad.points", "reaches", "expected")
def velocities_huge(shot: Shot) -> None:
    mesh = bad_mesh(shot)
    mesh.GetPointsAttr().Set(left(), 10)
    mesh.CreateVelocitiesAttr().Set(vec3s(*with_value(HUGE)), 10)


@fault("/World/Bad.velocities", "found 3 values", "expected 4")
def velocities_of_another_length(shot: Shot) -> None:
    mesh = bad_mesh(shot)
    mesh.GetPointsAttr().Set(left(), 10)
    mesh.CreateVelocitiesAttr().Set(vec3s(*with_value(1.0, 3)), 10)


@fault("/World/Bad.accelerations", "found 5 values", "expected 4")
def accelerations_of_another_length(shot: Shot) -> None:
    mesh = bad_mesh(shot)
    mesh.GetPointsAttr().Set(left(), 10)
    mesh.CreateVelocitiesAttr().Set(vec3s(*with_value(1.0)), 10)
    mesh.CreateAccelerationsAttr().Set(vec3s(*with_value(1.0, 5)), 10)


@fault("/World/Bad.points", "no points", "expected")
def empty_points_beside_velocities(shot: Shot) -> None:
    mesh = bad_mesh(shot)
    mesh.GetPointsAttr().Clear()
    mesh.GetPointsAttr().Set(Vt.Vec3fArray(), 10)
    mesh.CreateVelocitiesAttr().Set(vec3s(*with_value(1.0)), 10)


@fault("/World/Bad.faceVertexIndices", "index 3 is 3", "expected 0 to 2")
def too_few_points(shot: Shot) -> None:
    bad_mesh(shot).GetPointsAttr().Set(left(*SQUARE[:3]))


@fault("/World/Bad.faceVertexCounts", "add up to 5", "expected 4")
def counts_that_do_not_add_up(shot: Shot) -> None:
    bad_mesh(shot).GetFaceVertexCountsAttr().Set([5])


@fault("/World/Bad.normals", "found 3", "expected 4")
def normals_of_another_length(shot: Shot) -> None:
    mesh = bad_mesh(shot)
    mesh.GetNormalsAttr().Set(vec3s((0, 0, 1), (0, 0, 1), (0, 0, 1)))
    mesh.SetNormalsInterpolation("vertex")


@fault("/World/Bad.normals", "value 1", "expected")
def one_sample_of_normals(shot: Shot) -> None:
    mesh = bad_mesh(shot)
    mesh.SetNormalsInterpolation("vertex")
    for time in (9.0, 10.25, 11.0):
        values = vec3s(*[(0.0, 0.0, 1.0)] * 4)
        if time == 10.25:
            values[1] = Gf.Vec3f(NAN, 0, 0)
        mesh.GetNormalsAttr().Set(values, time)


@fault("/World/Bad.primvars:displayColor", "found 3", "expected 4")
def primvar_of_another_length(shot: Shot) -> None:
    primvar = bad_mesh(shot).CreateDisplayColorPrimvar("vertex")
    primvar.Set(vec3s((1, 0, 0), (0, 1, 0), (0, 0, 1)))


@fault("/World/Bad.primvars:displayColor", "finite", nan=(NAN,), inf=(INF,), huge=(HUGE,))
def one_sample_of_a_primvar(shot: Shot, bad: float) -> None:
    primvar = bad_mesh(shot).CreateDisplayColorPrimvar("constant")
    for time, red in ((9, 1.0), (10.25, bad), (11, 1.0)):
        primvar.Set(vec3s((red, 0, 0)), time)


@fault("/World/Bad.xformOp:translate", "expected finite numbers", nan=(NAN,), inf=(INF,), huge=(HUGE,))
def one_sample_of_a_translation(shot: Shot, bad: float) -> None:
    move = bad_mesh(shot).AddTranslateOp()
    for time in (9, 9.75, 10.25, 11):
        move.Set(Gf.Vec3d(bad if time == 10.25 else 0, 0, 0), time)


@fault("/World/Group.xformOp:rotateXYZ", "expected finite numbers", nan=(NAN,), inf=(INF,))
def one_sample_of_a_parents_rotation(shot: Shot, bad: float) -> None:
    group = UsdGeom.Xform.Define(shot.stage, "/World/Group")
    turn = group.AddRotateXYZOp()
    square(shot, "/World/Group/Bad", -4.0)
    for time in (9, 9.75, 10.25, 11):
        turn.Set(Gf.Vec3f(bad if time == 10.25 else 0, 0, 0), time)


@fault("/World/Bad.xformOp:transform", "expected finite numbers")
def a_matrix_that_is_no_number(shot: Shot) -> None:
    matrix = Gf.Matrix4d(1)
    matrix[3, 0] = NAN
    bad_mesh(shot).AddTransformOp().Set(matrix)


@fault("/World/Bad.points", "a coordinate reaches", "expected at most 2^60")
def points_whose_curve_has_controls_beyond_what_is_representable(shot: Shot) -> None:
    """A parabola up to 0.9 * 2^60: its middle control lies at 1.8 * 2^60, which used to end the run."""
    mesh = bad_mesh(shot)
    mesh.GetPointsAttr().Set(left(), 9.5)
    mesh.CreateVelocitiesAttr().Set(vec3s(*with_value(3.6 * 2.0**60 * 24)), 9.5)
    mesh.CreateAccelerationsAttr().Set(vec3s(*with_value(-7.2 * 2.0**60 * 24 * 24)), 9.5)


# Point instancers.


def bad_instancer(shot: Shot, count: int = 4) -> UsdGeom.PointInstancer:
    """Small squares in a row at the left, in the samples of frames 9 to 11."""
    instancer = UsdGeom.PointInstancer.Define(shot.stage, "/World/Bad")
    square(shot, "/World/Bad/Prototype")
    instancer.CreatePrototypesRel().SetTargets(["/World/Bad/Prototype"])
    instancer.CreateProtoIndicesAttr([0] * count)
    instancer.CreatePositionsAttr().Set(row(count))
    return instancer


def row(count: int = 4) -> Vt.Vec3fArray:
    return vec3s(*((-5.0 + 0.5 * i, 0.0, 0.0) for i in range(count)))


def quaternions(attribute: Usd.Attribute, count: int = 4, bad: tuple | None = None) -> object:
    kind, array = (Gf.Quath, Vt.QuathArray) if attribute.GetName() == "orientations" else (Gf.Quatf, Vt.QuatfArray)
    return array([kind(*(bad if bad and i == 1 else (1.0, 0.0, 0.0, 0.0))) for i in range(count)])


@fault("/World/Bad.positions", "found 3 values", "expected 4")
def positions_of_another_length(shot: Shot) -> None:
    bad_instancer(shot).GetPositionsAttr().Set(row(3))


@fault("/World/Bad.scales", "found 5 values", "expected 4")
def scales_of_another_length(shot: Shot) -> None:
    bad_instancer(shot).CreateScalesAttr(vec3s(*[(1, 1, 1)] * 5))


@fault("/World/Bad.orientations", "found 2 values", "expected 4")
def orientations_of_another_length(shot: Shot) -> None:
    attribute = bad_instancer(shot).CreateOrientationsAttr()
    attribute.Set(quaternions(attribute, 2))


@fault("/World/Bad.orientationsf", "found 2 values", "expected 4")
def orientationsf_of_another_length(shot: Shot) -> None:
    attribute = bad_instancer(shot).CreateOrientationsfAttr()
    attribute.Set(quaternions(attribute, 2))


@fault("/World/Bad.velocities", "found 3 values", "expected 4")
def instance_velocities_of_another_length(shot: Shot) -> None:
    instancer = bad_instancer(shot)
    instancer.GetPositionsAttr().Set(row(), 10)
    instancer.CreateVelocitiesAttr().Set(vec3s(*with_value(1.0, 3)), 10)


@fault("/World/Bad.accelerations", "found 3 values", "expected 4")
def instance_accelerations_of_another_length(shot: Shot) -> None:
    instancer = bad_instancer(shot)
    instancer.GetPositionsAttr().Set(row(), 10)
    instancer.CreateVelocitiesAttr().Set(vec3s(*with_value(1.0)), 10)
    instancer.CreateAccelerationsAttr().Set(vec3s(*with_value(1.0, 3)), 10)


@fault("/World/Bad.angularVelocities", "found 3 values", "expected 4")
def angular_velocities_of_another_length(shot: Shot) -> None:
    instancer = bad_instancer(shot)
    attribute = instancer.CreateOrientationsAttr()
    attribute.Set(quaternions(attribute), 10)
    instancer.CreateAngularVelocitiesAttr().Set(vec3s(*with_value(90.0, 3)), 10)


@fault("/World/Bad.ids", "found 3 ids", "expected 4")
def ids_of_another_length(shot: Shot) -> None:
    instancer = bad_instancer(shot)
    instancer.CreateIdsAttr([7, 8, 9])
    instancer.CreateInvisibleIdsAttr([7])


@fault("/World/Bad.protoIndices", "found 3, 7", "expected the index of one of 1")
def proto_indices_out_of_range(shot: Shot) -> None:
    bad_instancer(shot).GetProtoIndicesAttr().Set([0, 7, 3, 0])


@fault("/World/Bad.protoIndices", "found -1", "expected the index of one of 1")
def proto_indices_below_zero(shot: Shot) -> None:
    bad_instancer(shot).GetProtoIndicesAttr().Set([0, -1, 0, 0])


@fault("/World/Bad.prototypes", "/World/Nowhere", "expected")
def prototypes_that_do_not_resolve(shot: Shot) -> None:
    instancer = bad_instancer(shot)
    instancer.GetPrototypesRel().SetTargets(["/World/Bad/Prototype", "/World/Nowhere"])
    instancer.GetProtoIndicesAttr().Set([0, 1, 1, 0])


@fault("/World/Bad.primvars:displayColor", "found 3", "expected one valid index an instance")
def instance_colors_of_another_length(shot: Shot) -> None:
    primvar = UsdGeom.PrimvarsAPI(bad_instancer(shot)).CreatePrimvar(
        "displayColor", Sdf.ValueTypeNames.Color3fArray, "varying"
    )
    primvar.Set(vec3s((1, 0, 0), (0, 1, 0), (0, 0, 1)))


@fault("/World/Bad.positions", "expected finite numbers", nan=(NAN,), inf=(INF,), huge=(HUGE,))
def one_sample_of_positions(shot: Shot, bad: float) -> None:
    attribute = bad_instancer(shot).GetPositionsAttr()
    for time in (9, 9.75, 10.25, 11):
        values = row()
        if time == 10.25:
            values[1] = Gf.Vec3f(bad, 0, 0)
        attribute.Set(values, time)


@fault("/World/Bad.scales", "expected finite numbers", nan=(NAN,), inf=(INF,), huge=(HUGE,))
def one_sample_of_scales(shot: Shot, bad: float) -> None:
    attribute = bad_instancer(shot).CreateScalesAttr()
    for time in (9, 9.75, 10.25, 11):
        values = vec3s(*[(1.0, 1.0, 1.0)] * 4)
        if time == 10.25:
            values[1] = Gf.Vec3f(bad, 1, 1)
        attribute.Set(values, time)


@fault("/World/Bad.orientationsf", "expected", nan=(NAN,), inf=(INF,))
def one_sample_of_orientations(shot: Shot, bad: float) -> None:
    attribute = bad_instancer(shot).CreateOrientationsfAttr()
    for time in (9, 9.75, 10.25, 11):
        broken = (bad, 0.0, 0.0, 0.0) if time == 10.25 else None
        attribute.Set(quaternions(attribute, bad=broken), time)


@fault("/World/Bad.velocities", "expected finite numbers", nan=(NAN,), inf=(INF,), huge=(HUGE,))
def one_instance_velocity(shot: Shot, bad: float) -> None:
    instancer = bad_instancer(shot)
    instancer.GetPositionsAttr().Set(row(), 10)
    instancer.CreateVelocitiesAttr().Set(vec3s(*with_value(bad)), 10)


@fault("/World/Bad.accelerations", "expected finite numbers", nan=(NAN,), inf=(INF,))
def one_instance_acceleration(shot: Shot, bad: float) -> None:
    instancer = bad_instancer(shot)
    instancer.GetPositionsAttr().Set(row(), 10)
    instancer.CreateVelocitiesAttr().Set(vec3s(*with_value(1.0)), 10)
    instancer.CreateAccelerationsAttr().Set(vec3s(*with_value(bad)), 10)


@fault("/World/Bad.angularVelocities", "expected finite numbers", nan=(NAN,), inf=(INF,))
def one_angular_velocity(shot: Shot, bad: float) -> None:
    instancer = bad_instancer(shot)
    attribute = instancer.CreateOrientationsAttr()
    attribute.Set(quaternions(attribute), 10)
    instancer.CreateAngularVelocitiesAttr().Set(vec3s(*with_value(bad)), 10)


@fault("/World/Bad.velocities", "value 1", "expected finite numbers of at most 2^60")
def instances_whose_curve_has_controls_beyond_what_is_representable(shot: Shot) -> None:
    instancer = bad_instancer(shot)
    instancer.GetPositionsAttr().Set(row(), 9.5)
    instancer.CreateVelocitiesAttr().Set(vec3s(*with_value(3.6 * 2.0**60 * 24)), 9.5)
    instancer.CreateAccelerationsAttr().Set(vec3s(*with_value(-7.2 * 2.0**60 * 24 * 24)), 9.5)


@fault("/World/Bad/Prototype.points", "value 1", "expected")
def one_sample_of_a_prototypes_points(shot: Shot) -> None:
    bad_instancer(shot)
    points = UsdGeom.Mesh.Get(shot.stage, "/World/Bad/Prototype").GetPointsAttr()
    for time in (9, 10, 11):
        values = vec3s(*SQUARE)
        if time == 10:
            values[1] = Gf.Vec3f(NAN, 0, 0)
        points.Set(values, time)


@fault("/World/Bad/Prototype.xformOp:translate", "expected finite numbers")
def one_sample_of_a_prototypes_transform(shot: Shot) -> None:
    bad_instancer(shot)
    move = UsdGeom.Mesh.Get(shot.stage, "/World/Bad/Prototype").AddTranslateOp()
    for time in (9, 9.75, 10.25, 11):
        move.Set(Gf.Vec3d(NAN if time == 10.25 else 0, 0, 0), time)


@fault("/World/Bad.xformOp:translate", "expected finite numbers")
def one_sample_of_an_instances_transform(shot: Shot) -> None:
    prototype = UsdGeom.Xform.Define(shot.stage, "/Prototype")
    square(shot, "/Prototype/Square")
    prototype.GetPrim().SetSpecifier(Sdf.SpecifierClass)
    instance = UsdGeom.Xform.Define(shot.stage, "/World/Bad")
    instance.GetPrim().GetReferences().AddInternalReference("/Prototype")
    instance.GetPrim().SetInstanceable(True)
    move = instance.AddTranslateOp()
    for time in (9, 9.75, 10.25, 11):
        move.Set(Gf.Vec3d(NAN if time == 10.25 else -4, 0, 0), time)


# Skinning.


def bad_arm(shot: Shot) -> tuple[UsdGeom.Mesh, UsdSkel.Animation]:
    """A square whose right side follows the second of two joints, which turns."""
    stage = shot.stage
    UsdSkel.Root.Define(stage, "/World/Arm")
    skeleton = UsdSkel.Skeleton.Define(stage, "/World/Arm/Skeleton")
    skeleton.CreateJointsAttr(["a", "a/b"])
    skeleton.CreateBindTransformsAttr([Gf.Matrix4d(1)] * 2)
    skeleton.CreateRestTransformsAttr([Gf.Matrix4d(1)] * 2)
    animation = UsdSkel.Animation.Define(stage, "/World/Arm/Animation")
    animation.CreateJointsAttr(["a", "a/b"])
    animation.CreateScalesAttr([Gf.Vec3h(1, 1, 1)] * 2)
    animation.CreateTranslationsAttr(vec3s((0, 0, 0), (0, 0, 0)))
    animation.CreateRotationsAttr([Gf.Quatf(1)] * 2)
    mesh = square(shot, "/World/Arm/Bad", -4.0)
    binding = UsdSkel.BindingAPI.Apply(mesh.GetPrim())
    binding.CreateSkeletonRel().SetTargets(["/World/Arm/Skeleton"])
    UsdSkel.BindingAPI.Apply(skeleton.GetPrim()).CreateAnimationSourceRel().SetTargets(["/World/Arm/Animation"])
    binding.CreateJointIndicesPrimvar(False, 1).Set([0, 1, 1, 0])
    binding.CreateJointWeightsPrimvar(False, 1).Set([1.0] * 4)
    return mesh, animation


@fault("/World/Arm/Bad.skel:skeleton", "/World/Nowhere", "expected one Skeleton")
def a_skeleton_that_does_not_resolve(shot: Shot) -> None:
    mesh, _ = bad_arm(shot)
    UsdSkel.BindingAPI(mesh).GetSkeletonRel().SetTargets(["/World/Nowhere"])


@fault("/World/Arm/Bad.primvars:skel:jointIndices", "value 2 is 9", "expected a joint from 0 to 1")
def joint_indices_out_of_range(shot: Shot) -> None:
    mesh, _ = bad_arm(shot)
    UsdSkel.BindingAPI(mesh).GetJointIndicesPrimvar().Set([0, 1, 9, 0])


@fault("/World/Arm/Bad.primvars:skel:jointIndices", "expected 4")
def influences_of_another_length(shot: Shot) -> None:
    mesh, _ = bad_arm(shot)
    UsdSkel.BindingAPI(mesh).GetJointIndicesPrimvar().Set([0, 1, 1])
    UsdSkel.BindingAPI(mesh).GetJointWeightsPrimvar().Set([1.0] * 3)


@fault("/World/Arm/Animation.translations", "for joint 'a/b'", "expected finite", nan=(NAN,), inf=(INF,), huge=(HUGE,))
def one_sample_of_joint_translations(shot: Shot, bad: float) -> None:
    _, animation = bad_arm(shot)
    for time in (9, 9.75, 10.25, 11):
        animation.GetTranslationsAttr().Set(vec3s((0, 0, 0), (bad if time == 10.25 else 0, 0, 0)), time)


@fault("/World/Arm/Animation.rotations", "for joint 'a/b'", "expected finite", nan=(NAN,))
def one_sample_of_joint_rotations(shot: Shot, bad: float) -> None:
    _, animation = bad_arm(shot)
    for time in (9, 9.75, 10.25, 11):
        second = Gf.Quatf(bad if time == 10.25 else 1.0, 0, 0, 0.1)
        animation.GetRotationsAttr().Set(Vt.QuatfArray([Gf.Quatf(1), second]), time)


@fault("/World/Arm/Bad.skel:blendShapes", "expected a finite number", nan=(NAN,), inf=(INF,))
def one_sample_of_blend_shape_weights(shot: Shot, bad: float) -> None:
    mesh, animation = bad_arm(shot)
    shape = UsdSkel.BlendShape.Define(shot.stage, "/World/Arm/Bad/rise")
    shape.CreateOffsetsAttr(vec3s(*[(0.0, 0.5, 0.0)] * 4))
    binding = UsdSkel.BindingAPI(mesh)
    binding.CreateBlendShapesAttr(["rise"])
    binding.CreateBlendShapeTargetsRel().SetTargets([shape.GetPath()])
    animation.CreateBlendShapesAttr(["rise"])
    for time in (9, 9.75, 10.25, 11):
        animation.CreateBlendShapeWeightsAttr().Set([bad if time == 10.25 else 0.5], time)


# Lights.


@fault("/World/Light.inputs:intensity", "expected", nan=(NAN,), inf=(INF,))
def one_sample_of_intensity(shot: Shot, bad: float) -> None:
    light = UsdLux.SphereLight.Define(shot.stage, "/World/Light")
    for time in (9, 9.75, 10.25, 11):
        light.GetIntensityAttr().Set(bad if time == 10.25 else 1.0, time)
    UsdLux.DistantLight.Define(shot.stage, "/World/Sun")


@fault("/World/Bad.orientations", "value 1", "(0, 0, 0, 0)", "expected a quaternion of length 1")
def a_quaternion_of_length_zero(shot: Shot) -> None:
    attribute = bad_instancer(shot).CreateOrientationsAttr()
    attribute.Set(quaternions(attribute, bad=(0.0, 0.0, 0.0, 0.0)))


@fault("/World/Bad.orientationsf", "value 1", "(0, 0, 0, 0)", "expected a quaternion of length 1")
def a_quaternion_of_length_zero_in_one_sample(shot: Shot) -> None:
    attribute = bad_instancer(shot).CreateOrientationsfAttr()
    for time in (9, 10.25, 11):
        attribute.Set(quaternions(attribute, bad=(0.0,) * 4 if time == 10.25 else None), time)


# What the shutter does not see, which is from 10.1 to 10.5 here: samples at 9, at the frame and far behind.

UNSEEN_SHUTTER = (0.1, 0.5)
UNSEEN_TIMES = (9.0, 10.0, 10.05, 10.3, 10.6, 12.0)
UNSEEN_BAD = (9.0, 10.0, 12.0)

UNSEEN: list[Callable[[Shot], None]] = []


def unseen(function: Callable[[Shot], None]) -> Callable[[Shot], None]:
    """Registers a scene with values that are no numbers where they do not matter."""
    UNSEEN.append(function)
    return function


@unseen
def points_unseen(shot: Shot) -> None:
    points = bad_mesh(shot).GetPointsAttr()
    for time in UNSEEN_TIMES:
        values = left()
        if time in UNSEEN_BAD:
            values[1] = Gf.Vec3f(NAN, 0, 0)
        points.Set(values, time)


@unseen
def normals_unseen(shot: Shot) -> None:
    mesh = bad_mesh(shot)
    mesh.SetNormalsInterpolation("vertex")
    for time in UNSEEN_TIMES:
        mesh.GetNormalsAttr().Set(vec3s(*[(0, 0, NAN if time in UNSEEN_BAD else 1.0)] * 4), time)


@unseen
def color_unseen(shot: Shot) -> None:
    primvar = bad_mesh(shot).CreateDisplayColorPrimvar("constant")
    for time in UNSEEN_TIMES:
        primvar.Set(vec3s((NAN if time in (9.0, 12.0) else time / 20, 0, 0)), time)


@unseen
def rates_unseen(shot: Shot) -> None:
    mesh = bad_mesh(shot)
    for time in (9.0, 10.0, 11.0):
        bad = NAN if time != 10.0 else 1.0
        mesh.GetPointsAttr().Set(left(), time)
        mesh.CreateVelocitiesAttr().Set(vec3s(*with_value(bad)), time)
        mesh.CreateAccelerationsAttr().Set(vec3s(*with_value(bad)), time)


@unseen
def translation_unseen(shot: Shot) -> None:
    move = bad_mesh(shot).AddTranslateOp()
    for time in UNSEEN_TIMES:
        move.Set(Gf.Vec3d(NAN if time in UNSEEN_BAD else 0.0, 0, 0), time)


@unseen
def instances_unseen(shot: Shot) -> None:
    instancer = bad_instancer(shot)
    orientations, scales = instancer.CreateOrientationsfAttr(), instancer.CreateScalesAttr()
    for time in UNSEEN_TIMES:
        bad = NAN if time in UNSEEN_BAD else 1.0
        positions = row()
        positions[1] = Gf.Vec3f(positions[1][0] * bad, 0, 0)
        instancer.GetPositionsAttr().Set(positions, time)
        scales.Set(vec3s(*[(bad, 1, 1)] * 4), time)
        orientations.Set(quaternions(orientations, bad=(bad, 0.0, 0.0, 0.0)), time)


@unseen
def joints_unseen(shot: Shot) -> None:
    _, animation = bad_arm(shot)
    for time in UNSEEN_TIMES:
        bad = NAN if time in UNSEEN_BAD else 0.0
        animation.GetTranslationsAttr().Set(vec3s((0, 0, 0), (bad, 0, 0)), time)


@unseen
def light_unseen(shot: Shot) -> None:
    light = UsdLux.SphereLight.Define(shot.stage, "/World/Light")
    bad_mesh(shot)
    for time in UNSEEN_TIMES:
        light.GetIntensityAttr().Set(NAN if time in UNSEEN_BAD else time, time)


# Cameras: without one there is no picture.

CAMERA_FAULTS: dict[str, tuple[Callable[[UsdGeom.Camera], None], str]] = {}


def _sampled(attribute: Usd.Attribute, good: object, bad: object) -> None:
    for time in (9, 9.75, 10.25, 11):
        attribute.Set(bad if time == 10.25 else good, time)


def camera_translation(camera: UsdGeom.Camera) -> None:
    move = camera.GetOrderedXformOps()[0]
    _sampled(move.GetAttr(), Gf.Vec3d(0, 0, 20), Gf.Vec3d(NAN, 0, 20))


def camera_focal_length(camera: UsdGeom.Camera) -> None:
    _sampled(camera.CreateFocalLengthAttr(), 50.0, NAN)


def camera_aperture(camera: UsdGeom.Camera) -> None:
    _sampled(camera.CreateHorizontalApertureAttr(), 20.0, INF)


def camera_aperture_offset(camera: UsdGeom.Camera) -> None:
    _sampled(camera.CreateHorizontalApertureOffsetAttr(), 0.0, NAN)


def camera_clipping_range(camera: UsdGeom.Camera) -> None:
    _sampled(camera.CreateClippingRangeAttr(), Gf.Vec2f(1, 100), Gf.Vec2f(NAN, 100))


CAMERA_FAULTS.update(
    {
        "translation": (camera_translation, "/Camera.xformOp:translate: found (nan, 0, 20) "),
        "focal-length": (camera_focal_length, "/Camera.focalLength: found nan"),
        "aperture": (camera_aperture, "/Camera.horizontalAperture: found inf"),
        "aperture-offset": (camera_aperture_offset, "/Camera.horizontalApertureOffset: found nan"),
        "clipping-range": (camera_clipping_range, "/Camera.clippingRange: found (nan, 100)"),
    }
)
