"""Skinned points at any time code by UsdSkel's own queries."""

from __future__ import annotations

import numpy as np
from pxr import Usd, UsdSkel, Vt


class Skinning:
    """The skinned meshes of a stage."""

    def __init__(self, stage: Usd.Stage) -> None:
        self._cache = UsdSkel.Cache()
        self._queries: dict[str, tuple[UsdSkel.SkinningQuery, UsdSkel.SkeletonQuery, Usd.Prim]] = {}
        predicate = Usd.TraverseInstanceProxies(Usd.PrimIsActive & Usd.PrimIsLoaded & ~Usd.PrimIsAbstract)
        for prim in Usd.PrimRange.Stage(stage, predicate):
            if prim.IsA(UsdSkel.Root):
                self._populate(UsdSkel.Root(prim), predicate)

    def _populate(self, root: UsdSkel.Root, predicate: object) -> None:
        self._cache.Populate(root, predicate)
        for binding in self._cache.ComputeSkelBindings(root, predicate):
            skeleton = self._cache.GetSkelQuery(binding.GetSkeleton())
            for query in binding.GetSkinningTargets():
                # Inside an instance the query's own prim is the shared prototype's, which stands nowhere.
                own = (query, skeleton, binding.GetSkeleton().GetPrim())
                self._queries[str(query.GetPrim().GetPath())] = own

    def points(self, prim: Usd.Prim, time: float) -> tuple[Vt.Vec3fArray, Usd.Prim] | None:
        """The points at a time and the skeleton in whose space they are; None if nothing deforms the prim."""
        if str(prim.GetPath()) not in self._queries:
            return None
        query, skeleton, skeleton_prim = self._queries[str(prim.GetPath())]
        points = Vt.Vec3fArray(prim.GetAttribute("points").Get(time) or ())
        if query.HasBlendShapes():
            points = self._blended(query, skeleton, points, time)
        if not query.HasJointInfluences():  # Blend shapes alone leave the mesh in its own space.
            return points, prim
        transforms = skeleton.ComputeSkinningTransforms(time)
        assert transforms is not None, f"{skeleton.GetPrim().GetPath()}: no skinning transforms"
        assert query.ComputeSkinnedPoints(transforms, points, time), f"{prim.GetPath()}: cannot be skinned"
        return points, skeleton_prim

    def transform(self, prim: Usd.Prim, time: float) -> tuple[np.ndarray, Usd.Prim] | None:
        """float64[4, 4] from a shape's own space to that of the skeleton, which is returned too, where it is
        deformed as a rigid whole; None elsewhere."""
        if str(prim.GetPath()) not in self._queries:
            return None
        query, skeleton, skeleton_prim = self._queries[str(prim.GetPath())]
        if not query.HasJointInfluences() or not query.IsRigidlyDeformed():
            return None
        computed = query.ComputeSkinnedTransform(skeleton.ComputeSkinningTransforms(time), time)
        return np.array(computed), skeleton_prim

    @staticmethod
    def _blended(
        query: UsdSkel.SkinningQuery, skeleton: UsdSkel.SkeletonQuery, points: Vt.Vec3fArray, time: float
    ) -> Vt.Vec3fArray:
        """Blend shapes with their in-betweens, in the mesh's own space before skinning."""
        animation = skeleton.GetAnimQuery()
        weights = animation.ComputeBlendShapeWeights(time) if animation else None
        mapper = query.GetBlendShapeMapper()
        if not weights or mapper is None:
            return points
        shapes = UsdSkel.BlendShapeQuery(UsdSkel.BindingAPI(query.GetPrim()))
        weights = mapper.Remap(weights)
        sub_weights, shape_indices, sub_indices = shapes.ComputeSubShapeWeights(weights)
        shapes.ComputeDeformedPoints(
            sub_weights,
            shape_indices,
            sub_indices,
            shapes.ComputeBlendShapePointIndices(),
            shapes.ComputeSubShapePointOffsets(),
            points,
        )
        return points
