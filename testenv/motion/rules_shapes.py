"""What is drawn while it moves: visibility, purpose, sides, holes, implicit shapes."""

from __future__ import annotations

from authoring import FRAME, Scene, box, rule, samples, slide, spatial, turn
from pxr import Gf, UsdGeom

TOPIC, VISIBILITY = "shapes", "visibility"
ACROSS = {9.0: (-8, 0), 11.0: (8, 0)}


def seen(prim: UsdGeom.Imageable, times: dict[float, bool]) -> None:
    tokens = {t: UsdGeom.Tokens.inherited if is_on else UsdGeom.Tokens.invisible for t, is_on in times.items()}
    samples(prim.CreateVisibilityAttr(), tokens)


@rule(VISIBILITY, "What turns invisible within the shutter is seen until then", "the frame's visibility for all")
def visibility_ends(scene: Scene) -> None:
    square = scene.square("/Square")
    slide(square, ACROSS)
    seen(square, {0.0: True} if scene.mistaken else {0.0: True, 10.2: False})


@rule(VISIBILITY, "What turns visible after the frame is seen from then on", "it is not drawn at all")
def visibility_begins(scene: Scene) -> None:
    square = scene.square("/Square")
    slide(square, ACROSS)
    seen(square, {0.0: False} if scene.mistaken else {0.0: False, 10.1: True})
    scene.square("/Small", 5.5, 2.5, 0.3)


@rule(VISIBILITY, "A parent's visibility within the shutter hides its children", "their own alone")
def visibility_of_parent(scene: Scene) -> None:
    parent = UsdGeom.Xform.Define(scene.stage, "/Parent")
    slide(scene.square("/Parent/Square"), ACROSS)
    if not scene.mistaken:
        seen(parent, {0.0: False, 9.9: True, 10.3: False})


@rule(VISIBILITY, "A native instance may appear within the shutter", "the frame's visibility for all")
def visibility_of_instance(scene: Scene) -> None:
    scene.stage.CreateClassPrim("/_Square")
    scene.square("/_Square/Mesh")
    ways = {"One": (1.5, {0.0: True, 10.125: False}), "Two": (-1.5, {0.0: False, 10.125: True})}
    for name, (y, times) in ways.items():
        prim = UsdGeom.Xform.Define(scene.stage, f"/{name}")
        prim.GetPrim().GetInherits().AddInherit("/_Square")
        prim.GetPrim().SetInstanceable(True)
        slide(prim, {9.0: (-8, y), 11.0: (8, y)})
        seen(prim, {0.0: times[0.0]} if scene.mistaken else times)


@rule(VISIBILITY, "A PointInstancer may vanish within the shutter", "the frame's visibility for all")
def visibility_of_instancer(scene: Scene) -> None:
    instancer = velocity_instancer(scene)
    seen(instancer, {0.0: True} if scene.mistaken else {0.0: True, 10.125: False})


@rule(
    VISIBILITY,
    "What a prototype hides within the shutter is hidden in every instance",
    "the frame's visibility",
)
def visibility_in_prototype(scene: Scene) -> None:
    velocity_instancer(scene)
    part = UsdGeom.Imageable.Get(scene.stage, "/Instancer/Root/Part")
    seen(part, {0.0: False} if scene.mistaken else {0.0: False, 10.1: True})


@rule(
    VISIBILITY, "A prototype that blinks within the shutter blinks in every instance", "the frame's visibility for all"
)
def visibility_of_prototype(scene: Scene) -> None:
    velocity_instancer(scene)
    root = UsdGeom.Imageable.Get(scene.stage, "/Instancer/Root")
    seen(root, {0.0: True} if scene.mistaken else {0.0: True, 9.85: False, 10.25: True})


def velocity_instancer(scene: Scene) -> UsdGeom.PointInstancer:
    """Two flying instances of two squares each, /Instancer/Root/Whole and Part."""
    instancer = UsdGeom.PointInstancer.Define(scene.stage, "/Instancer")
    UsdGeom.Xform.Define(scene.stage, "/Instancer/Root")
    scene.square("/Instancer/Root/Whole", 0, 0.9, 0.4)
    scene.square("/Instancer/Root/Part", 0, -0.4, 1.4)
    instancer.CreatePrototypesRel().SetTargets(["/Instancer/Root"])
    instancer.CreateProtoIndicesAttr([0, 0])
    instancer.CreatePositionsAttr().Set(spatial([(-1, 1.6), (1, -1.6)]), FRAME)
    instancer.CreateVelocitiesAttr().Set(spatial([(24 * 6, 0), (-24 * 6, 0)]), FRAME)
    return instancer


@rule(VISIBILITY, "What is invisible all the time is not drawn, however it moves", "it is drawn")
def invisible(scene: Scene) -> None:
    slide(scene.square("/Small", side=0.5), {9.0: (-8, 2), 11.0: (8, 2)})
    square = scene.square("/Square")
    slide(square, ACROSS)
    if not scene.mistaken:
        square.CreateVisibilityAttr(UsdGeom.Tokens.invisible)


