"""Scenes with one fault each, beside a square that is sound. Frame 10, shutter from 9.5 to 10.5."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from pxr import Gf, Usd, UsdGeom, Vt
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
            filled = lambda shot, arguments=arguments: function(shot, *arguments)
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
