"""Skinned meshes: UsdSkel's poses, read at the times of the shutter that the translator asks for.

Skinned points lie in the skeleton's space: the skeleton's transform places them, the mesh's own does not
count (UsdSkel).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from pxr import Usd, UsdGeom

from .._core import Diagnostic, MeshInput, PixelSize, PoseSampler, Turns
from ..motion.context import FrameContext, array
from ..motion.points import RawSamples, Samples
from ..motion.transforms import Motion
from ..motion.turns import NO_TURNS
from ..stage.value_types import FLOAT3S
from ..stage.values import might_vary, required, value
from .bindings import SkelBinding
from .faults import report_unusable_pose
from .joint_turns import joint_turns
from .skeletons import Skeletons


@dataclass
class Skinned:
    """A mesh over the shutter as its skeleton moves it."""

    samples: Samples
    """Its points."""
    normals: list[tuple[float, np.ndarray]] | None
    """float32[M, 3] each, with the interpolation that the mesh has authored but no indices."""


class Poser:
    """A mesh and its skeleton as the translator's PoseSource. Each pose is made once, however often it is asked for."""

    def __init__(self, binding: SkelBinding, mesh: MeshInput, rest: Samples, context: FrameContext) -> None:
        self._binding = binding
        self._context = context
        self._moving_rest = _moving_points(binding.prim, context)
        self._rest = rest.values[0][1]
        if self._moving_rest is not None or binding.prim.IsA(UsdGeom.PointBased):
            self._rest = array(
                required(UsdGeom.PointBased(binding.prim).GetPointsAttr(), context.code, FLOAT3S), np.float32, 3
            )
        self._warn_of_velocities(binding)
        normals, normal_points = _rest_normals(binding, mesh, len(self._rest), context)
        self._shapes = [] if binding.shapes is None else binding.shapes.shapes
        self._sampler = PoseSampler(
            path=str(binding.prim.GetPath()),
            points=self._rest,
            normals=normals,
            normal_points=normal_points,
            sub_shapes=self._shapes,
            **binding.influences,
        )

    def skinned(self, placed: Motion, pixel_size: PixelSize, tolerance_pixels: float) -> Skinned | None:
        """The skinned points and normals, as dense as straight lines between them need; None, with an error, where the
        core cannot use the binding. `placed` is how the space that they lie in moves."""
        found, diagnostics = self._sampler.sample(self, placed, pixel_size, tolerance_pixels, self._context.held)
        self._report(diagnostics)
        if found is None:
            return None
        if not found.follows:
            self._warn_of_coarse_poses(len(found.points))
        return Skinned(Samples(found.points, found.held), found.normals or None)

    def _report(self, diagnostics: list[Diagnostic]) -> None:
        for found in diagnostics:
            if found.severity == "error":
                message = f"{found.message}; the prim is not drawn"
                self._context.diagnostics.error(found.path, found.attribute, message)
            else:
                self._context.diagnostics.warning(found.path, found.attribute, found.message)

    def _warn_of_velocities(self, binding: SkelBinding) -> None:
        velocities = binding.prim.GetAttribute("velocities")
        if velocities and velocities.HasAuthoredValue():
            message = "not used on a skinned mesh, whose joints say how it moves (UsdSkel)"
            self._context.diagnostics.group(str(binding.prim.GetPath()), "velocities", message)

    def _warn_of_coarse_poses(self, count: int) -> None:
        """Where no affordable number of poses lets straight lines follow."""
        message = (
            f"poses are read at {count} times of the shutter, too few for --motion-tolerance; a shorter shutter helps"
        )
        self._context.diagnostics.group(str(self._binding.prim.GetPath()), "skel:animationSource", message)

    @cached_property
    def _times(self) -> list[float] | None:
        """Time codes within the shutter at which anything that acts on the mesh has samples; None where nothing may
        change."""
        shutter, binding = self._context.shutter, self._binding
        if not shutter.moving:
            return None
        found: list[list[float]] = []
        if self._moving_rest is not None:
            found.append(self._moving_rest.GetTimeSamplesInInterval(shutter.interval))
        if self._joints_may_vary:
            found.append(binding.animation.GetJointTransformTimeSamplesInInterval(shutter.interval))
        if binding.shapes is not None and binding.animation.BlendShapeWeightsMightBeTimeVarying():
            found.append(binding.animation.GetBlendShapeWeightTimeSamplesInInterval(shutter.interval))
        return sorted(set().union(*found)) if found else None

    @property
    def _joints_may_vary(self) -> bool:
        animation = self._binding.animation
        return bool(self._binding.joints is not None and animation and animation.JointTransformsMightBeTimeVarying())

    @property
    def still(self) -> bool:
        """Nothing that acts on the mesh changes over the shutter."""
        return self._times is None

    @property
    def breakpoints01(self) -> list[float]:
        """Authored times of what acts on it."""
        return [self._context.shutter.time01(time) for time in self._times or ()]

    def turns(self) -> Turns:
        """How far any joint turns at most within the shutter, with all that it hangs on."""
        if not self._joints_may_vary:
            return NO_TURNS
        return joint_turns(self._binding.animation, self._context.shutter)

    @property
    def moves_rest(self) -> bool:
        """Whether the rest points change."""
        return self._moving_rest is not None

    def evaluate(self, times01: list[float]) -> tuple[np.ndarray | None, np.ndarray | None, np.ndarray | None] | None:
        """Skinning transforms, weights of blend shapes and, of the one time, rest points that change; None, with an
        error, where the animation has no numbers."""
        binding, context = self._binding, self._context
        codes = [context.shutter.time_code(time01) for time01 in times01]
        rest = None if self._moving_rest is None else self._rest_at(self._moving_rest, codes[0])
        joints = _joints(binding, codes, context)
        if joints is not None and report_unusable_pose(binding, joints, codes, context):
            return None
        weights = None
        if binding.shapes is not None and self._shapes:
            weights = np.array([binding.shapes.weights(code, context) for code in codes])
        return joints, weights, rest

    def _rest_at(self, moving: Usd.Attribute, code: Usd.TimeCode) -> np.ndarray:
        rest = array(value(moving, code, FLOAT3S), np.float32, 3)
        if len(rest) == len(self._rest):
            return rest
        message = f"found {len(rest)} points within the shutter, expected {len(self._rest)}; held the frame's"
        self._context.diagnostics.warning(str(self._binding.prim.GetPath()), "points", message)
        return self._rest


