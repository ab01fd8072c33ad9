"""Skeletal bindings that are wrong: the prim and the property are named, and the rest is drawn."""

from __future__ import annotations

import numpy as np
import pytest
from pxr import Gf, UsdSkel
from recording import Shot, messages, points_at
from skinning_oracle import (
    ARM_POINTS,
    Arm,
    add_blend_shapes,
    pixels,
    spinning_arm,
    worst_skinned_deviation,
)


def one_message(arm: Arm, severity: str = "warning", from_usd: int = 0) -> str:
    """Ours, and what that does to the mesh; UsdSkel itself says more about some bindings."""
    result = arm.shot.read()
    ours = messages(result, severity)
    assert len(ours) == 1 + from_usd, ours
    if severity == "warning":
        assert np.allclose(points_at(result.scene.meshes["/Root/Mesh"], 0.5), ARM_POINTS, atol=1e-6)
    else:
        assert "/Root/Mesh" not in result.scene.meshes
    return ours[0]


def test_outside_a_skelroot_nothing_is_skinned():
    arm = spinning_arm()
    arm.root.GetPrim().SetTypeName("Xform")
    assert one_message(arm) == (
        "/Root/Mesh.primvars:skel:jointIndices: no SkelRoot above, expected one for skinning to apply "
        "(UsdSkel); drawn in its rest pose"
    )


@pytest.mark.parametrize("target", ["/Nowhere", "/Root/Mesh", None])
def test_a_skeleton_that_does_not_resolve_is_named(target: str | None):
    arm = spinning_arm()
    relationship = UsdSkel.BindingAPI(arm.mesh).GetSkeletonRel()
    relationship.SetTargets([target]) if target else relationship.ClearTargets(True)
    text = one_message(arm)
    assert text.startswith("/Root/Mesh.skel:skeleton: found ") and "expected one Skeleton" in text
    assert (target or "no target") in text


def test_a_skeleton_without_bind_transforms_is_named():
    arm = spinning_arm()
    arm.skeleton.GetBindTransformsAttr().Set([Gf.Matrix4d(1)])
    text = one_message(arm, from_usd=1)
    assert text.startswith("/Root/Skeleton.bindTransforms: found 1 matrices, expected 2") and "/Root/Mesh" in text


def test_a_skeleton_without_animation_of_all_joints_nor_rest_transforms_is_named():
    arm = spinning_arm()
    arm.animation.GetJointsAttr().Set(["a"])
    arm.skeleton.GetRestTransformsAttr().Set([])
    assert one_message(arm, from_usd=2).startswith("/Root/Skeleton.restTransforms: found 0 matrices")


def test_a_joint_out_of_range_keeps_the_mesh_out_of_the_picture():
    arm = spinning_arm()
    UsdSkel.BindingAPI(arm.mesh).GetJointIndicesPrimvar().Set([0, 7] * len(ARM_POINTS))
    assert one_message(arm, "error") == (
        "/Root/Mesh.primvars:skel:jointIndices: value 1 is 7; expected a joint from 0 to 1; the prim is not drawn"
    )


def test_influences_of_another_size_keep_the_mesh_out_of_the_picture():
    arm = spinning_arm()
    UsdSkel.BindingAPI(arm.mesh).GetJointIndicesPrimvar().Set([0, 1])
    UsdSkel.BindingAPI(arm.mesh).GetJointWeightsPrimvar().Set([0.5, 0.5])
    assert "found 2 values; expected 20" in one_message(arm, "error")


def test_indices_without_weights_and_those_that_disagree_leave_the_rest_pose():
    arm = spinning_arm()
    UsdSkel.BindingAPI(arm.mesh).GetJointIndicesPrimvar().SetElementSize(1)
    text = one_message(arm, from_usd=1)
    assert text.startswith("/Root/Mesh.primvars:skel:jointIndices: found vertex with elementSize 1, vertex with")
    arm.mesh.GetPrim().RemoveProperty("primvars:skel:jointWeights")
    assert one_message(arm).startswith("/Root/Mesh.primvars:skel:jointWeights: not authored, expected")


def test_joints_that_the_skeleton_does_not_have_stay():
    arm = spinning_arm()
    UsdSkel.BindingAPI(arm.mesh).CreateJointsAttr(["nose", "mouth"])
    text = one_message(arm)
    assert text.startswith("/Root/Mesh.skel:joints: found 2 joints that /Root/Skeleton does not have ('nose')")


def test_blend_shapes_that_are_wrong_are_left_out_and_the_joints_go_on():
    arm = spinning_arm()
    add_blend_shapes(arm)
    UsdSkel.BlendShape.Get(arm.stage, "/Root/Mesh/fall").GetPointIndicesAttr().Set([3, 99])
    targets = UsdSkel.BindingAPI(arm.mesh).GetBlendShapeTargetsRel()
    targets.SetTargets(["/Root/Mesh/nothing", "/Root/Mesh/fall"])
    result = arm.shot.read()
    warnings = messages(result, "warning")
    assert "/Root/Mesh/fall.pointIndices: index 1 is 99; expected a point from 0 to 9; it is left out" in warnings
    assert (
        "/Root/Mesh.skel:blendShapeTargets: target /Root/Mesh/nothing is no BlendShape; 'rise' is left out" in warnings
    )
    targets.SetTargets(["/Root/Mesh/fall"])
    fewer = arm.shot.read()
    assert (
        "/Root/Mesh.skel:blendShapeTargets: found 1 targets, expected 2, as many as skel:blendShapes; left "
        "out" in messages(fewer, "warning")
    )
    arm.mesh.GetPrim().RemoveProperty("skel:blendShapeTargets")
    for read in (result, fewer):
        assert pixels(read, arm.mesh.GetPrim(), worst_skinned_deviation(read, arm.mesh.GetPrim())) <= 0.05


def test_an_unknown_method_is_linear():
    arm = spinning_arm("cubic")
    result = arm.shot.read()
    assert messages(result, "warning") == [
        "/Root/Mesh.primvars:skel:skinningMethod: found 'cubic', expected classicLinear or dualQuaternion; "
        "took classicLinear"
    ]
    linear = spinning_arm().shot.read()
    assert np.array_equal(
        result.scene.meshes["/Root/Mesh"]["points"][0][1], linear.scene.meshes["/Root/Mesh"]["points"][0][1]
    )


def test_a_pose_that_is_no_number_keeps_the_mesh_out_of_the_picture():
    arm = Arm(Shot())
    arm.animation.GetTranslationsAttr().Set([Gf.Vec3f(float("nan"), 0, 0), Gf.Vec3f(1, 0, 0)], 10)
    arm.rotate({9: (0, 0), 11: (10, 10)})
    assert one_message(arm, "error").startswith(
        "/Root/Skeleton/Animation.translations: found (nan, 0, 0) for joint 'a' at shutter time "
    )


@pytest.mark.parametrize("op", ["AddTranslateOp", "AddScaleOp", "AddRotateXYZOp"])
def test_a_skeleton_that_stands_nowhere_keeps_what_it_moves_out_of_the_picture(op: str):
    arm = spinning_arm()
    arm.shot.mesh("/Card")
    getattr(arm.skeleton, op)().Set((float("nan"), 1, 1))
    result = arm.shot.read()
    errors = messages(result, "error")
    assert len(errors) == 1 and errors[0].startswith("/Root/Skeleton.xformOp:") and "found (nan, 1, 1)" in errors[0]
    assert list(result.scene.meshes) == ["/Card"]
