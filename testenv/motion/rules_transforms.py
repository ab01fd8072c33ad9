"""How transforms move: ops, their order, ancestors."""

from __future__ import annotations

import math

from authoring import STILL, Scene, box, place, rule, samples, slide, turn
from pxr import Gf, UsdGeom

TOPIC = "transforms"
FULL = (-0.5, 0.5)


def rotation(degrees: float) -> Gf.Matrix4d:
    return Gf.Matrix4d().SetRotate(Gf.Rotation(Gf.Vec3d.ZAxis(), degrees))


def lerped_bar(scene: Scene, path: str, begin: float, end: float) -> None:
    """A bar whose points run along straight lines from one angle to another over the full shutter."""
    mesh = scene.bar(path)
    points = mesh.GetPointsAttr().Get()
    mesh.GetPointsAttr().Clear()
    for time, angle in ((9.5, begin), (10.5, end)):
        mesh.GetPointsAttr().Set([Gf.Vec3f(rotation(angle).Transform(p)) for p in points], time)


@rule(TOPIC, "A rotate op truly rotates: points run along arcs", "points run along chords", shutter=FULL)
def rotate_op(scene: Scene) -> None:
    if scene.mistaken:
        lerped_bar(scene, "/Bar", 0.0, 150.0)
    else:
        turn(scene.bar("/Bar"), {9.0: -75.0, 11.0: 225.0})


@rule(TOPIC, "Two full turns within the shutter are two full turns", STILL, shutter=FULL)
def rotate_two_turns(scene: Scene) -> None:
    turn(scene.bar("/Bar", x=1.5), {9.5: 0.0, 10.5: 720.0})


@rule(TOPIC, "Euler angles are interpolated, then composed", "the rotations at the ends alone", shutter=FULL)
def rotate_xyz(scene: Scene) -> None:
    bar = scene.bar("/Bar", x=1.0)
    if scene.mistaken:
        angles = {9.5: (0, 0, 0), 10.5: (300, 80, 200)}
        samples(
            UsdGeom.Xformable(bar).AddTransformOp(),
            {t: _euler(*a) for t, a in angles.items()},
        )
    else:
        operation = UsdGeom.Xformable(bar).AddRotateXYZOp()
        samples(operation, {9.5: Gf.Vec3f(0, 0, 0), 10.5: Gf.Vec3f(300, 80, 200)})


def _euler(x: float, y: float, z: float) -> Gf.Matrix4d:
    axes = zip((Gf.Vec3d.XAxis(), Gf.Vec3d.YAxis(), Gf.Vec3d.ZAxis()), (x, y, z), strict=True)
    matrix = Gf.Matrix4d(1)
    for axis, angle in axes:
        matrix *= Gf.Matrix4d().SetRotate(Gf.Rotation(axis, angle))
    return matrix


@rule(TOPIC, "A matrix op is interpolated per component: it shrinks between", "it rotates", shutter=FULL)
def matrix_op(scene: Scene) -> None:
    bar = scene.bar("/Bar")
    if scene.mistaken:
        turn(bar, {9.5: 0.0, 10.5: 150.0})
    else:
        samples(UsdGeom.Xformable(bar).AddTransformOp(), {9.5: rotation(0.0), 10.5: rotation(150.0)})


@rule(TOPIC, "An orient op is interpolated along the sphere", "points run along chords", shutter=FULL)
def orient_op(scene: Scene) -> None:
    if scene.mistaken:
        lerped_bar(scene, "/Bar", 0.0, 150.0)
        return
    operation = UsdGeom.Xformable(scene.bar("/Bar")).AddOrientOp()
    samples(operation, {9.5: Gf.Quatf(1), 10.5: Gf.Quatf(rotation(150.0).ExtractRotationQuat())})


@rule(TOPIC, "xformOpOrder decides which op comes first", "ops in the order translate, rotate, scale")
def op_order(scene: Scene) -> None:
    wedge = scene.wedge("/Wedge")
    operations = [
        slide(wedge, {9.0: (-2, 0), 11.0: (6, 0)}),
        turn(wedge, {9.0: -60.0, 11.0: 120.0}),
        UsdGeom.Xformable(wedge).AddScaleOp(),
    ]
    operations[2].Set(Gf.Vec3f(1.5, 0.6, 1.0))
    if not scene.mistaken:
        UsdGeom.Xformable(wedge).SetXformOpOrder(operations[::-1])


@rule(TOPIC, "Ops with samples at different times each keep theirs", "the ends of the shutter alone")
def ops_at_different_times(scene: Scene) -> None:
    bar = scene.bar("/Bar")
    if scene.mistaken:
        slide(bar, {9.75: (-4, 0), 10.5: (3, 0)})
        turn(bar, {9.75: 0.0, 10.5: 90.0})
        return
    slide(bar, {9.75: (-4, 0), 10.0: (-4, 0), 10.2: (3, 0), 10.5: (3, 0)})
    turn(bar, {9.75: 0.0, 10.3: 0.0, 10.5: 90.0})


