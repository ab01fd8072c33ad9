"""UsdSkel's own evaluation of skinned meshes, and a small skinned scene made in memory."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from msbvh.motion.boxes import Box
from pxr import Gf, Sdf, Usd, UsdGeom, UsdSkel, Vt
from recording import DENSE_TIMES01, Shot, points_at, transformed


def usd_skinned_points(prim: Usd.Prim, code: Usd.TimeCode) -> np.ndarray:
    """The world-space points of a skinned mesh: blend shapes, joints, then the skeleton's transform;
    float64[N, 3]."""
    cache = UsdSkel.Cache()
    cache.Populate(UsdSkel.Root.Find(prim), Usd.TraverseInstanceProxies())
    query = cache.GetSkinningQuery(prim)
    skeleton = UsdSkel.BindingAPI(prim).GetInheritedSkeleton()
    bound = cache.GetSkelQuery(skeleton)
    points = UsdGeom.PointBased(prim).GetPointsAttr().Get(code)
    if query.HasBlendShapes() and bound.GetAnimQuery():
        points = _blended(prim, query, bound.GetAnimQuery(), points, code)
    placing = prim
    if query.HasJointInfluences():
        assert query.ComputeSkinnedPoints(bound.ComputeSkinningTransforms(code), points, code)
        placing = skeleton.GetPrim()
    world = np.array(UsdGeom.XformCache(code).GetLocalToWorldTransform(placing))
    return transformed(np.array(points, np.float64).reshape(-1, 3), world)


def _blended(
    prim: Usd.Prim,
    query: UsdSkel.SkinningQuery,
    animation: UsdSkel.AnimQuery,
    points: Any,
    code: Usd.TimeCode,
) -> Any:
    shapes = UsdSkel.BlendShapeQuery(UsdSkel.BindingAPI(prim))
    animated = dict(zip(animation.GetBlendShapeOrder(), animation.ComputeBlendShapeWeights(code), strict=True))
    weights = shapes.ComputeSubShapeWeights(
        Vt.FloatArray([animated.get(name, 0.0) for name in query.GetBlendShapeOrder()])
    )
    assert shapes.ComputeDeformedPoints(
        *weights, shapes.ComputeBlendShapePointIndices(), shapes.ComputeSubShapePointOffsets(), points
    )
    return points


def worst_skinned_deviation(result: Any, prim: Usd.Prim, mesh: dict | None = None) -> float:
    """How far the handed-down points stray from UsdSkel's at 33 times of the shutter, in stage units."""
    shutter = result.camera.shutter
    mesh = mesh or result.scene.meshes[str(prim.GetPath())]
    return max(
        float(
            np.linalg.norm(points_at(mesh, time01) - usd_skinned_points(prim, shutter.time_code(time01)), axis=1).max()
        )
        for time01 in DENSE_TIMES01
    )


def pixels(result: Any, prim: Usd.Prim, units: float) -> float:
    """A length in pixels where the mesh comes nearest to the camera."""
    codes = [result.camera.shutter.time_code(time01) for time01 in (0.0, 0.5, 1.0)]
    points = np.array([usd_skinned_points(prim, code) for code in codes])
    corners = np.ascontiguousarray(Box.around(points.reshape(-1, 3)).corners()[None, None, :, :3])
    return units / float(result.camera.pixel_size().at_boxes(corners)[0])


def turn(degrees: float, axis: tuple[float, float, float] = (0, 0, 1)) -> Gf.Quatf:
    """A rotation about an axis."""
    half = math.radians(degrees) / 2
    return Gf.Quatf(math.cos(half), Gf.Vec3f(*axis) * math.sin(half))


ARM_POINTS = [(x, y, 0) for x in (0.0, 0.5, 1.0, 1.5, 2.0) for y in (-0.2, 0.2)]
"""A strip along x; joint 'a' at the origin, its child 'b' at x = 1."""


def _translated(x: float) -> Gf.Matrix4d:
    return Gf.Matrix4d().SetTranslate(Gf.Vec3d(x, 0, 0))


