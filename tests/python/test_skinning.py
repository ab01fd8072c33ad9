"""Skinned meshes against UsdSkel's own evaluation, at dense times."""

from __future__ import annotations

import numpy as np
import pytest
from msbvh import _core
from msbvh.base.errors import Diagnostics
from msbvh.scene.reader import ReadSettings, read_frame
from pxr import Gf, Usd, UsdGeom, UsdSkel, Vt
from recording import Shot, interpolated, messages, points_at
from skinning_oracle import (
    ARM_POINTS,
    Arm,
    add_blend_shapes,
    pixels,
    spinning_arm,
    usd_skinned_points,
    worst_skinned_deviation,
)

TOLERANCE_PIXELS = 0.1
"""What the reader is asked for; samples have a quarter of it, measured at the middles of their intervals."""


# The core's arithmetic against UsdSkel's.


def random_joints(rng: np.random.Generator, count: int, kind: str) -> np.ndarray:
    matrices = np.tile(np.eye(4), (count, 1, 1))
    for matrix in matrices:
        q = Gf.Quatd(rng.normal(), Gf.Vec3d(*rng.normal(size=3))).GetNormalized()
        rotation = np.array(Gf.Matrix3d(q))
        stretch = {
            "rigid": np.eye(3),
            "scaled": np.diag(rng.uniform(0.3, 2.5, 3)),
            "sheared": np.eye(3) + rng.uniform(-0.3, 0.3, (3, 3)),
            "mirrored": np.diag([-1.0, 1.3, 0.7]),
        }[kind]
        matrix[:3, :3] = stretch @ rotation
        matrix[3, :3] = rng.uniform(-3, 3, 3)
    return matrices


@pytest.mark.parametrize("kind", ["rigid", "scaled", "sheared", "mirrored"])
@pytest.mark.parametrize("method", ["classicLinear", "dualQuaternion"])
@pytest.mark.parametrize("weight_sum", [1.0, 0.8])
def test_points_and_normals_are_usdskel_s(method: str, kind: str, weight_sum: float):
    rng = np.random.default_rng(7)
    count, joint_count, influences = 200, 6, 4
    points = rng.uniform(-2, 2, (count, 3)).astype(np.float32)
    normals = rng.normal(size=(count, 3)).astype(np.float32)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    indices = rng.integers(0, joint_count, count * influences).astype(np.int32)
    weights = rng.dirichlet(np.ones(influences), count).astype(np.float32).ravel() * np.float32(weight_sum)
    joints, bind = random_joints(rng, joint_count, kind), random_joints(rng, 1, "scaled")[0]
    found, found_normals, diagnostics = _core.skin_points(
        path="/mesh",
        times01=np.zeros(1),
        points=points,
        normals=normals,
        method=method,
        joint_indices=indices,
        joint_weights=weights,
        influences_per_point=influences,
        constant_influences=False,
        geom_bind=bind,
        joints=joints[None],
        sub_shapes=[],
    )
    assert not diagnostics

    expected = Vt.Vec3fArray.FromNumpy(points)
    transforms = Vt.Matrix4dArray.FromNumpy(joints)
    int_array, float_array = Vt.IntArray.FromNumpy(indices), Vt.FloatArray.FromNumpy(weights)
    assert UsdSkel.SkinPoints(method, Gf.Matrix4d(bind), transforms, int_array, float_array, influences, expected, True)
    assert np.abs(found[0] - np.array(expected)).max() <= 1e-5  # coordinates of about 5, single precision

    if method == "dualQuaternion" and kind in ("sheared", "mirrored"):
        return  # Where skinning.h says that normals depart from UsdSkel.
    inverses = Vt.Matrix3dArray.FromNumpy(np.ascontiguousarray(np.linalg.inv(joints[:, :3, :3]).transpose(0, 2, 1)))
    expected = Vt.Vec3fArray.FromNumpy(normals)
    inverse_bind = Gf.Matrix3d(*np.linalg.inv(bind[:3, :3]).T.ravel().tolist())
    assert UsdSkel.SkinNormals(method, inverse_bind, inverses, int_array, float_array, influences, expected, True)
    # Where blended normals nearly cancel, single precision leaves UsdSkel less.
    assert np.abs(found_normals[0] - np.array(expected)).max() <= 1e-4


