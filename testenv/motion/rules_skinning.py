"""UsdSkel: skinning and blend shapes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from authoring import STILL, Scene, place, rule, samples, slide, spatial, turn
from pxr import Gf, Sdf, UsdGeom, UsdSkel, Vt

TOPIC = "skinning"
FULL = (-0.5, 0.5)
COLUMNS = 13
"""Of vertices along the arm."""


def arm(scene: Scene, path: str = "/Root", columns: int = COLUMNS, half_width: float = 0.4) -> UsdGeom.Mesh:
    """A strip along x from -2 to 2 under a SkelRoot, with two joints: one at -2, one in the middle."""
    UsdSkel.Root.Define(scene.stage, path)
    skeleton = UsdSkel.Skeleton.Define(scene.stage, f"{path}/Skeleton")
    skeleton.CreateJointsAttr(["Upper", "Upper/Lower"])
    places = [Gf.Matrix4d().SetTranslate(Gf.Vec3d(x, 0, 0)) for x in (-2, 0)]
    skeleton.CreateBindTransformsAttr(places)
    skeleton.CreateRestTransformsAttr([places[0], Gf.Matrix4d().SetTranslate(Gf.Vec3d(2, 0, 0))])
    mesh = UsdGeom.Mesh.Define(scene.stage, f"{path}/Mesh")
    mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    along = [-2 + 4 * i / (columns - 1) for i in range(columns)]
    mesh.CreatePointsAttr(spatial([(x, y) for y in (-half_width, half_width) for x in along]))
    mesh.CreateFaceVertexCountsAttr([4] * (columns - 1))
    n = columns
    mesh.CreateFaceVertexIndicesAttr([k for i in range(n - 1) for k in (i, i + 1, n + i + 1, n + i)])
    binding = UsdSkel.BindingAPI.Apply(mesh.GetPrim())
    binding.CreateSkeletonRel().SetTargets([skeleton.GetPath()])
    weights = [min(max((x + 1) / 2, 0.0), 1.0) for x in along] * 2
    binding.CreateJointIndicesPrimvar(False, 2).Set([0, 1] * (2 * n))
    binding.CreateJointWeightsPrimvar(False, 2).Set([w for lower in weights for w in (1 - lower, lower)])
    return mesh


def animate(
    scene: Scene,
    angles: Mapping[float, tuple[float, float]],
    path: str = "/Root",
    axis: tuple[float, float, float] = (0, 0, 1),
) -> UsdSkel.Animation:
    """Rotations in degrees of both joints by time; binds the animation to the skeleton."""
    animation = UsdSkel.Animation.Define(scene.stage, f"{path}/Animation")
    animation.CreateJointsAttr(["Upper", "Upper/Lower"])
    animation.CreateTranslationsAttr([Gf.Vec3f(-2, 0, 0), Gf.Vec3f(2, 0, 0)])
    animation.CreateScalesAttr([Gf.Vec3h(1)] * 2)
    turns = {t: [Gf.Quatf(Gf.Rotation(Gf.Vec3d(*axis), a).GetQuat()) for a in pair] for t, pair in angles.items()}
    samples(animation.CreateRotationsAttr(), turns)
    bind(scene, f"{path}/Skeleton", animation)
    return animation


def bind(scene: Scene, skeleton: str, animation: UsdSkel.Animation) -> None:
    binding = UsdSkel.BindingAPI.Apply(scene.stage.GetPrimAtPath(skeleton))
    binding.CreateAnimationSourceRel().SetTargets([animation.GetPath()])


@rule(TOPIC, "Linear blend skinning over the shutter", "the bind pose", shutter=FULL)
def skin_linear(scene: Scene) -> None:
    mesh = arm(scene)
    if scene.mistaken:
        mesh.GetPrim().RemoveAPI(UsdSkel.BindingAPI)
    animate(scene, {9.5: (0.0, 0.0), 10.5: (30.0, 140.0)})


@rule(TOPIC, "Joints truly rotate between samples", "skinned points run along chords", shutter=FULL)
def skin_rotates(scene: Scene) -> None:
    arm(scene)
    ends = {9.5: (0.0, 0.0), 10.5: (170.0, 0.0)}
    if not scene.mistaken:
        animate(scene, ends)
        return
    scene.stage.RemovePrim("/Root")
    mesh = scene.polygon("/Chord", [(-2, -0.4), (2, -0.4), (2, 0.4), (-2, 0.4)])
    own = mesh.GetPointsAttr().Get()
    mesh.GetPointsAttr().Clear()
    for time, (angle, _) in ends.items():
        turned = Gf.Matrix4d().SetRotate(Gf.Rotation(Gf.Vec3d.ZAxis(), angle))
        about = Gf.Vec3d(-2, 0, 0)
        mesh.GetPointsAttr().Set([Gf.Vec3f(turned.Transform(Gf.Vec3d(p) - about) + about) for p in own], time)


@rule(TOPIC, "Dual-quaternion skinning does not collapse where joints twist", "linear blending", shutter=FULL)
def skin_dual_quaternion(scene: Scene) -> None:
    mesh = arm(scene)
    binding = UsdSkel.BindingAPI(mesh)
    binding.CreateSkinningMethodAttr("classicLinear" if scene.mistaken else "dualQuaternion")
    animate(scene, {9.5: (0.0, 150.0), 10.5: (0.0, 175.0)}, axis=(1, 0, 0))


@rule(TOPIC, "A skeleton's own transform moves what it skins, in place of the mesh's", "the mesh's own")
def skin_moving_skeleton(scene: Scene) -> None:
    mesh = arm(scene)
    animate(scene, {9.5: (0.0, 0.0), 10.5: (0.0, 90.0)})
    if scene.mistaken:
        slide(mesh, {9.0: (0, -6), 11.0: (0, 6)})
        mesh.GetPrim().RemoveAPI(UsdSkel.BindingAPI)
    else:
        slide(mesh, {9.0: (0, -6), 11.0: (0, 6)})
        slide(UsdSkel.Skeleton.Get(scene.stage, "/Root/Skeleton"), {9.0: (-5, 0), 11.0: (5, 0)})


@rule(TOPIC, "geomBindTransform places the mesh in the skeleton's space", "it is left out")
def skin_geom_bind_transform(scene: Scene) -> None:
    mesh = arm(scene)
    if not scene.mistaken:
        bind_space = Gf.Matrix4d().SetScale(Gf.Vec3d(1, 2, 1)) * Gf.Matrix4d().SetTranslate(Gf.Vec3d(0.5, -1, 0))
        UsdSkel.BindingAPI(mesh).CreateGeomBindTransformAttr(bind_space)
    animate(scene, {9.5: (-20.0, 0.0), 10.5: (20.0, 90.0)})


@rule(TOPIC, "A mesh of constant influences follows its joint rigidly", "the bind pose")
def skin_rigid(scene: Scene) -> None:
    arm(scene)
    scene.stage.RemovePrim("/Root/Mesh")
    square = scene.square("/Root/Mesh", 1.5, 0)
    if not scene.mistaken:
        binding = UsdSkel.BindingAPI.Apply(square.GetPrim())
        binding.CreateSkeletonRel().SetTargets(["/Root/Skeleton"])
        binding.CreateJointIndicesPrimvar(True, 1).Set([1])
        binding.CreateJointWeightsPrimvar(True, 1).Set([1.0])
    animate(scene, {9.5: (0.0, 0.0), 10.5: (20.0, 120.0)})


@rule(
    TOPIC,
    "Joint samples beyond the shutter bracket it",
    "samples inside the shutter alone",
    shutter=(-0.1, 0.1),
)
def skin_bracketing(scene: Scene) -> None:
    arm(scene)
    animate(scene, {10.0: (0.0, 0.0)} if scene.mistaken else {9.0: (-90.0, -90.0), 11.0: (90.0, 90.0)})


@rule(TOPIC, "Animated instances of one skeleton each play their own animation", "all play the first's")
def skin_instances(scene: Scene) -> None:
    """The animation is bound on the instances, as USD's schema has it: inherited by the skeleton inside."""
    scene.stage.CreateClassPrim("/_Arm")
    arm(scene, "/_Arm/Root")
    for name, x, ends in (("One", -3, (0.0, 120.0)), ("Two", 3, (0.0, -120.0))):
        prim = UsdGeom.Xform.Define(scene.stage, f"/{name}")
        prim.GetPrim().GetInherits().AddInherit("/_Arm")
        prim.GetPrim().SetInstanceable(True)
        place(prim, x, 0)
        shown = (0.0, 120.0) if scene.mistaken else ends
        UsdGeom.Xform.Define(scene.stage, f"/Animations/{name}")
        UsdSkel.Skeleton.Define(scene.stage, f"/Animations/{name}/Skeleton")
        animation = animate(scene, {9.5: (0, shown[0]), 10.5: (0, shown[1])}, f"/Animations/{name}")
        scene.stage.RemovePrim(f"/Animations/{name}/Skeleton")
        bind(scene, f"/{name}", animation)