class Arm:
    """A strip skinned to two joints under /Root, seen by the Shot's camera."""

    def __init__(self, shot: Shot, path: str = "/Root", method: str = "classicLinear") -> None:
        self.shot, self.stage, self.path = shot, shot.stage, path
        self.root = UsdSkel.Root.Define(self.stage, path)
        self.skeleton = UsdSkel.Skeleton.Define(self.stage, f"{path}/Skeleton")
        self.skeleton.CreateJointsAttr(["a", "a/b"])
        self.skeleton.CreateBindTransformsAttr([_translated(0), _translated(1)])
        self.skeleton.CreateRestTransformsAttr([_translated(0), _translated(1)])
        self.animation = self.animate(f"{path}/Skeleton/Animation")
        UsdSkel.BindingAPI.Apply(self.skeleton.GetPrim()).CreateAnimationSourceRel().SetTargets(
            [self.animation.GetPath()]
        )
        self.mesh = self.strip(f"{path}/Mesh", method)

    def animate(self, path: str) -> UsdSkel.Animation:
        """An animation that holds the rest pose."""
        animation = UsdSkel.Animation.Define(self.stage, path)
        animation.CreateJointsAttr(["a", "a/b"])
        animation.CreateTranslationsAttr([Gf.Vec3f(0), Gf.Vec3f(1, 0, 0)])
        animation.CreateRotationsAttr([Gf.Quatf(1), Gf.Quatf(1)])
        animation.CreateScalesAttr([Gf.Vec3h(1), Gf.Vec3h(1)])
        return animation

    def strip(self, path: str, method: str = "classicLinear") -> UsdGeom.Mesh:
        """The strip, bound to this skeleton."""
        mesh = self.shot.mesh(path, ARM_POINTS)
        mesh.GetFaceVertexCountsAttr().Set([4] * 4)
        mesh.GetFaceVertexIndicesAttr().Set([2 * i + k for i in range(4) for k in (0, 2, 3, 1)])
        binding = UsdSkel.BindingAPI.Apply(mesh.GetPrim())
        binding.CreateSkeletonRel().SetTargets([self.skeleton.GetPath()])
        weights = [w for x, _, _ in ARM_POINTS for w in (1 - x / 2, x / 2)]
        binding.CreateJointIndicesPrimvar(False, 2).Set([0, 1] * len(ARM_POINTS))
        binding.CreateJointWeightsPrimvar(False, 2).Set(weights)
        binding.CreateGeomBindTransformAttr(Gf.Matrix4d(1))
        mesh.GetPrim().CreateAttribute("primvars:skel:skinningMethod", Sdf.ValueTypeNames.Token).Set(method)
        return mesh

    def rotate(self, by_frame: dict[float, tuple[float, float]], animation: Any = None) -> None:
        """The degrees that both joints are turned by at some frames."""
        rotations = (animation or self.animation).GetRotationsAttr()
        for frame, degrees in by_frame.items():
            rotations.Set([turn(angle) for angle in degrees], frame)


def bind(arm: Arm, prim: Usd.Prim, shares: np.ndarray) -> None:
    """Binds the points of a prim to both joints: `shares` of the second."""
    binding = UsdSkel.BindingAPI.Apply(prim)
    binding.CreateSkeletonRel().SetTargets([arm.skeleton.GetPath()])
    binding.CreateJointIndicesPrimvar(False, 2).Set([0, 1] * len(shares))
    binding.CreateJointWeightsPrimvar(False, 2).Set([w for share in shares.tolist() for w in (1 - share, share)])


def spinning_arm(method: str = "classicLinear", **shot: object) -> Arm:
    """Both joints turn between frames 9, 10 and 11."""
    arm = Arm(Shot(**shot), method=method)
    arm.rotate({9: (0, 0), 10: (50, 100), 11: (-30, 170)})
    return arm


def add_blend_shapes(arm: Arm) -> None:
    """'rise' with an in-between that bends its way, and 'fall' of two points alone."""
    rise = UsdSkel.BlendShape.Define(arm.stage, f"{arm.path}/Mesh/rise")
    rise.CreateOffsetsAttr([Gf.Vec3f(0, 0, 1)] * len(ARM_POINTS))
    between = rise.CreateInbetween("half")
    between.SetWeight(0.5)
    between.SetOffsets([Gf.Vec3f(0, 1, 0)] * len(ARM_POINTS))
    fall = UsdSkel.BlendShape.Define(arm.stage, f"{arm.path}/Mesh/fall")
    fall.CreateOffsetsAttr([Gf.Vec3f(0, -1, 0), Gf.Vec3f(0, -2, 0)])
    fall.CreatePointIndicesAttr([3, 8])
    binding = UsdSkel.BindingAPI(arm.mesh)
    binding.CreateBlendShapesAttr(["rise", "fall"])
    binding.CreateBlendShapeTargetsRel().SetTargets([rise.GetPath(), fall.GetPath()])
    blend(arm.animation)


def blend(animation: UsdSkel.Animation) -> None:
    """Weights for them that change at frames 9, 10.25 and 11."""
    animation.CreateBlendShapesAttr(["fall", "unused", "rise"])
    weights = animation.CreateBlendShapeWeightsAttr()
    weights.Set([0.0, 1.0, 0.0], 9)
    weights.Set([0.5, 0.0, 1.0], 10.25)
    weights.Set([1.0, 1.0, -0.5], 11)