def _joints(binding: SkelBinding, codes: list[Usd.TimeCode], context: FrameContext) -> np.ndarray | None:
    """The skinning transforms in the mesh's joint order, float64[T, J, 4, 4]: the identity for joints that
    the skeleton does not have (UsdSkelAnimMapper)."""
    if binding.joints is None:
        return None
    poses = np.array([context.cache(Skeletons).pose(binding.skeleton, code) for code in codes])
    identity = np.broadcast_to(np.eye(4), (len(codes), 1, 4, 4))
    return np.ascontiguousarray(np.concatenate([poses, identity], axis=1)[:, binding.joints])


def _moving_points(prim: Usd.Prim, context: FrameContext) -> Usd.Attribute | None:
    """The points of a mesh whose rest pose changes over the shutter."""
    if not prim.IsA(UsdGeom.PointBased) or not context.shutter.moving:
        return None
    attribute = UsdGeom.PointBased(prim).GetPointsAttr()
    return attribute if might_vary(attribute) else None


def _rest_normals(
    binding: SkelBinding, mesh: MeshInput, point_count: int, context: FrameContext
) -> tuple[np.ndarray | None, np.ndarray | None]:
    """The rest normals at the frame without indices, and the point of each; None for one normal a point."""
    if mesh.normals is None:
        return None, None
    path = str(binding.prim.GetPath())
    values, interpolation = _nearest(mesh.normals, context), mesh.normals_interpolation
    if len(mesh.normals) > 1:
        message = "the rest normals of a skinned mesh change within the shutter; held the frame's"
        context.diagnostics.group(path, "normals", message)
    indices = mesh.normals_indices
    if indices is not None:
        if len(indices) and (indices.min() < 0 or indices.max() >= len(values)):
            message = f"found an index outside 0 to {len(values) - 1}; left out"
            context.diagnostics.warning(path, "primvars:normals:indices", message)
            return None, None
        values = np.ascontiguousarray(values[indices])
    if binding.influences["constant_influences"] and binding.shapes is None and point_count:
        return values, np.zeros(len(values), np.int32)
    if interpolation in ("vertex", "varying"):
        return values, None
    if interpolation == "faceVarying":
        return values, mesh.face_vertex_indices
    message = f"{interpolation} normals of a skinned mesh have no joints to follow; left out"
    context.diagnostics.group(path, "normals", message)
    return None, None


def _nearest(samples: RawSamples, context: FrameContext) -> np.ndarray:
    """The sample next to the frame."""
    if len(samples) == 1:
        return samples[0][1]
    at_frame = context.shutter.frame01_unclamped
    return min(samples, key=lambda sample: abs((sample[0] or 0.0) - at_frame))[1]
