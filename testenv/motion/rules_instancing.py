"""Native instances and point instancers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from authoring import FRAME, STILL, Scene, Vector, place, rule, samples, slide, spatial, turn
from pxr import Gf, Sdf, UsdGeom

NATIVE, POINT = "native instances", "point instancers"
FULL = (-0.5, 0.5)


def definition(scene: Scene, path: str, bar: bool = False) -> None:
    """A class with a wedge or a bar inside, for instances to inherit."""
    scene.stage.CreateClassPrim(path)
    UsdGeom.Xform.Define(scene.stage, f"{path}/Geometry")
    (scene.bar if bar else scene.wedge)(f"{path}/Geometry/Mesh")


def instance(scene: Scene, path: str, inherited: str, instanceable: bool = True) -> UsdGeom.Xform:
    prim = UsdGeom.Xform.Define(scene.stage, path)
    prim.GetPrim().GetInherits().AddInherit(inherited)
    prim.GetPrim().SetInstanceable(instanceable)
    return prim


@rule(NATIVE, "The motion of every ancestor of an instance counts", "the instance's own alone")
def instance_ancestors(scene: Scene) -> None:
    definition(scene, "/_Wedge")
    top = UsdGeom.Xform.Define(scene.stage, "/A")
    if not scene.mistaken:
        slide(top, {9.0: (-5, 0), 11.0: (5, 0)})
    turn(UsdGeom.Xform.Define(scene.stage, "/A/B"), {9.0: -50.0, 11.0: 70.0})
    place(instance(scene, "/A/B/One", "/_Wedge"), 0.5, 0.3)
    place(instance(scene, "/A/B/Two", "/_Wedge"), -2.5, -1.0)


@rule(NATIVE, "Instanceable on and off give the same picture", "the instanced half stands still")
def instanceable_on_and_off(scene: Scene) -> None:
    definition(scene, "/_Wedge")
    for path, height, instanceable in (("/On", 1.0, True), ("/Off", -2.0, False)):
        parent = UsdGeom.Xform.Define(scene.stage, path)
        if not (scene.mistaken and instanceable):
            slide(parent, {9.0: (-6, 0), 11.0: (6, 0)})
        place(instance(scene, f"{path}/Instance", "/_Wedge", instanceable), 0, height)


@rule(NATIVE, "What moves inside an instance moves in each of them")
def instance_with_motion_inside(scene: Scene) -> None:
    definition(scene, "/_Bar", bar=True)
    turn(UsdGeom.Xform.Get(scene.stage, "/_Bar/Geometry"), {9.0: -90.0, 11.0: 90.0})
    place(instance(scene, "/One", "/_Bar"), -3, 0)
    slide(instance(scene, "/Two", "/_Bar"), {9.0: (0, 0), 11.0: (6, 0)})


@rule(NATIVE, "Points that deform inside an instance deform in each of them")
def instance_with_points_inside(scene: Scene) -> None:
    definition(scene, "/_Wedge")
    scene.points_between(UsdGeom.Mesh.Get(scene.stage, "/_Wedge/Geometry/Mesh"), {9.0: (0, -5), 11.0: (0, 5)})
    place(instance(scene, "/One", "/_Wedge"), -4, 0)
    turn(instance(scene, "/Two", "/_Wedge"), {9.0: -60.0, 11.0: 90.0})


@rule(NATIVE, "Instances inside instances move with both", "with the outer one alone")
def instance_in_instance(scene: Scene) -> None:
    definition(scene, "/_Wedge")
    scene.stage.CreateClassPrim("/_Pair")
    for name, height, angle in (("Up", 0.5, 90.0), ("Down", -1.5, -90.0)):
        inner = instance(scene, f"/_Pair/{name}", "/_Wedge")
        place(inner, 0, height)
        turn(inner, {10.0: 0.0} if scene.mistaken else {9.0: -angle, 11.0: angle})
    slide(instance(scene, "/Left", "/_Pair"), {9.0: (-6, 0), 11.0: (0, 0)})
    slide(instance(scene, "/Right", "/_Pair"), {9.0: (6, 0), 11.0: (0, 0)})


@rule(NATIVE, "!resetXformStack! inside an instance leads to the stage's root", "it moves with the instance")
def instance_reset_inside(scene: Scene) -> None:
    definition(scene, "/_Wedge")
    apart = scene.square("/_Wedge/Apart", side=1.0)
    if not scene.mistaken:
        apart.SetResetXformStack(True)
    slide(apart, {9.0: (-2, 2), 11.0: (2, 2)})
    for name, x in (("One", -4), ("Two", 1)):
        slide(instance(scene, f"/{name}", "/_Wedge"), {9.0: (x - 2, 1.5), 11.0: (x + 2, -4.5)})


@rule(NATIVE, "motion:blurScale inside an instance scales the instance's motion there", "its own motion alone")
def instance_blur_scale_inside(scene: Scene) -> None:
    definition(scene, "/_Wedge")
    inside = scene.square("/_Wedge/Inside", 0, -1.5)
    if not scene.mistaken:
        UsdGeom.MotionAPI.Apply(inside.GetPrim()).CreateMotionBlurScaleAttr(0.0)
    for name, x in (("One", -3), ("Two", 2)):
        slide(instance(scene, f"/{name}", "/_Wedge"), {9.0: (x - 4, 0), 11.0: (x + 4, 1)})


def point_instancer(
    scene: Scene, positions: Sequence[Vector], path: str = "/Instancer", prototypes: Sequence[str] = ()
) -> UsdGeom.PointInstancer:
    """Without `prototypes`, of one wedge. Positions are sampled at the frame."""
    instancer = UsdGeom.PointInstancer.Define(scene.stage, path)
    if not prototypes:
        scene.wedge(f"{path}/Wedge")
    instancer.CreatePrototypesRel().SetTargets(list(prototypes) or [f"{path}/Wedge"])
    instancer.CreateProtoIndicesAttr([i % max(len(prototypes), 1) for i in range(len(positions))])
    instancer.CreatePositionsAttr().Set(spatial(positions), FRAME)
    return instancer


def positions_between(instancer: UsdGeom.PointInstancer, places: Mapping[float, Sequence[Vector]]) -> None:
    instancer.GetPositionsAttr().Clear()
    samples(instancer.GetPositionsAttr(), {time: spatial(values) for time, values in places.items()})


def quaternion(degrees: float, kind: type = Gf.Quath) -> object:
    return kind(Gf.Rotation(Gf.Vec3d.ZAxis(), degrees).GetQuat())


@rule(POINT, "Positions are interpolated between their samples")
def instancer_positions(scene: Scene) -> None:
    instancer = point_instancer(scene, [(0, 0)] * 2)
    positions_between(instancer, {9.0: [(-8, 1), (6, -2)], 11.0: [(6, 1), (-8, -2)]})


@rule(POINT, "Orientations are interpolated along the sphere", STILL, shutter=FULL)
def instancer_orientations(scene: Scene) -> None:
    instancer = point_instancer(scene, [(-3, 0), (3, 0)])
    turns = {9.5: (0.0, 0.0), 10.5: (170.0, -100.0)}
    samples(instancer.CreateOrientationsAttr(), {t: [quaternion(a) for a in v] for t, v in turns.items()})


@rule(POINT, "orientationsf wins over orientations", "orientations", shutter=FULL)
def instancer_orientationsf(scene: Scene) -> None:
    instancer = point_instancer(scene, [(-3, 0), (3, 0)])
    samples(
        instancer.CreateOrientationsAttr(),
        {t: [quaternion(a)] * 2 for t, a in {9.5: 0.0, 10.5: 120.0}.items()},
    )
    if not scene.mistaken:
        turns = {9.5: 180.0, 10.5: 280.0}
        values = {t: [quaternion(a, Gf.Quatf)] * 2 for t, a in turns.items()}
        samples(instancer.CreateOrientationsfAttr(), values)


@rule(POINT, "Scales are interpolated", STILL, shutter=FULL)
def instancer_scales(scene: Scene) -> None:
    instancer = point_instancer(scene, [(-5, -2), (1, -1)])
    sizes = {9.5: [(0.5, 3, 1), (1, 1, 1)], 10.5: [(2.5, 0.5, 1), (2, -1.5, 1)]}
    samples(instancer.CreateScalesAttr(), {t: spatial(v) for t, v in sizes.items()})


@rule(POINT, "Velocities are per second, and carry the instances", "positions are interpolated")
def instancer_velocities(scene: Scene) -> None:
    instancer = point_instancer(scene, [(-2, 1), (2, -2)])
    ahead = [(-2, -3), (2, 2)]
    positions_between(instancer, {10.0: [(-2, 1), (2, -2)], 11.0: ahead})
    if not scene.mistaken:
        rates = spatial([(24 * 8, 0), (-24 * 8, 0)])
        samples(instancer.CreateVelocitiesAttr(), {10.0: rates, 11.0: rates})


@rule(POINT, "Accelerations bend the instances' paths to parabolas", "velocities alone", shutter=FULL)
def instancer_accelerations(scene: Scene) -> None:
    instancer = point_instancer(scene, [(-3, -2), (2, 1)])
    instancer.CreateVelocitiesAttr().Set(spatial([(24 * 5, 0), (0, 0)]), FRAME)
    if not scene.mistaken:
        rates = [(0, 24**2 * 24), (24**2 * -24, 0)]
        instancer.CreateAccelerationsAttr().Set(spatial(rates), FRAME)


@rule(POINT, "Angular velocities are degrees per second about the instance", "radians", shutter=FULL)
def instancer_angular_velocities(scene: Scene) -> None:
    instancer = point_instancer(scene, [(-3, 0), (2.5, 0)])
    instancer.CreateOrientationsAttr().Set([quaternion(20.0), quaternion(-45.0)], FRAME)
    unit = 24 * (57.29577951308232 / 8 if scene.mistaken else 1.0)
    instancer.CreateAngularVelocitiesAttr().Set(spatial([(0, 0, 120 * unit), (0, 0, -240 * unit)]), FRAME)


@rule(POINT, "An instancer's own motion and its instances' add up", "the instances' alone")
def instancer_moves(scene: Scene) -> None:
    parent = UsdGeom.Xform.Define(scene.stage, "/Parent")
    if not scene.mistaken:
        turn(parent, {9.0: -70.0, 11.0: 70.0})
    instancer = point_instancer(scene, [(0, 0)] * 2, "/Parent/Instancer")
    positions_between(instancer, {9.0: [(-5, 0.5), (3, -1)], 11.0: [(1, 0.5), (-1, -1)]})


@rule(POINT, "A prototype that moves by itself moves in every instance", "the instances' motion alone")
def instancer_prototype_moves(scene: Scene) -> None:
    root = UsdGeom.Xform.Define(scene.stage, "/Instancer/Root")
    bar = scene.bar("/Instancer/Root/Bar")
    turn(root, {10.0: 0.0} if scene.mistaken else {9.0: -80.0, 11.0: 80.0})
    scene.points_between(bar, {10.0: (0, 0)} if scene.mistaken else {9.0: (0, -1), 11.0: (0, 1)})
    point_instancer(scene, [(-3, 0), (3, 0)], prototypes=["/Instancer/Root"])


@rule(POINT, "Nested instancers move with both", "with the outer one alone")
def instancer_nested(scene: Scene) -> None:
    UsdGeom.PointInstancer.Define(scene.stage, "/Outer")
    inner = point_instancer(scene, [(-1, 0), (1, 0)], "/Outer/Inner")
    if not scene.mistaken:
        positions_between(inner, {9.0: [(-1, -3), (1, 3)], 11.0: [(-1, 3), (1, -3)]})
    outer = point_instancer(scene, [(-3, 0), (3, 0)], "/Outer", ["/Outer/Inner"])
    positions_between(outer, {9.0: [(-5, 0), (5, 0)], 11.0: [(-1, 0), (1, 0)]})


@rule(POINT, "Native instances inside a prototype move with it", "they are not drawn")
def instancer_of_native_instances(scene: Scene) -> None:
    definition(scene, "/_Wedge")
    UsdGeom.Xform.Define(scene.stage, "/Instancer/Root")
    scene.square("/Instancer/Root/Square", 0, -2, 0.8)
    if not scene.mistaken:
        turn(instance(scene, "/Instancer/Root/Wedge", "/_Wedge"), {9.0: -60.0, 11.0: 60.0})
    instancer = point_instancer(scene, [(0, 0)] * 2, prototypes=["/Instancer/Root"])
    positions_between(instancer, {9.0: [(-6, 0), (4, 0)], 11.0: [(-1, 0), (0, 0)]})


@rule(POINT, "An instancer inside a native instance moves with it", "it is not drawn")
def instancer_in_native_instance(scene: Scene) -> None:
    scene.stage.CreateClassPrim("/_Set")
    scene.square("/_Set/Square", 0, -2, 0.8)
    if not scene.mistaken:
        instancer = point_instancer(scene, [(0, 0)] * 2, "/_Set/Instancer")
        positions_between(instancer, {9.0: [(-2, 0), (1, -1)], 11.0: [(0, 0), (1, 1)]})
    slide(instance(scene, "/One", "/_Set"), {9.0: (-6, 0), 11.0: (-1, 0)})
    turn(instance(scene, "/Two", "/_Set"), {9.0: 60.0, 11.0: 120.0})


def in_rows(x: float) -> list[Vector]:
    """Three places one above the other."""
    return [(x, y) for y in (-2.5, -0.5, 1.5)]


@rule(POINT, "invisibleIds are not drawn", "every instance is drawn")
def instancer_invisible_ids(scene: Scene) -> None:
    instancer = point_instancer(scene, [(0, 0)] * 3)
    positions_between(instancer, {9.0: in_rows(-3), 11.0: in_rows(3)})
    instancer.CreateIdsAttr([7, 5, 3])
    if not scene.mistaken:
        instancer.CreateInvisibleIdsAttr([5])


@rule(POINT, "inactiveIds are not drawn", "every instance is drawn")
def instancer_inactive_ids(scene: Scene) -> None:
    instancer = point_instancer(scene, [(0, 0)] * 3)
    positions_between(instancer, {9.0: in_rows(-3), 11.0: in_rows(3)})
    instancer.CreateIdsAttr([7, 5, 3])
    if not scene.mistaken:
        instancer.DeactivateIds([7, 3])


def two_prototypes(scene: Scene) -> UsdGeom.PointInstancer:
    """Two wedges that fly, and two small squares that do."""
    scene.wedge("/Instancer/Prototypes/Wedge")
    scene.square("/Instancer/Prototypes/Square", side=0.6)
    prototypes = ["/Instancer/Prototypes/Wedge", "/Instancer/Prototypes/Square"]
    instancer = point_instancer(scene, [(-3, 1), (-1, -2), (2, 0), (4, -1)], prototypes=prototypes)
    instancer.CreateVelocitiesAttr().Set(spatial([(24 * 6, 0), (0, 24 * 6)] * 2), FRAME)
    return instancer


@rule(POINT, "A prototype that is invisible itself is not drawn", "it is drawn")
def instancer_invisible_prototype(scene: Scene) -> None:
    two_prototypes(scene)
    if not scene.mistaken:
        wedge = UsdGeom.Imageable.Get(scene.stage, "/Instancer/Prototypes/Wedge")
        wedge.CreateVisibilityAttr(UsdGeom.Tokens.invisible)


@rule(POINT, "What hides the ancestors of a prototype does not hide its instances", "they are not drawn")
def instancer_hidden_prototypes(scene: Scene) -> None:
    if not scene.mistaken:
        two_prototypes(scene)
        UsdGeom.Scope.Define(scene.stage, "/Instancer/Prototypes").MakeInvisible()
    scene.square("/Small", 5.5, 2.5, 0.3)


@rule(POINT, "Prototypes below an instancer are not drawn by themselves", "they are drawn too")
def instancer_prunes_prototypes(scene: Scene) -> None:
    instancer = point_instancer(scene, [(-4, 1), (3, 1)])
    instancer.CreateVelocitiesAttr().Set(spatial([(24 * 4, 0), (24 * 4, 0)]), FRAME)
    scene.square("/Instancer/Spare", 0, -1.5)
    if scene.mistaken:
        scene.wedge("/Wedge")
        scene.square("/Spare", 0, -1.5)


@rule(POINT, "A prototype may be an over, which nothing else draws", "it is not drawn")
def instancer_over_prototype(scene: Scene) -> None:
    if not scene.mistaken:
        instancer = point_instancer(scene, [(-3, 0), (2, 0)])
        instancer.CreateVelocitiesAttr().Set(spatial([(24 * 6, 0), (0, 24 * 6)]), FRAME)
        scene.stage.OverridePrim("/Elsewhere")
        scene.wedge("/Elsewhere/Wedge")
        scene.stage.GetPrimAtPath("/Elsewhere").SetSpecifier(Sdf.SpecifierOver)
        instancer.GetPrototypesRel().SetTargets(["/Elsewhere"])
    scene.square("/Small", 5.5, 2.5, 0.3)


@rule(POINT, "Velocities carry the frame's instances where their number changes", "the frame's places alone")
def instancer_count_changes(scene: Scene) -> None:
    instancer = point_instancer(scene, [(0, 0)])
    positions_between(instancer, {9.9: [(-3, 1), (2, -1)], 10.2: [(0, 2), (4, 2), (4, -2), (0, -2)]})
    indices = instancer.GetProtoIndicesAttr()
    indices.Clear()
    samples(indices, {9.9: [0] * 2, 10.2: [0] * 4})
    speed = 0.0 if scene.mistaken else 24 * 8.0
    rates = {9.9: spatial([(speed, 0), (-speed, 0)]), 10.2: spatial([(0, speed)] * 4)}
    samples(instancer.CreateVelocitiesAttr(), rates)


@rule(POINT, "motion:velocityScale multiplies an instancer's velocities", "velocities as they stand")
def instancer_velocity_scale(scene: Scene) -> None:
    instancer = point_instancer(scene, [(-3, 0), (1, 0)])
    instancer.CreateVelocitiesAttr().Set(spatial([(24 * 3, 0), (0, 24 * 3)]), FRAME)
    instancer.CreateAngularVelocitiesAttr().Set(spatial([(0, 0, 24 * 40), (0, 0, 24 * -40)]), FRAME)
    instancer.CreateOrientationsAttr().Set([quaternion(0.0)] * 2, FRAME)
    if not scene.mistaken:
        UsdGeom.MotionAPI.Apply(instancer.GetPrim()).CreateVelocityScaleAttr(2.5)


@rule(POINT, "Several prototypes each draw their own instances", "the first for all")
def instancer_prototypes(scene: Scene) -> None:
    scene.wedge("/Instancer/Wedge")
    scene.bar("/Instancer/Bar")
    instancer = point_instancer(scene, [(-3, 1), (1, -1), (2, 1.5)], prototypes=["/Instancer/Wedge", "/Instancer/Bar"])
    instancer.GetProtoIndicesAttr().Set([0, 0, 0] if scene.mistaken else [1, 0, 1])
    instancer.CreateVelocitiesAttr().Set(spatial([(24 * 4, 0)] * 3), FRAME)


@rule(POINT, "protoIndices and invisibleIds that change within the shutter count from then on", "the frame's for all")
def instancer_indices_change(scene: Scene) -> None:
    scene.square("/Instancer/Square", 0, 0, 2.0)
    scene.bar("/Instancer/Bar")
    instancer = point_instancer(scene, [(0, 0)] * 3, prototypes=["/Instancer/Square", "/Instancer/Bar"])
    positions_between(instancer, {9.0: [(-5, 1), (0, 0), (4, -2)], 11.0: [(-3, 0), (1, 1), (4, -1)]})
    indices = instancer.GetProtoIndicesAttr()
    indices.Clear()
    samples(indices, {9.0: [0, 1, 0]} if scene.mistaken else {9.0: [0, 1, 0], 10.1: [1, 0, 0]})
    instancer.CreateIdsAttr([7, 8, 9])
    samples(instancer.CreateInvisibleIdsAttr(), {9.0: []} if scene.mistaken else {9.0: [], 10.25: [9]})


@rule(POINT, "A prototype's root moves by its own motion:blurScale, its instances by the instancer's", "by the latter")
def instancer_root_blur_scale(scene: Scene) -> None:
    root = UsdGeom.Xform.Define(scene.stage, "/Instancer/Root")
    scene.wedge("/Instancer/Root/Wedge")
    slide(root, {9.0: (0, -9), 11.0: (0, 9)})
    instancer = point_instancer(scene, [(0, 0)] * 2, prototypes=["/Instancer/Root"])
    positions_between(instancer, {9.0: [(-5, -1), (1, -1)], 11.0: [(-1, 1), (3, 1)]})
    for prim, scale in ((root, 2.0 if scene.mistaken else 0.0), (instancer, 2.0)):
        UsdGeom.MotionAPI.Apply(prim.GetPrim()).CreateMotionBlurScaleAttr(scale)
