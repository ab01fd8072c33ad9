"""Velocities, accelerations, and UsdGeomMotionAPI."""

from __future__ import annotations

from collections.abc import Mapping

from authoring import FRAME, Scene, Vector, box, rule, samples, slide, spatial, turn
from pxr import Gf, UsdGeom

TOPIC, MOTION_API, VARYING = "velocities", "UsdGeomMotionAPI", "varying topology"


def flying(
    scene: Scene,
    path: str,
    velocity: Vector,
    acceleration: Vector | None = None,
    time: float = FRAME,
    at: Vector = (0, 0),
) -> UsdGeom.Mesh:
    """A square with one sample of points and velocities. Units a frame and a frame squared, at any rate."""
    mesh = scene.square(path, *at)
    points = mesh.GetPointsAttr().Get()
    mesh.GetPointsAttr().Clear()
    mesh.GetPointsAttr().Set(points, time)
    rate = scene.stage.GetTimeCodesPerSecond()
    mesh.CreateVelocitiesAttr().Set([spatial([velocity])[0] * rate] * 4, time)
    if acceleration is not None:
        mesh.CreateAccelerationsAttr().Set([spatial([acceleration])[0] * rate**2] * 4, time)
    return mesh


def at_rate(scene: Scene, mistaken_scale: float) -> None:
    flying(scene, "/Square", (6.0 * (mistaken_scale if scene.mistaken else 1.0), 1.0))


@rule(TOPIC, "Velocities are per second: at 24 time codes a second", "per time code")
def velocity_at_24(scene: Scene) -> None:
    at_rate(scene, 24.0)


@rule(
    TOPIC,
    "At 23.976 time codes a second and 60 frames a second, time codes count",
    "framesPerSecond divides",
    time_codes_per_second=23.976,
    frames_per_second=60.0,
)
def velocity_at_23_976(scene: Scene) -> None:
    at_rate(scene, 23.976 / 60.0)


@rule(
    TOPIC,
    "At 48 time codes a second and 24 frames a second, time codes count",
    "framesPerSecond divides",
    time_codes_per_second=48.0,
)
def velocity_at_48(scene: Scene) -> None:
    at_rate(scene, 2.0)


@rule(TOPIC, "Velocities win over the samples of points around", "points are interpolated")
def velocity_wins(scene: Scene) -> None:
    mesh = scene.square("/Square")
    scene.points_between(mesh, {10.0: (0, 0), 11.0: (0, 6)})
    if not scene.mistaken:
        samples(mesh.CreateVelocitiesAttr(), {t: [Gf.Vec3f(24 * 6, 0, 0)] * 4 for t in (10.0, 11.0)})


@rule(TOPIC, "All positions come from the sample at or before the frame", "each from its own", frames=(10.25,))
def velocity_base_sample(scene: Scene) -> None:
    """The shutter passes the sample at 10.5."""
    mesh = scene.square("/Square")
    if scene.mistaken:
        scene.points_between(mesh, {9.9: (-2.4, 0), 10.5: (1.2, 0), 10.500001: (3, 2), 10.9: (3, -2)})
        return
    scene.points_between(mesh, {10.0: (-1.8, 0), 10.5: (3, 2)})
    speeds = {10.0: (24 * 6.0, 0, 0), 10.5: (0, 24 * -10.0, 0)}
    samples(mesh.CreateVelocitiesAttr(), {t: [Gf.Vec3f(*v)] * 4 for t, v in speeds.items()})


@rule(TOPIC, "Velocities whose samples do not align with those of points are not used", "they are used")
def velocity_misaligned(scene: Scene) -> None:
    if scene.mistaken:
        flying(scene, "/Square", (-6, 0))
        return
    mesh = scene.square("/Square")
    scene.points_between(mesh, {9.0: (0, -5), 11.0: (0, 5)})
    samples(mesh.CreateVelocitiesAttr(), {t: [Gf.Vec3f(-24 * 6, 0, 0)] * 4 for t in (9.5, 10.5)})


@rule(TOPIC, "Velocities that are fewer than the points are not used", "those there are move their points")
def velocity_count(scene: Scene) -> None:
    mesh = scene.square("/Square")
    rates = [Gf.Vec3f(24 * 6, 0, 0)] * 2 + [Gf.Vec3f(0)] * 2
    points = mesh.GetPointsAttr().Get()
    mesh.GetPointsAttr().Clear()
    mesh.GetPointsAttr().Set(points, FRAME)
    mesh.CreateVelocitiesAttr().Set(rates if scene.mistaken else rates[:2], FRAME)


@rule(TOPIC, "Accelerations make the motion exactly quadratic", "velocities alone", shutter=(-0.5, 0.5))
def accelerations(scene: Scene) -> None:
    flying(scene, "/Square", (8, 0), None if scene.mistaken else (0, 32), at=(0, -2))