def test_wrong_arguments_are_named():
    with pytest.raises(TypeError, match="path"):
        _core.skin_points()
    arguments = dict(
        path="/mesh",
        times01=np.zeros(1),
        points=np.zeros((2, 3), np.float32),
        method="classicLinear",
        influences_per_point=1,
        constant_influences=False,
        geom_bind=np.eye(4),
        sub_shapes=[],
    )
    with pytest.raises(ValueError, match='found "cubic"; expected classicLinear or dualQuaternion'):
        _core.skin_points(**{**arguments, "method": "cubic"})
    with pytest.raises(TypeError, match="sub_shapes"):
        _core.skin_points(**{**arguments, "sub_shapes": [1]})
    with pytest.raises(ValueError, match="joints"):
        _core.skin_points(**arguments, joints=np.zeros((2, 1, 4, 4)))
    points, normals, diagnostics = _core.skin_points(**arguments, joint_indices=np.zeros(2, np.int32))
    assert points is None and normals is None
    assert [str(d.attribute) for d in diagnostics] == ["primvars:skel:jointWeights"]


# Motion.


@pytest.mark.parametrize("method", ["classicLinear", "dualQuaternion"])
@pytest.mark.parametrize("shutter", [(-0.5, 0.5), (0.0, 0.5), (-1.0, 1.0)])
def test_samples_follow_turning_joints_at_any_time(method: str, shutter: tuple[float, float]):
    arm = spinning_arm(method, shutter=shutter)
    result = arm.shot.read()
    deviation = pixels(result, arm.mesh.GetPrim(), worst_skinned_deviation(result, arm.mesh.GetPrim()))
    assert deviation <= TOLERANCE_PIXELS / 2
    assert not messages(result)


def test_fewer_samples_do_where_more_error_is_allowed():
    arm = spinning_arm()
    counts = [
        len(arm.shot.read(motion_tolerance=pixel).scene.meshes["/Root/Mesh"]["points"]) for pixel in (0.01, 1.0, 50.0)
    ]
    assert counts[0] > counts[1] > counts[2] >= 5


def test_a_constant_animation_gives_one_sample():
    arm = Arm(Shot())
    arm.rotate({9: (20, 30), 10: (20, 30), 11: (20, 30)})
    result = arm.shot.read()
    assert len(result.scene.meshes["/Root/Mesh"]["points"]) == 1
    assert worst_skinned_deviation(result, arm.mesh.GetPrim()) <= 1e-6


def test_keys_outside_the_shutter_count_and_beyond_them_the_pose_holds():
    arm = Arm(Shot())
    arm.rotate({0: (0, 0), 100: (90, 90)})
    result = arm.shot.read(frame=50.0)
    mesh = result.scene.meshes["/Root/Mesh"]
    assert np.abs(points_at(mesh, 0.0) - points_at(mesh, 1.0)).max() > 1e-3
    assert worst_skinned_deviation(result, arm.mesh.GetPrim()) <= 1e-4
    assert len(arm.shot.read(frame=200.0).scene.meshes["/Root/Mesh"]["points"]) == 1


def test_a_closed_shutter_and_the_default_time_give_one_pose():
    arm = spinning_arm(shutter=(0, 0))
    mesh = arm.shot.read().scene.meshes["/Root/Mesh"]
    assert len(mesh["points"]) == 1
    assert np.abs(points_at(mesh, 0.0) - usd_skinned_points(arm.mesh.GetPrim(), 10.0)).max() <= 1e-6
    mesh = arm.shot.read(frame=None).scene.meshes["/Root/Mesh"]
    assert np.allclose(points_at(mesh, 0.0), ARM_POINTS, atol=1e-6)


def test_held_animation_jumps():
    arm = spinning_arm(shutter=(-0.5, 1.5))
    arm.stage.SetInterpolationType(Usd.InterpolationTypeHeld)
    mesh = arm.shot.read().scene.meshes["/Root/Mesh"]
    assert mesh["points_held"] and [time01 for time01, _ in mesh["points"]] == [0.0, 0.25, 0.75]
    for time01, code in ((0.1, 9.7), (0.3, 10.1), (0.9, 11.3)):
        assert np.abs(points_at(mesh, time01) - usd_skinned_points(arm.mesh.GetPrim(), code)).max() <= 1e-6


