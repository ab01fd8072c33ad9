"""Skinned meshes in native instances and prototypes of point instancers, against UsdSkel."""

from __future__ import annotations

import numpy as np
import pytest
from pxr import Gf, Sdf, UsdGeom, UsdSkel
from recording import Shot
from skinning_oracle import (
    Arm,
    add_blend_shapes,
    blend,
    spinning_arm,
    usd_skinned_points,
)


def crowd(same: bool) -> Shot:
    """Two native instances of one character at y = 0 and 3, with an animation each or the same."""
    shot = Shot()
    arm = Arm(shot, "/Library/Man")
    add_blend_shapes(arm)
    shot.stage.GetPrimAtPath("/Library").SetSpecifier(Sdf.SpecifierClass)
    UsdSkel.BindingAPI(arm.skeleton).GetAnimationSourceRel().ClearTargets(True)
    for index, degrees in enumerate(((80, 40), (-80, -20))):
        animation = arm.animate(f"/Animations/walk_{index}")
        arm.rotate({9: (0, 0), 11: degrees}, animation)
        if index == 0:
            blend(animation)
    for index in range(2):
        instance = UsdGeom.Xform.Define(shot.stage, f"/Crowd/man_{index}")
        instance.GetPrim().GetReferences().AddInternalReference("/Library/Man")
        instance.GetPrim().SetTypeName("SkelRoot")
        instance.GetPrim().SetInstanceable(True)
        instance.AddTranslateOp().Set(Gf.Vec3d(0, 3 * index, 0))
        animation = f"/Animations/walk_{0 if same else index}"
        UsdSkel.BindingAPI.Apply(instance.GetPrim()).CreateAnimationSourceRel().SetTargets([animation])
    return shot


@pytest.mark.parametrize("same", [True, False])
def test_instances_of_one_character_move_each_by_its_own_animation(same: bool):
    shot = crowd(same)
    result = shot.read()
    assert len(result.scene.prototypes) == (1 if same else 2)
    meshes = [shot.stage.GetPrimAtPath(f"/Crowd/man_{index}/Mesh") for index in range(2)]
    for time01 in np.linspace(0, 1, 9):
        code = result.camera.shutter.time_code(float(time01))
        expected = np.concatenate([usd_skinned_points(mesh, code) for mesh in meshes])
        found = result.scene.instance_points(float(time01))
        assert np.abs(sorted_rows(found) - sorted_rows(expected)).max() <= 1e-3


def test_instances_within_instances_move_by_the_animation_of_each():
    shot = crowd(same=False)
    shot.stage.GetPrimAtPath("/Crowd").SetSpecifier(Sdf.SpecifierClass)
    for index in range(2):
        nest = UsdGeom.Xform.Define(shot.stage, f"/Nest_{index}")
        nest.GetPrim().GetReferences().AddInternalReference("/Crowd")
        nest.GetPrim().SetInstanceable(True)
        nest.AddTranslateOp().Set(Gf.Vec3d(0, 0, -2 * index))
    result = shot.read()
    assert len(result.scene.prototypes) == 2
    meshes = [shot.stage.GetPrimAtPath(f"/Nest_{nest}/man_{man}/Mesh") for nest in range(2) for man in range(2)]
    for time01 in (0.0, 0.4, 1.0):
        code = result.camera.shutter.time_code(time01)
        expected = np.concatenate([usd_skinned_points(mesh, code) for mesh in meshes])
        found = result.scene.instance_points(time01)
        assert np.abs(sorted_rows(found) - sorted_rows(expected)).max() <= 1e-3


def sorted_rows(points: np.ndarray) -> np.ndarray:
    return points[np.lexsort(np.round(points, 3).T)]


def test_a_skinned_prototype_of_a_point_instancer_is_posed_in_the_prototype_s_space():
    shot = Shot()
    arm = Arm(shot, "/Instancer/Man")
    arm.rotate({9: (0, 0), 11: (80, 40)})
    arm.skeleton.AddTranslateOp().Set(Gf.Vec3d(0, 0, 0.5))
    instancer = UsdGeom.PointInstancer.Define(shot.stage, "/Instancer")
    instancer.CreatePrototypesRel().SetTargets(["/Instancer/Man"])
    instancer.CreateProtoIndicesAttr([0, 0])
    instancer.CreatePositionsAttr([Gf.Vec3f(0, 2, 0), Gf.Vec3f(0, -2, 0)])
    result = shot.read()
    for time01 in (0.0, 0.3, 1.0):
        points = usd_skinned_points(arm.mesh.GetPrim(), result.camera.shutter.time_code(time01))
        expected = np.concatenate([points + (0, 2, 0), points - (0, 2, 0)])
        assert np.abs(sorted_rows(result.scene.instance_points(time01)) - sorted_rows(expected)).max() <= 1e-3


def test_a_skeleton_outside_the_instances_places_each_of_them_where_it_stands():
    shot = Shot()
    arm = spinning_arm()
    shot = arm.shot
    proto = shot.stage.OverridePrim("/Cloth")
    proto.SetSpecifier(Sdf.SpecifierClass)
    arm.strip("/Cloth/Strip")
    shot.stage.GetPrimAtPath("/Cloth/Strip").RemoveProperty("skel:skeleton")
    UsdSkel.BindingAPI.Apply(arm.root.GetPrim()).CreateSkeletonRel().SetTargets([arm.skeleton.GetPath()])
    for index in range(2):
        instance = UsdGeom.Xform.Define(shot.stage, f"/Root/cloth_{index}")
        instance.GetPrim().GetReferences().AddInternalReference("/Cloth")
        instance.GetPrim().SetInstanceable(True)
        instance.AddTranslateOp().Set(Gf.Vec3d(0, 3 * index, 0))
    result = shot.read()
    expected = usd_skinned_points(arm.mesh.GetPrim(), 10.0)
    found = result.scene.instance_points(0.5)
    assert len(found) == 2 * len(expected)
    assert np.abs(sorted_rows(found)[::2] - sorted_rows(expected)).max() <= 2e-3