def blend_shape(scene: Scene, weights: Mapping[float, Sequence[float]], middle: bool = False) -> None:
    """A square whose two upper corners a shape moves; by way of another place at weight 0.5 if `middle`."""
    UsdSkel.Root.Define(scene.stage, "/Root")
    square = scene.square("/Root/Mesh", 0, -1.5, 1.5)
    shape = UsdSkel.BlendShape.Define(scene.stage, "/Root/Mesh/Stretch")
    shape.CreateOffsetsAttr(spatial([(3, 3), (3, 3)]))
    shape.CreatePointIndicesAttr([2, 3])
    if middle:
        between = shape.CreateInbetween("half")
        between.SetWeight(0.5)
        between.SetOffsets(Vt.Vec3fArray(spatial([(-3, 1), (-3, 1)])))
    skeleton = UsdSkel.Skeleton.Define(scene.stage, "/Root/Skeleton")
    skeleton.CreateJointsAttr(["Joint"])
    skeleton.CreateBindTransformsAttr([Gf.Matrix4d(1)])
    skeleton.CreateRestTransformsAttr([Gf.Matrix4d(1)])
    animation = UsdSkel.Animation.Define(scene.stage, "/Root/Animation")
    animation.CreateBlendShapesAttr(["stretch"])
    samples(animation.CreateBlendShapeWeightsAttr(), {t: Vt.FloatArray(v) for t, v in weights.items()})
    bind(scene, "/Root/Skeleton", animation)
    binding = UsdSkel.BindingAPI.Apply(square.GetPrim())
    binding.CreateSkeletonRel().SetTargets(["/Root/Skeleton"])
    binding.CreateBlendShapesAttr(["stretch"])
    binding.CreateBlendShapeTargetsRel().SetTargets([Sdf.Path("/Root/Mesh/Stretch")])