def test_a_held_pose_begins_where_it_is_authored():
    """At a time code that is rounded to before itself on its way to the shutter's time and back."""
    arm = Arm(Shot((-0.25, 0.25)))
    arm.stage.SetInterpolationType(Usd.InterpolationTypeHeld)
    arm.rotate({9: (0, 0), 10.025: (90, 0)})
    result = arm.shot.read()
    shutter = result.camera.shutter
    assert shutter.time_code(shutter.time01(10.025)).GetValue() < 10.025
    mesh = result.scene.meshes["/Root/Mesh"]
    assert len(mesh["points"]) == 2
    assert np.allclose(mesh["points"][1][1], usd_skinned_points(arm.mesh.GetPrim(), Usd.TimeCode(10.025)), atol=1e-6)


def test_moving_rest_points_are_skinned_as_they_move():
    arm = spinning_arm()
    for frame in (9, 11):
        arm.mesh.GetPointsAttr().Set([Gf.Vec3f(x, y, frame - 10) for x, y, _ in ARM_POINTS], frame)
    result = arm.shot.read()
    assert pixels(result, arm.mesh.GetPrim(), worst_skinned_deviation(result, arm.mesh.GetPrim())) <= 0.05


# Where the skinned mesh stands.


def test_the_skeleton_places_the_mesh_whose_own_transform_does_not_count():
    arm = spinning_arm()
    arm.mesh.AddTranslateOp().Set(Gf.Vec3d(100, 0, 0))
    arm.root.AddTranslateOp().Set(Gf.Vec3d(0, 1, 0))
    move = arm.skeleton.AddTranslateOp()
    move.Set(Gf.Vec3d(0, 0, 0), 9)
    move.Set(Gf.Vec3d(0, 0, 4), 11)
    arm.skeleton.AddScaleOp().Set(Gf.Vec3f(2))
    result = arm.shot.read()
    assert pixels(result, arm.mesh.GetPrim(), worst_skinned_deviation(result, arm.mesh.GetPrim())) <= 0.05
    points = points_at(result.scene.meshes["/Root/Mesh"], 0.5)
    assert np.abs(points[:, 0]).max() < 5 and points[:, 1].max() > 1


def test_an_invisible_skeleton_still_places_its_meshes():
    arm = spinning_arm()
    arm.skeleton.CreateVisibilityAttr("invisible")
    move = arm.skeleton.AddTranslateOp()
    move.Set(Gf.Vec3d(0, 0, 0), 9)
    move.Set(Gf.Vec3d(0, 0, 4), 11)
    result = arm.shot.read()
    assert pixels(result, arm.mesh.GetPrim(), worst_skinned_deviation(result, arm.mesh.GetPrim())) <= 0.05


def test_meshes_share_a_skeleton_each_with_its_own_joint_order():
    arm = spinning_arm()
    other = arm.strip("/Root/Other")
    binding = UsdSkel.BindingAPI(other)
    binding.CreateJointsAttr(["a/b", "a"])
    binding.GetJointIndicesPrimvar().Set([1, 0] * len(ARM_POINTS))
    bind = Gf.Matrix4d().SetScale(0.5) * Gf.Matrix4d().SetTranslate(Gf.Vec3d(0.1, 0.2, 0.3))
    binding.GetGeomBindTransformAttr().Set(bind)
    result = arm.shot.read()
    for mesh in (arm.mesh, other):
        assert pixels(result, mesh.GetPrim(), worst_skinned_deviation(result, mesh.GetPrim())) <= 0.05


def test_constant_influences_move_a_mesh_and_an_implicit_shape_rigidly():
    arm = spinning_arm()
    sphere = UsdGeom.Sphere.Define(arm.stage, "/Root/Sphere")
    sphere.CreateRadiusAttr(0.25)
    for prim in (arm.mesh.GetPrim(), sphere.GetPrim()):
        binding = UsdSkel.BindingAPI.Apply(prim)
        binding.CreateSkeletonRel().SetTargets([arm.skeleton.GetPath()])
        binding.CreateJointIndicesPrimvar(True, 1).Set([1])
        binding.CreateJointWeightsPrimvar(True, 1).Set([1.0])
    result = arm.shot.read()
    assert pixels(result, arm.mesh.GetPrim(), worst_skinned_deviation(result, arm.mesh.GetPrim())) <= 0.05
    cache = UsdSkel.Cache()
    cache.Populate(arm.root, Usd.TraverseInstanceProxies())
    joint = np.array(cache.GetSkelQuery(arm.skeleton).ComputeSkinningTransforms(10.0)[1])
    points = points_at(result.scene.meshes["/Root/Sphere"], 0.5)
    assert np.allclose((points.min(axis=0) + points.max(axis=0)) / 2, joint[3, :3], atol=0.01)
    assert np.allclose(np.linalg.norm(points - joint[3, :3], axis=1), 0.25, atol=1e-4)


