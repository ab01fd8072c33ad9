"""Bounds of what skeletons pose.

A SkelRoot without an authored extent counts in USD as the box around its joints, which cuts off heads and
hands.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np
from pxr import Gf, Tf, Usd, UsdGeom, UsdSkel

from ..motion.boxes import Box
from ..motion.xform_ops import world_transform
from ..stage.tokens import inherited_purpose


class SkinnedBounds:
    """Around the skinned prims below every SkelRoot of a stage that has no authored extent."""

    def __init__(self, stage: Usd.Stage, purposes: set[str]) -> None:
        self._cache = UsdSkel.Cache()
        self._padded: list[tuple[UsdSkel.SkeletonQuery, float]] = []
        for prim in Usd.PrimRange.Stage(stage, Usd.TraverseInstanceProxies()):
            # The type's name is much the quickest thing to ask of a hundred thousand prims; nothing derives from it.
            if prim.GetTypeName() == "SkelRoot" and not prim.GetAttribute("extent").HasAuthoredValue():
                self._padded.extend(self._skeletons(UsdSkel.Root(prim), purposes))

    def _skeletons(self, root: UsdSkel.Root, purposes: set[str]) -> Iterator[tuple[UsdSkel.SkeletonQuery, float]]:
        """Each with how far the prims that it poses reach beyond its joints at rest."""
        predicate = Usd.TraverseInstanceProxies()
        try:
            self._cache.Populate(root, predicate)
            bindings = self._cache.ComputeSkelBindings(root, predicate)
        except Tf.ErrorException:  # On some prim, as its reader says.
            return
        for binding in bindings:
            query = self._cache.GetSkelQuery(binding.GetSkeleton())
            rest = query.ComputeJointSkelTransforms(Usd.TimeCode.Default(), True) if query else None
            if not rest:
                continue
            joints = _pivots(rest)
            targets = [target for target in binding.GetSkinningTargets() if _is_seen(target.GetPrim(), purposes)]
            yield query, max((_reach(target, joints) for target in targets), default=0.0)

    def boxes(self, code: Usd.TimeCode) -> Iterator[Box]:
        """One a skeleton, in the world. On the large side: all of it is padded by what reaches furthest."""
        places = UsdGeom.XformCache(code)
        for query, pad in self._padded:
            joints = query.ComputeJointSkelTransforms(code)
            if joints:
                around = _pivots(joints)
                world = np.array(world_transform(places, query.GetPrim()))
                yield Box.around(Box(around.lo - pad, around.hi + pad).corners() @ world[:, :3])


def _pivots(joints: Iterable[Gf.Matrix4d]) -> Box:
    return Box.around(np.array([np.array(joint)[3, :3] for joint in joints]))


def _reach(target: UsdSkel.SkinningQuery, joints: Box) -> float:
    """How far a prim at rest lies outside of the box around the joints at rest.

    As UsdSkelSkinningQuery::ComputeExtentsPadding has it, which knows nothing of a mesh without an authored
    extent.
    """
    boundable = UsdGeom.Boundable(target.GetPrim())
    extent = UsdGeom.Boundable.ComputeExtentFromPlugins(boundable, Usd.TimeCode.EarliestTime())
    if not extent or len(extent) != 2:
        return 0.0
    bind = np.array(target.GetGeomBindTransform())
    mesh = Box.around(Box(np.array(extent[0]), np.array(extent[1])).corners() @ bind[:, :3])
    reach = float(max((joints.lo - mesh.lo).max(), (mesh.hi - joints.hi).max()))
    return reach if reach > 0.0 and np.isfinite(reach) else 0.0


def _is_seen(prim: Usd.Prim, purposes: set[str]) -> bool:
    return prim.IsA(UsdGeom.Boundable) and inherited_purpose(prim) in purposes