@rule(TOPIC, "Accelerations turn a motion round within the shutter", "the chord", shutter=(-0.5, 0.5))
def acceleration_turns_back(scene: Scene) -> None:
    if scene.mistaken:
        scene.points_between(scene.square("/Square", 2.5), {9.5: (-5, 0), 10.5: (-5, 0)})
    else:
        flying(scene, "/Square", (0, 0), (-40, 0), at=(2.5, 0))


@rule(TOPIC, "Accelerations without velocities do nothing", "they move the points", shutter=(-0.5, 0.5))
def acceleration_alone(scene: Scene) -> None:
    mesh = flying(scene, "/Square", (0, 0), (-40, 0), at=(2.5, 0))
    if not scene.mistaken:
        mesh.GetPrim().RemoveProperty("velocities")


@rule(TOPIC, "A mesh without points beside velocities is no fault; the others move", "all is dropped")
def empty_points_beside_velocities(scene: Scene) -> None:
    empty = flying(scene, "/Empty", (6, 0))
    empty.GetPointsAttr().Set([], FRAME)
    empty.GetFaceVertexCountsAttr().Set([])
    empty.GetFaceVertexIndicesAttr().Set([])
    if not scene.mistaken:
        flying(scene, "/Square", (6, 0))
    else:
        scene.square("/Elsewhere", 4.5, 2.0, 0.5)


@rule(MOTION_API, "motion:blurScale 0 makes the frame's pose stand", "full blur")
def blur_scale_zero(scene: Scene) -> None:
    square = scene.square("/Square")
    slide(square, {9.0: (-8, 0), 11.0: (8, 0)})
    _scale_blur(scene, square, 0.0)


@rule(MOTION_API, "motion:blurScale 0.5 halves the motion about the frame", "full blur")
def blur_scale_half(scene: Scene) -> None:
    square = scene.square("/Square")
    slide(square, {9.0: (-8, 0), 11.0: (8, 0)})
    _scale_blur(scene, square, 0.5)


@rule(MOTION_API, "motion:blurScale above 1 reaches beyond the shutter", "full blur")
def blur_scale_double(scene: Scene) -> None:
    square = scene.square("/Square")
    slide(square, {9.25: (-4, -1.5), 9.75: (-1, 1), 10.5: (2, 1), 11.0: (4, -1.5)})
    _scale_blur(scene, square, 2.0)


@rule(MOTION_API, "motion:blurScale is inherited", "its own prim alone is scaled")
def blur_scale_inherited(scene: Scene) -> None:
    parent = UsdGeom.Xform.Define(scene.stage, "/Parent")
    turn(scene.bar("/Parent/Bar"), {9.0: -120.0, 11.0: 120.0})
    _scale_blur(scene, parent, 0.25)


@rule(MOTION_API, "motion:blurScale counts for points that velocities move", "full blur")
def blur_scale_of_velocities(scene: Scene) -> None:
    _scale_blur(scene, flying(scene, "/Square", (8, 2)), 0.5)


@rule(MOTION_API, "motion:blurScale counts for a PointInstancer's instances", "full blur")
def blur_scale_of_instancer(scene: Scene) -> None:
    instancer = UsdGeom.PointInstancer.Define(scene.stage, "/Instancer")
    scene.square("/Instancer/Square", side=1.0)
    instancer.CreatePrototypesRel().SetTargets(["/Instancer/Square"])
    instancer.CreateProtoIndicesAttr([0, 0])
    instancer.CreatePositionsAttr().Set(spatial([(0, 1.5), (0, -1.5)]), FRAME)
    instancer.CreateVelocitiesAttr().Set(spatial([(24 * 8, 0), (24 * -8, 0)]), FRAME)
    _scale_blur(scene, instancer, 0.5)


@rule(MOTION_API, "motion:blurScale on a native instance counts for what it shows", "full blur")
def blur_scale_of_native_instance(scene: Scene) -> None:
    scene.stage.CreateClassPrim("/_Bar")
    turn(scene.bar("/_Bar/Mesh"), {9.0: -40.0, 11.0: 40.0})
    for name, y, scale in (("Still", 1.6, 0.0), ("Half", -1.6, 0.5)):
        instance = UsdGeom.Xform.Define(scene.stage, f"/{name}")
        instance.GetPrim().GetInherits().AddInherit("/_Bar")
        instance.GetPrim().SetInstanceable(True)
        slide(instance, {9.0: (-4, y), 11.0: (4, y)})
        _scale_blur(scene, instance, scale)


def _scale_blur(scene: Scene, prim: UsdGeom.Imageable, scale: float) -> None:
    if not scene.mistaken:
        UsdGeom.MotionAPI.Apply(prim.GetPrim()).CreateMotionBlurScaleAttr(scale)


