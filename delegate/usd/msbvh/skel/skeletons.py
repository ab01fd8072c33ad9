"""Which skeleton and influences UsdSkel binds to a prim, and the poses of skeletons over the shutter."""

from __future__ import annotations

from collections.abc import Hashable

import numpy as np
from pxr import Sdf, Tf, Usd, UsdSkel

from ..stage.opening import tf_reason
from ..stage.values import diagnostics
from .schema_types import SkelTypes

EVERY_PRIM = Usd.TraverseInstanceProxies(Usd.PrimIsActive & Usd.PrimIsLoaded)
"""Prototypes of point instancers may be mere overs."""

INHERITED = (
    "primvars:skel:jointIndices",
    "primvars:skel:jointWeights",
    "primvars:skel:geomBindTransform",
    "skel:joints",
)
"""What prims inherit of a binding beside the skeleton and its animation."""
BINDING_PROPERTIES = frozenset(("skel:skeleton", "skel:animationSource", *INHERITED))


class Skeletons:
    """UsdSkel's queries of one frame: one cache for all SkelRoots, each pose computed once."""

    def __init__(self) -> None:
        self._cache = UsdSkel.Cache()
        self.types = SkelTypes()
        self._populated: set[Sdf.Path] = set()
        self._binding_parents: dict[Sdf.Path, bool] = {}
        self._roots: dict[Sdf.Path, Usd.Prim | None] = {}
        self._poses: dict[tuple[Sdf.Path, Usd.TimeCode], np.ndarray | None] = {}

    def skinning_query(self, prim: Usd.Prim) -> UsdSkel.SkinningQuery | None:
        """How a prim is skinned, which may be invalid; None outside of SkelRoots, where UsdSkel does not
        apply."""
        root = self._root(prim)
        if root is None:
            return None
        if root.GetPath() not in self._populated:
            self._populated.add(root.GetPath())
            try:
                self._cache.Populate(UsdSkel.Root(root), EVERY_PRIM)
            except Tf.ErrorException as error:  # On some prims; the others' bindings are there.
                message = f"USD cannot evaluate all of its skeletons: {tf_reason(error)}"
                diagnostics().warning(str(root.GetPath()), "", message)
        return self._cache.GetSkinningQuery(prim)

    def _root(self, prim: Usd.Prim) -> Usd.Prim | None:
        """_skel_root(), remembered for parents."""
        parent = prim.GetParent()
        path = parent.GetPath()
        if path not in self._roots:
            self._roots[path] = _skel_root(parent)
        return self._roots[path] or (prim if prim.IsA(UsdSkel.Root) else None)

    def skeleton_query(self, skeleton: UsdSkel.Skeleton) -> UsdSkel.SkeletonQuery:
        """Invalid for a skeleton whose joints make no hierarchy."""
        return self._cache.GetSkelQuery(skeleton)

    def pose(self, skeleton: UsdSkel.Skeleton, code: Usd.TimeCode) -> np.ndarray | None:
        """The skinning transforms of all joints, in the skeleton's order: float64[J, 4, 4]; None where
        UsdSkel has none.

        Each instance's skeleton has a pose of its own; queries name that of the prototype.
        """
        key = (skeleton.GetPath(), code)
        if key not in self._poses:
            query = self.skeleton_query(skeleton)
            matrices = query.ComputeSkinningTransforms(code)
            whole = matrices is not None and len(matrices) == len(query.GetJointOrder())
            self._poses[key] = np.array(matrices, np.float64).reshape(-1, 4, 4) if whole else None
        return self._poses[key]

    def inherited_binding(self, prim: Usd.Prim) -> Hashable:
        """What the prims inside a native instance inherit of skeletal bindings: equal where two instances
        look the same; None where nothing binds.

        A skeleton outside places what is bound to it by itself: such an instance resembles no other.
        """
        if not self._binds_at_or_above(prim):
            return None
        path, binding = prim.GetPath(), UsdSkel.BindingAPI(prim)
        skeleton, animation = binding.GetInheritedSkeleton().GetPrim(), binding.GetInheritedAnimationSource()
        outside = bool(skeleton) and not skeleton.GetPath().HasPrefix(path)
        return (
            _seen_from(path, skeleton),
            _seen_from(path, animation),
            _skel_root(prim) is not None,
            tuple(_source(prim, name) for name in INHERITED),
            str(path) if outside else "",
        )

    def _binds_at_or_above(self, prim: Usd.Prim) -> bool:
        """Remembered for parents: instances come by the thousand."""
        passed, binds = [], False
        at = prim
        while at and not at.IsPseudoRoot() and not binds:
            known = self._binding_parents.get(at.GetPath()) if at != prim else None
            if known is not None:
                binds = known
                break
            passed.append(at.GetPath())
            binds = at.IsA(UsdSkel.Root) or not BINDING_PROPERTIES.isdisjoint(at.GetAuthoredPropertyNames())
            at = at.GetParent()
        self._binding_parents.update(dict.fromkeys(passed[1:], binds))
        return binds


def _skel_root(prim: Usd.Prim) -> Usd.Prim | None:
    """The outermost SkelRoot at or above a prim."""
    found = None
    while prim and not prim.IsPseudoRoot():
        if prim.IsA(UsdSkel.Root):
            found = prim
        prim = prim.GetParent()
    return found


def _seen_from(path: Sdf.Path, prim: Usd.Prim) -> str:
    """The path of a prim, relative where it lies below `path`; empty for none."""
    if not prim:
        return ""
    target = prim.GetPath()
    return str(target.MakeRelativePath(path)) if target.HasPrefix(path) else str(target)


def _source(prim: Usd.Prim, name: str) -> str:
    """The prim at or above that authors a property; empty for none."""
    while prim and not prim.IsPseudoRoot():
        attribute = prim.GetAttribute(name)
        if attribute and attribute.HasAuthoredValue():
            return str(prim.GetPath())
        prim = prim.GetParent()
    return ""
