"""Skinned meshes and lights with one fault each (bad_scenes.py)."""

from __future__ import annotations

from bad_scenes import HUGE, INF, NAN, fault, square, vec3s
from pxr import Gf, UsdGeom, UsdLux, UsdSkel, Vt
from recording import Shot


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


@fault(
    "/World/Arm/Animation.translations",
    "for joint 'a/b'",
    "expected finite",
    nan=(NAN,),
    inf=(INF,),
    huge=(HUGE,),
)
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
