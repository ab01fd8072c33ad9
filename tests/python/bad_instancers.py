"""Point instancers and instances with one fault each (bad_scenes.py)."""

from __future__ import annotations

from bad_scenes import HUGE, INF, NAN, SQUARE, fault, square, vec3s, with_value
from pxr import Gf, Sdf, Usd, UsdGeom, Vt
from recording import Shot


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


@fault("/World/Bad.orientations", "value 1", "(0, 0, 0, 0)", "expected a quaternion of length 1")
def a_quaternion_of_length_zero(shot: Shot) -> None:
    attribute = bad_instancer(shot).CreateOrientationsAttr()
    attribute.Set(quaternions(attribute, bad=(0.0, 0.0, 0.0, 0.0)))


@fault("/World/Bad.orientationsf", "value 1", "(0, 0, 0, 0)", "expected a quaternion of length 1")
def a_quaternion_of_length_zero_in_one_sample(shot: Shot) -> None:
    attribute = bad_instancer(shot).CreateOrientationsfAttr()
    for time in (9, 10.25, 11):
        attribute.Set(quaternions(attribute, bad=(0.0,) * 4 if time == 10.25 else None), time)