@rule(TOPIC, "Blend shape weights move points over the shutter", STILL)
def blend_shapes(scene: Scene) -> None:
    blend_shape(scene, {9.5: [-0.2], 10.0: [0.3], 10.6: [1.0]})


@rule(TOPIC, "In-betweens bend the points' paths", "the straight path of the shape alone", shutter=FULL)
def blend_shape_in_betweens(scene: Scene) -> None:
    blend_shape(scene, {9.5: [0.0], 10.5: [1.0]}, middle=not scene.mistaken)


@rule(TOPIC, "motion:blurScale counts for skinned points", "full blur", shutter=FULL)
def skin_blur_scale(scene: Scene) -> None:
    mesh = arm(scene)
    animate(scene, {9.5: (0.0, -100.0), 10.5: (60.0, 100.0)})
    if not scene.mistaken:
        UsdGeom.MotionAPI.Apply(mesh.GetPrim()).CreateMotionBlurScaleAttr(0.4)


@rule(TOPIC, "Skinning and an ancestor's motion add up", "the ancestor's alone")
def skin_under_moving_parent(scene: Scene) -> None:
    turn(UsdGeom.Xform.Define(scene.stage, "/Parent"), {9.0: -30.0, 11.0: 60.0})
    mesh = arm(scene, "/Parent/Root")
    if scene.mistaken:
        mesh.GetPrim().RemoveAPI(UsdSkel.BindingAPI)
    animate(scene, {9.5: (0.0, -100.0), 10.5: (0.0, 100.0)}, "/Parent/Root")