# Blend shapes and normals.


@pytest.mark.parametrize("joints_too", [True, False])
def test_blend_shapes_bend_through_their_in_betweens(joints_too: bool):
    arm = spinning_arm()
    add_blend_shapes(arm)
    arm.mesh.AddTranslateOp().Set(Gf.Vec3d(0, 0.5, 0))
    if not joints_too:
        for name in ("Indices", "Weights"):
            arm.mesh.GetPrim().RemoveProperty(f"primvars:skel:joint{name}")
    result = arm.shot.read(motion_tolerance=0.4)
    assert pixels(result, arm.mesh.GetPrim(), worst_skinned_deviation(result, arm.mesh.GetPrim())) <= 0.4
    assert not messages(result)


def test_normals_follow_the_joints_in_each_interpolation():
    corners = [2 * i + k for i in range(4) for k in (0, 2, 3, 1)]
    for interpolation, count in (("vertex", len(ARM_POINTS)), ("faceVarying", len(corners))):
        arm = Arm(Shot())
        arm.rotate({9: (0, 0), 11: (60, 60)})
        arm.animation.GetTranslationsAttr().Set([Gf.Vec3f(0), Gf.Vec3f(1, 0, 0)])
        arm.mesh.CreateNormalsAttr([Gf.Vec3f(0, 1, 0)] * count)
        arm.mesh.SetNormalsInterpolation(interpolation)
        mesh = arm.shot.read(frame=11.0).scene.meshes["/Root/Mesh"]
        assert len(mesh["normals"]) == len(mesh["points"]) > 1
        assert mesh["normals"][0][1].shape == (count, 3) and mesh["normals_indices"] is None
        point = 0 if interpolation == "vertex" else corners.index(0)  # follows joint a alone
        for time01, normals in mesh["normals"]:
            angle = np.radians(min(60.0, 60.0 * (1.5 + time01) / 2))
            assert np.allclose(normals[point], (-np.sin(angle), np.cos(angle), 0), atol=1e-5)


def test_normals_that_turn_on_still_points_are_sampled():
    arm = Arm(Shot())
    shape = UsdSkel.BlendShape.Define(arm.stage, "/Root/Mesh/tilt")
    shape.CreateNormalOffsetsAttr([Gf.Vec3f(1, 0, 0)] * len(ARM_POINTS))
    binding = UsdSkel.BindingAPI(arm.mesh)
    binding.CreateBlendShapesAttr(["tilt"])
    binding.CreateBlendShapeTargetsRel().SetTargets([shape.GetPath()])
    arm.animation.CreateBlendShapesAttr(["tilt"])
    for frame, weight in ((9, 0.0), (11, 1.0)):
        arm.animation.CreateBlendShapeWeightsAttr().Set([weight], frame)
    arm.mesh.CreateNormalsAttr([Gf.Vec3f(0, 0, 1)] * len(ARM_POINTS))
    arm.mesh.SetNormalsInterpolation("vertex")
    mesh = arm.shot.read().scene.meshes["/Root/Mesh"]
    assert len(mesh["normals"]) > 1
    times01, normals = zip(*mesh["normals"], strict=True)
    for time01 in (0.0, 0.37, 1.0):
        expected = np.array([(0.5 + time01) / 2, 0, 1])
        found = interpolated(times01, normals, time01)[0]
        assert np.allclose(found / np.linalg.norm(found), expected / np.linalg.norm(expected), atol=0.005)


def test_uniform_normals_of_a_skinned_mesh_are_left_out_by_name():
    arm = spinning_arm()
    arm.mesh.CreateNormalsAttr([Gf.Vec3f(0, 1, 0)] * 4)
    arm.mesh.SetNormalsInterpolation("uniform")
    result = arm.shot.read()
    assert result.scene.meshes["/Root/Mesh"]["normals"] is None
    assert messages(result, "warning") == [
        "/Root/Mesh.normals: uniform normals of a skinned mesh have no joints to follow; left out"
    ]


def test_the_whole_way_to_a_scene():
    arm = spinning_arm("dualQuaternion")
    result = read_frame(arm.stage, 10.0, ReadSettings(width=64), Diagnostics())
    assert result.scene.statistics()["triangles"] == 8
    assert max(track.segments * track.degree for track in result.tracks) >= 4
    assert not messages(result)