@rule(TOPIC, "A pivot is an op and its inverse around the rotation", "a rotation about the origin")
def pivot(scene: Scene) -> None:
    bar = scene.bar("/Bar", x=2.2)
    xformable = UsdGeom.Xformable(bar)
    if not scene.mistaken:
        about = xformable.AddTranslateOp(UsdGeom.XformOp.PrecisionDouble, "pivot")
        about.Set(Gf.Vec3d(4.4, 0, 0))
    turn(bar, {9.0: -60.0, 11.0: 120.0})
    if not scene.mistaken:
        xformable.AddTranslateOp(UsdGeom.XformOp.PrecisionDouble, "pivot", True)


@rule(TOPIC, "A pivot that moves moves in both of its ops", "the frame's pivot")
def pivot_moves(scene: Scene) -> None:
    bar = scene.bar("/Bar")
    xformable = UsdGeom.Xformable(bar)
    about = xformable.AddTranslateOp(UsdGeom.XformOp.PrecisionDouble, "pivot")
    path = {10.0: Gf.Vec3d(-1, 0, 0)} if scene.mistaken else {9.0: Gf.Vec3d(-5, 0, 0), 11.0: Gf.Vec3d(3, 0, 0)}
    samples(about, path)
    turn(bar, {9.0: -90.0, 11.0: 90.0})
    xformable.AddTranslateOp(UsdGeom.XformOp.PrecisionDouble, "pivot", True)


@rule(TOPIC, "A scale op passes through zero to the mirrored side", STILL, shutter=FULL)
def scale_through_zero(scene: Scene) -> None:
    wedge = scene.wedge("/Wedge")
    samples(UsdGeom.Xformable(wedge).AddScaleOp(), {9.5: Gf.Vec3f(2, 2, 1), 10.5: Gf.Vec3f(-2.5, -1.5, 1)})


@rule(TOPIC, "A negative scale mirrors, and is still drawn while it turns", "its absolute value")
def negative_scale(scene: Scene) -> None:
    wedge = scene.wedge("/Wedge")
    turn(wedge, {9.0: -40.0, 11.0: 80.0})
    sign = 1.0 if scene.mistaken else -1.0
    UsdGeom.Xformable(wedge).AddScaleOp().Set(Gf.Vec3f(sign * 1.5, 1.5, 1.0))


@rule(TOPIC, "!resetXformStack! leaves the ancestors' motion behind", "it moves with its parent")
def reset_xform_stack(scene: Scene) -> None:
    parent = UsdGeom.Xform.Define(scene.stage, "/Parent")
    slide(parent, {9.0: (-6, 1.5), 11.0: (6, 1.5)})
    scene.square("/Parent/Follows", side=0.8)
    child = scene.square("/Parent/Stays", y=-1.0)
    slide(child, {9.0: (0, -2), 11.0: (0, 0)})
    UsdGeom.Xformable(child).SetResetXformStack(not scene.mistaken)


@rule(TOPIC, "The motion of every ancestor counts", "its own and its parent's alone")
def ancestors(scene: Scene) -> None:
    top = UsdGeom.Xform.Define(scene.stage, "/A")
    if not scene.mistaken:
        slide(top, {9.0: (-4, 0), 11.0: (4, 0)})
    turn(UsdGeom.Xform.Define(scene.stage, "/A/B"), {9.0: -60.0, 11.0: 60.0})
    slide(scene.square("/A/B/Square", side=1.0), {9.5: (2, -1), 10.5: (2, 1)})


@rule(TOPIC, "Transform and points move together", "the transform's motion alone")
def transform_and_points(scene: Scene) -> None:
    square = scene.square("/Square", side=1.0)
    slide(square, {9.0: (-6, 0), 11.0: (6, 0)})
    scene.points_between(square, {10.0: (0, 0)} if scene.mistaken else {9.5: (0, -3), 10.5: (0, 3)})


@rule(TOPIC, "A world far from its origin moves as one at it", "positions in single precision", shutter=FULL)
def large_world(scene: Scene) -> None:
    """At 2^24 + 1e6 units single precision knows steps of 2 units."""
    far = 17_777_216.0
    scene.eye.Set(Gf.Vec3d(far, 0, 20))
    parent = UsdGeom.Xform.Define(scene.stage, "/Far")
    if scene.mistaken:
        place(parent, far + 1.0, 0)
        scene.square("/Far/Square")
        return
    place(parent, far, 0)
    slide(scene.square("/Far/Square"), {9.5: (-1.6, -1), 10.5: (1.4, 1.3)})


@rule(TOPIC, "Coverage is what is left of turning blades, not their hull", "the swept hull", shutter=FULL)
def blades(scene: Scene) -> None:
    wheel = UsdGeom.Xform.Define(scene.stage, "/Wheel")
    if scene.mistaken:
        rim = [(2.6 * math.cos(a * math.tau / 64), 2.6 * math.sin(a * math.tau / 64)) for a in range(64)]
        scene.polygon("/Wheel/Disc", rim)
        return
    turn(wheel, {9.5: 0.0, 10.5: 240.0})
    for i in range(3):
        blade = scene.polygon(f"/Wheel/Blade{i}", box(1.4, 0.0, 2.4, 0.5))
        UsdGeom.Xformable(blade).AddRotateZOp().Set(i * 120.0)