@rule(VISIBILITY, "Purpose guide is not drawn", "it is drawn")
def purpose_guide(scene: Scene) -> None:
    slide(scene.square("/Small", side=0.5), {9.0: (-8, 2), 11.0: (8, 2)})
    parent = UsdGeom.Xform.Define(scene.stage, "/Guides")
    slide(scene.square("/Guides/Square"), ACROSS)
    if not scene.mistaken:
        parent.CreatePurposeAttr(UsdGeom.Tokens.guide)


@rule(TOPIC, "leftHanded turns the sides round, and leaves coverage as it is", "back faces are culled")
def left_handed(scene: Scene) -> None:
    for name, y, orientation in (("Left", 1.5, "leftHanded"), ("Right", -1.5, "rightHanded")):
        square = scene.square(f"/{name}")
        slide(square, {9.0: (-8, y), 11.0: (8, y)})
        square.CreateOrientationAttr(orientation)
        if scene.mistaken and name == "Left":
            square.CreateVisibilityAttr(UsdGeom.Tokens.invisible)


@rule(TOPIC, "Holes are open, and move with their mesh", "they are filled")
def holes(scene: Scene) -> None:
    mesh = scene.square("/Mesh")
    frame = [(x, y) for y in (-2.4, -0.8, 0.8, 2.4) for x in (-2.4, -0.8, 0.8, 2.4)]
    mesh.GetPointsAttr().Set(spatial(frame))
    mesh.GetFaceVertexCountsAttr().Set([4] * 9)
    corners = [4 * j + i for j in range(3) for i in range(3)]
    mesh.GetFaceVertexIndicesAttr().Set([k for c in corners for k in (c, c + 1, c + 5, c + 4)])
    if not scene.mistaken:
        mesh.CreateHoleIndicesAttr([4, 2])
    slide(mesh, {9.0: (-2, 0), 11.0: (2, 0)})
    turn(mesh, {9.0: -30.0, 11.0: 10.0})


@rule(TOPIC, "Holes that change within the shutter are open for a part of it", "the frame's for all")
def holes_change(scene: Scene) -> None:
    mesh = scene.square("/Mesh")
    mesh.GetPointsAttr().Set(spatial([c for x in (-4, 0, 4) for c in box(x, 0, 3, 3)]))
    mesh.GetFaceVertexCountsAttr().Set([4] * 3)
    mesh.GetFaceVertexIndicesAttr().Set(range(12))
    samples(mesh.CreateHoleIndicesAttr(), {9.0: [0, 1]} if scene.mistaken else {9.0: [0, 1], 10.1: [2], 10.3: [1]})
    slide(mesh, {9.0: (0, -1), 11.0: (0, 1)})


@rule(TOPIC, "Faces of many corners turn as a whole", "their first triangles alone")
def many_corners(scene: Scene) -> None:
    corners = [(0, -2), (2, -1), (2.5, 0.5), (1, 2), (-1, 2), (-2.5, 0.5), (-2, -1)]
    turn(scene.polygon("/Polygon", corners[:4] if scene.mistaken else corners), {9.0: -100.0, 11.0: 100.0})


@rule(TOPIC, "A cube turns in space")
def cube_turns(scene: Scene) -> None:
    cube = UsdGeom.Cube.Define(scene.stage, "/Cube")
    samples(UsdGeom.Xformable(cube).AddRotateYOp(), {9.0: 0.0, 11.0: 240.0})
    UsdGeom.Xformable(cube).AddScaleOp().Set(Gf.Vec3f(2.0, 1.0, 0.3))


@rule(
    TOPIC,
    "A sphere's radius grows over the shutter",
    "the frame's radius",
    slack=0.01,
    slack_reason="renderers' tessellations of the sphere differ by a fraction of a pixel along its rim",
)
def sphere_grows(scene: Scene) -> None:
    radius = UsdGeom.Sphere.Define(scene.stage, "/Sphere").CreateRadiusAttr()
    samples(radius, {10.0: 1.5} if scene.mistaken else {9.0: -1.0, 9.75: 0.9, 10.5: 2.6})


@rule(TOPIC, "Two that move as one count once", "alphas are composited as if they were independent")
def moving_as_one(scene: Scene) -> None:
    """Statistical alpha of two shapes one behind the other would be 1 - (1 - a) (1 - a)."""
    ways = (1, -1) if scene.mistaken else (1, 1)
    for name, way, depth in (("Near", ways[0], 0.0), ("Far", ways[1], -0.01)):
        mesh = scene.polygon(f"/{name}", box(0, 0, 1.5, 3))
        slide(mesh, {9.0: (-8 * way, 0, depth), 11.0: (8 * way, 0, depth)})
