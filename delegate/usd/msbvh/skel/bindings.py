"""What UsdSkel binds to a mesh: its skeleton, its influences and its blend shapes, resolved and checked as
far as the core cannot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pxr import Usd, UsdGeom, UsdSkel

from ..motion.context import FrameContext, array
from ..motion.held_values import warn_of_change
from ..stage.value_types import MATRICES
from ..stage.values import targets, value
from .blend_shapes import BlendShapes, read_blend_shapes
from .skeletons import Skeletons

_INDICES, _WEIGHTS = "primvars:skel:jointIndices", "primvars:skel:jointWeights"
_METHODS = ("classicLinear", "dualQuaternion")
_BINDING = (_INDICES, "skel:blendShapes", "skel:skeleton")
_REST = "drawn in its rest pose"


@dataclass(frozen=True)
class SkelBinding:
    """All that is needed to pose a mesh at any time."""

    prim: Usd.Prim
    skeleton: UsdSkel.Skeleton
    animation: UsdSkel.AnimQuery
    """Of the skeleton; invalid where it rests."""
    shapes: BlendShapes | None
    influences: dict
    """Keywords of skin_points that no time changes."""
    joints: np.ndarray | None
    """The skeleton's index of each joint of the mesh, -1 for one that it does not have; None: blend shapes
    act alone."""

    @property
    def placed_by(self) -> Usd.Prim:
        """Whose transform counts: the skeleton, or the mesh itself where blend shapes alone act."""
        return self.prim if self.joints is None else self.skeleton.GetPrim()

    @property
    def moved_by(self) -> Usd.Prim | None:
        """What moves the joints and weights; None where the skeleton rests."""
        return self.animation.GetPrim() if self.animation else None


def read_binding(prim: Usd.Prim, context: FrameContext, authored: frozenset[str]) -> SkelBinding | None:
    """How a shape is skinned. None, with a warning where something is bound, if the prim is drawn at rest."""
    query = context.cache(Skeletons).skinning_query(prim)
    if query is None:
        if not authored.isdisjoint(_BINDING):
            _warn_outside_root(prim, context)
        return None
    if not context.cache(Skeletons).types.check(prim, context.code):
        return None
    if not query or not (query.HasJointInfluences() or query.HasBlendShapes()):
        _warn_of_half_a_binding(prim, context)
        return None
    skeleton = _read_skeleton(prim, query, context)
    if skeleton is None:
        return None
    bound = context.cache(Skeletons).skeleton_query(skeleton)
    shapes = read_blend_shapes(query, bound.GetAnimQuery(), context)
    influences, joints = _no_influences(), None
    if query.HasJointInfluences():
        if not prim.IsA(UsdGeom.PointBased) and not query.IsRigidlyDeformed():
            message = f"found vertex influences on a {prim.GetTypeName()}, expected constant ones; {_REST}"
            context.diagnostics.warning(str(prim.GetPath()), _INDICES, message)
            return None
        influences, joints = _read_influences(query, context), _joint_order(query, skeleton, context)
    elif shapes is None:
        return None
    return SkelBinding(prim, skeleton, bound.GetAnimQuery(), shapes, influences, joints)


def _read_skeleton(prim: Usd.Prim, query: UsdSkel.SkinningQuery, context: FrameContext) -> UsdSkel.Skeleton | None:
    path = str(prim.GetPath())
    skeleton = UsdSkel.BindingAPI(prim).GetInheritedSkeleton()
    if not skeleton:
        bound = _bound_targets(prim)
        found = f"found {', '.join(map(str, bound))}, no Skeleton" if bound else "found no target"
        context.diagnostics.warning(path, "skel:skeleton", f"{found}; expected one Skeleton; {_REST}")
        return None
    skeleton_path = str(skeleton.GetPath())
    bound = context.cache(Skeletons).skeleton_query(skeleton)
    if not bound:
        message = f"found no hierarchy of joints that {path} could follow, expected parents before children"
        context.diagnostics.warning(skeleton_path, "joints", f"{message}; {_REST}")
        return None
    if not query.HasJointInfluences():
        return skeleton
    if not bound.HasBindPose():
        count = len(_matrices(skeleton.GetBindTransformsAttr()))
        message = f"found {count} matrices, expected {len(bound.GetJointOrder())}, one a joint, to skin {path}"
        context.diagnostics.warning(skeleton_path, "bindTransforms", f"{message}; {_REST}")
        return None
    if context.cache(Skeletons).pose(skeleton, context.code) is None:
        count = len(_matrices(skeleton.GetRestTransformsAttr()))
        message = f"found {count} matrices and no animation of all joints, expected {len(bound.GetJointOrder())}"
        context.diagnostics.warning(skeleton_path, "restTransforms", f"{message}, to skin {path}; {_REST}")
        return None
    return skeleton


def _matrices(attribute: Usd.Attribute) -> Sequence[object]:
    return value(attribute, Usd.TimeCode.Default(), MATRICES) or ()


def _bound_targets(prim: Usd.Prim) -> list:
    """Of the nearest skel:skeleton at or above a prim."""
    while prim and not prim.IsPseudoRoot():
        relationship = prim.GetRelationship("skel:skeleton")
        if relationship and relationship.HasAuthoredTargets():
            return targets(prim, "skel:skeleton")
        prim = prim.GetParent()
    return []


def _no_influences() -> dict:
    return {
        "method": _METHODS[0],
        "joint_indices": None,
        "joint_weights": None,
        "influences_per_point": 1,
        "constant_influences": False,
        "geom_bind": np.eye(4),
    }


def _read_influences(query: UsdSkel.SkinningQuery, context: FrameContext) -> dict:
    """The keywords of skin_points that say how joints act, at the frame. Counts are the core's to check."""
    path, code = str(query.GetPrim().GetPath()), context.code
    indices, weights = query.GetJointIndicesPrimvar(), query.GetJointWeightsPrimvar()
    bind = query.GetGeomBindTransformAttr()
    for attribute in (indices.GetAttr(), weights.GetAttr(), bind):
        warn_of_change(attribute, "", context.shutter, context.diagnostics)
    method = str(query.GetSkinningMethod())
    if method not in _METHODS:
        message = f"found '{method}', expected classicLinear or dualQuaternion; took classicLinear"
        context.diagnostics.warning(path, "primvars:skel:skinningMethod", message)
        method = _METHODS[0]
    return {
        "method": method,
        "joint_indices": array(indices.ComputeFlattened(code), np.int32),
        "joint_weights": array(weights.ComputeFlattened(code), np.float32),
        "influences_per_point": query.GetNumInfluencesPerComponent(),
        "constant_influences": query.IsRigidlyDeformed(),
        "geom_bind": np.array(query.GetGeomBindTransform(code), np.float64),
    }