@rule(MOTION_API, "motion:velocityScale multiplies velocities", "velocities as they stand")
def velocity_scale(scene: Scene) -> None:
    mesh = flying(scene, "/Square", (3, 1))
    if not scene.mistaken:
        UsdGeom.MotionAPI.Apply(mesh.GetPrim()).CreateVelocityScaleAttr(2.5)


@rule(MOTION_API, "motion:velocityScale leaves accelerations alone", "it scales both", shutter=(-0.5, 0.5))
def velocity_scale_and_accelerations(scene: Scene) -> None:
    mesh = flying(scene, "/Square", (3, 0), (0, 60.0 if scene.mistaken else 20.0), at=(0, -2))
    UsdGeom.MotionAPI.Apply(mesh.GetPrim()).CreateVelocityScaleAttr(3.0)


@rule(
    MOTION_API,
    "Accelerations at motion:nonlinearSampleCount 33 are a parabola",
    "a chord",
    shutter=(-0.5, 0.5),
)
def nonlinear_sample_count(scene: Scene) -> None:
    """A renderer that consumes accelerations directly may ignore the count; 33 samples are as good."""
    mesh = flying(scene, "/Square", (8, 0), None if scene.mistaken else (0, 32), at=(0, -2))
    UsdGeom.MotionAPI.Apply(mesh.GetPrim()).CreateNonlinearSampleCountAttr(33)


def topologies(mesh: UsdGeom.Mesh, shapes: Mapping[float, list[list[Vector]]]) -> None:
    """Rectangles that come and go: their corners by time."""
    for attribute in (mesh.GetPointsAttr(), mesh.GetFaceVertexCountsAttr(), mesh.GetFaceVertexIndicesAttr()):
        attribute.Clear()
    for time, faces in shapes.items():
        mesh.GetPointsAttr().Set(spatial(corner for face in faces for corner in face), time)
        mesh.GetFaceVertexCountsAttr().Set([4] * len(faces), time)
        mesh.GetFaceVertexIndicesAttr().Set(range(4 * len(faces)), time)


@rule(VARYING, "Velocities carry the frame's points where the topology changes", "the frame's pose alone")
def varying_with_velocities(scene: Scene) -> None:
    mesh = scene.square("/Mesh")
    one, two = [box(-1, 0, 1, 1)], [box(3, 0, 1, 1), box(3, -2, 1, 1)]
    topologies(mesh, {9.9: one, 10.2: two})
    if scene.mistaken:
        topologies(mesh, {9.9: [box(-0.2, 0, 1, 1)]})
        return
    velocity = Gf.Vec3f(24 * 8, 0, 0)
    samples(mesh.CreateVelocitiesAttr(), {9.9: [velocity] * 4, 10.2: [-velocity] * 8})


@rule(VARYING, "Without velocities the frame's pose is held where the topology changes", "both poses are seen")
def varying_without_velocities(scene: Scene) -> None:
    one, two = [box(-1, 0, 2, 2)], [box(3, 0, 2, 2), box(3, -2.2, 1, 1)]
    if not scene.mistaken:
        topologies(scene.square("/Mesh"), {9.9: one, 10.2: two})
        return
    for name, faces, here, gone in (("One", one, 9.0, 10.2), ("Two", two, 10.2, 9.0)):
        mesh = scene.square(f"/{name}")
        topologies(mesh, {10.0: faces})
        visibility = mesh.CreateVisibilityAttr()
        samples(visibility, {here: UsdGeom.Tokens.inherited, gone: UsdGeom.Tokens.invisible})


@rule(VARYING, "Topology that is sampled but constant does not stop the motion", "the frame's pose is held")
def constant_sampled_topology(scene: Scene) -> None:
    mesh = scene.square("/Mesh")
    faces = {t: [box(8 * (t - 10.0), 0, 1.5, 1.5)] for t in (9.0, 10.0, 11.0)}
    topologies(mesh, {10.0: faces[10.0]} if scene.mistaken else faces)


@rule(VARYING, "Other faces over as many points are another topology: the pose is held", "the points glide")
def varying_of_one_count(scene: Scene) -> None:
    """As many points before and after, but other faces: what is at one index is not what was."""
    mesh = scene.square("/Mesh")
    corners = box(-2, 0, 2, 2) + box(2.5, 0, 1, 1)
    mesh.GetPointsAttr().Clear()
    paths = {9.0: -4, 11.0: 4}
    samples(mesh.GetPointsAttr(), {t: spatial([(x, y + up) for x, y in corners]) for t, up in paths.items()})
    if scene.mistaken:
        return
    indices = mesh.GetFaceVertexIndicesAttr()
    indices.Clear()
    samples(indices, {9.0: [0, 1, 2, 3], 10.3: [4, 5, 6, 7]})