def _joint_order(query: UsdSkel.SkinningQuery, skeleton: UsdSkel.Skeleton, context: FrameContext) -> np.ndarray:
    """The skeleton's index of each joint that the mesh's indices count; -1 for those it does not have."""
    known = {
        str(name): index for index, name in enumerate(context.cache(Skeletons).skeleton_query(skeleton).GetJointOrder())
    }
    order = query.GetJointOrder()
    if order is None:
        return np.arange(len(known))
    unknown = [str(name) for name in order if str(name) not in known]
    if unknown:
        path = str(query.GetPrim().GetPath())
        message = f"found {len(unknown)} joints that {skeleton.GetPath()} does not have ('{unknown[0]}')"
        context.diagnostics.warning(path, "skel:joints", f"{message}; they stay as they are bound")
    return np.array([known.get(str(name), -1) for name in order], int)


def _warn_outside_root(prim: Usd.Prim, context: FrameContext) -> None:
    for name in _BINDING:
        found = prim.GetProperty(name)
        if found and found.IsAuthored():
            message = f"no SkelRoot above, expected one for skinning to apply (UsdSkel); {_REST}"
            context.diagnostics.group(str(prim.GetPath()), name, message)
            return


def _warn_of_half_a_binding(prim: Usd.Prim, context: FrameContext) -> None:
    """UsdSkel ignores influences that do not agree in element size and interpolation."""
    primvars = UsdGeom.PrimvarsAPI(prim)
    indices, weights = primvars.GetPrimvar("skel:jointIndices"), primvars.GetPrimvar("skel:jointWeights")
    has = [bool(primvar) and primvar.HasAuthoredValue() for primvar in (indices, weights)]
    path = str(prim.GetPath())
    if all(has):
        found = ", ".join(
            f"{primvar.GetInterpolation()} with elementSize {primvar.GetElementSize()}"
            for primvar in (indices, weights)
        )
        message = f"found {found} for indices and weights, expected both constant or both vertex, of one size"
        context.diagnostics.warning(path, _INDICES, f"{message}; {_REST}")
    elif any(has):
        missing = _INDICES if has[1] else _WEIGHTS
        context.diagnostics.warning(path, missing, f"not authored, expected beside the other; {_REST}")
