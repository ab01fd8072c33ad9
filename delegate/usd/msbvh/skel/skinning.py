"""Skinned meshes: UsdSkel's poses sampled over the shutter, the arithmetic left to the core.

Skinned points lie in the skeleton's space: the skeleton's transform places them, the mesh's own does not
count (UsdSkel). Joints rotate between their samples on arcs, so poses are sampled until straight lines
between them follow.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from pxr import Usd, UsdGeom

from .._core import TIMES_A_TURN, MeshInput, Turns, even_level, even_times01
from ..motion.boxes import Box
from ..motion.context import FrameContext, array
from ..motion.points import RawSamples, Samples
from ..motion.turns import NO_TURNS
from ..stage.value_types import FLOAT3S
from ..stage.values import might_vary, required, value
from .bindings import SkelBinding
from .faults import report_unusable_pose
from .joint_turns import joint_turns
from .skeletons import Skeletons

COARSEST_LEVEL = 2
"""Poses are sampled at 2^2 intervals at least, and at as many as joints turn for (joint_turns.py)."""
FINEST_LEVEL = 10
"""2^10 intervals at most."""
MOST_POINTS = 2**26
"""Of all poses of a mesh together, 800 MB: no finer level begins beyond it."""
NORMAL_TOLERANCE = 0.005
"""Radians that a normal may stray between samples: half of what its track may (translate/normals.h)."""


@dataclass
class Skinned:
    """A mesh over the shutter as its skeleton moves it."""

    samples: Samples
    """Its points."""
    normals: list[tuple[float, np.ndarray]] | None
    """float32[M, 3] each, with the interpolation that the mesh has authored but no indices."""


class _Rejected(Exception):
    """The core cannot use a binding, and has said why."""


class Poser:
    """Poses a mesh at times of the shutter, each once, however often it is asked."""

    def __init__(self, binding: SkelBinding, mesh: MeshInput, rest: Samples, context: FrameContext) -> None:
        self.points: dict[float, np.ndarray] = {}
        self.normals: dict[float, np.ndarray] = {}
        self._binding = binding
        self._context = context
        self._moving_rest = _moving_points(binding.prim, context)
        self._rest = rest.values[0][1]
        if self._moving_rest is not None or binding.prim.IsA(UsdGeom.Mesh):
            self._rest = array(
                required(UsdGeom.PointBased(binding.prim).GetPointsAttr(), context.code, FLOAT3S), np.float32, 3
            )
        self._warn_of_velocities(binding)
        self._normals, self._normal_points = _rest_normals(binding, mesh, len(self._rest), context)

    def skinned(self, tolerance_units: Callable[[Box], float]) -> Skinned | None:
        """The skinned points and normals; None, with an error, where the core cannot use the binding.

        Between the samples the straight line strays from UsdSkel's pose by at most `tolerance_units(box of the points)`,
        in units of the space that the skeleton places, measured at the middles of the sampling intervals.
        """
        try:
            times01, held = self._sample(tolerance_units)
        except _Rejected:
            return None
        points = [(time01, self.points[time01]) for time01 in times01]
        normals = [(time01, self.normals[time01]) for time01 in times01 if time01 in self.normals]
        return Skinned(Samples(points, held), normals or None)

    def _sample(self, tolerance_units: Callable[[Box], float]) -> tuple[list[float], bool]:
        """The sample times, and whether each holds until the next."""
        varying, authored = self.contributing_times()
        if not varying:
            self.evaluate([0.0])
            return [0.0], False
        breakpoints01 = [self._context.shutter.time01(time) for time in authored]
        if self._context.held:
            times01 = sorted({0.0, *breakpoints01})
            self.evaluate(times01)
            return (times01[:1], False) if self.still(times01) else (times01, True)
        coarsest = max(COARSEST_LEVEL, even_level(TIMES_A_TURN * self.turns().rate))
        times01 = even_times01(coarsest, breakpoints01)
        self.evaluate(times01)
        if self.still(times01):
            return times01[:1], False
        tolerance = tolerance_units(self.box())
        for level in range(coarsest + 1, max(coarsest, FINEST_LEVEL) + 1):
            finer = even_times01(level, breakpoints01)
            if len(finer) * self.point_count > MOST_POINTS:
                break
            self.evaluate(finer)
            if self.follows(times01, finer, tolerance):
                return times01, False
            times01 = finer
        self.warn_of_coarse_poses(len(times01))
        return times01, False

    def _warn_of_velocities(self, binding: SkelBinding) -> None:
        velocities = binding.prim.GetAttribute("velocities")
        if velocities and velocities.HasAuthoredValue():
            message = "not used on a skinned mesh, whose joints say how it moves (UsdSkel)"
            self._context.diagnostics.group(str(binding.prim.GetPath()), "velocities", message)

    def contributing_times(self) -> tuple[bool, list[float]]:
        """Whether anything that acts on the mesh may change over the shutter, and the time codes within it
        where that has samples."""
        shutter, binding = self._context.shutter, self._binding
        times: set[float] = set()
        if not shutter.moving:
            return False, []
        animation = binding.animation
        varying = False
        if self._moving_rest is not None:
            varying = True
            times.update(self._moving_rest.GetTimeSamplesInInterval(shutter.interval))
        if binding.joints is not None and animation and animation.JointTransformsMightBeTimeVarying():
            varying = True
            times.update(animation.GetJointTransformTimeSamplesInInterval(shutter.interval))
        if binding.shapes is not None and animation.BlendShapeWeightsMightBeTimeVarying():
            varying = True
            times.update(animation.GetBlendShapeWeightTimeSamplesInInterval(shutter.interval))
        return varying, sorted(times)

    def turns(self) -> Turns:
        """How far any joint turns at most within the shutter, with all that it hangs on."""
        animation = self._binding.animation
        if self._binding.joints is None or not animation or not animation.JointTransformsMightBeTimeVarying():
            return NO_TURNS
        return joint_turns(animation, self._context.shutter)

    @property
    def point_count(self) -> int:
        """Of a pose."""
        return len(self._rest)

    def warn_of_coarse_poses(self, count: int) -> None:
        """Where no affordable number of poses lets straight lines follow."""
        message = (
            f"poses are read at {count} times of the shutter, too few for --motion-tolerance; a shorter shutter helps"
        )
        self._context.diagnostics.group(str(self._binding.prim.GetPath()), "skel:animationSource", message)

    def evaluate(self, times01: list[float]) -> None:
        """Poses the mesh at those of the times that it has not been at. Raises _Rejected."""
        new = [time01 for time01 in times01 if time01 not in self.points]
        if self._moving_rest is not None:
            for time01 in new:
                self._skin([time01], self._rest_at(time01))
        elif new:
            self._skin(new, self._rest)

    def still(self, times01: list[float]) -> bool:
        """Whether all poses are the same but for rounding: UsdSkel interpolates between equal rotations
        too."""
        return all(_still([values[time] for time in times01 if time in values]) for values in self._posed())

    def box(self) -> Box:
        """Around all poses so far."""
        return Samples(list(self.points.items())).box()

    def follows(self, times01: list[float], finer: list[float], tolerance: float) -> bool:
        """Whether straight lines between the poses stray from those at the finer times by no more than the
        tolerance, and normals by no more than theirs."""
        if _breakpoint(self.points, times01, finer) > tolerance:
            return False
        return not self.normals or _breakpoint(self.normals, times01, finer, unit=True) <= NORMAL_TOLERANCE

    def _posed(self) -> tuple[dict[float, np.ndarray], ...]:
        return self.points, self.normals

    def _rest_at(self, time01: float) -> np.ndarray:
        code = self._context.shutter.time_code(time01)
        rest = array(value(self._moving_rest, code, FLOAT3S), np.float32, 3)
        if len(rest) == len(self._rest):
            return rest
        message = f"found {len(rest)} points within the shutter, expected {len(self._rest)}; held the frame's"
        self._context.diagnostics.warning(str(self._binding.prim.GetPath()), "points", message)
        return self._rest

    def _skin(self, times01: list[float], rest: np.ndarray) -> None:
        from .. import _core

        binding, context = self._binding, self._context
        codes = [context.shutter.time_code(time01) for time01 in times01]
        joints = _joints(binding, codes, context)
        if joints is not None and report_unusable_pose(binding, joints, codes, context):
            raise _Rejected
        shapes = [] if binding.shapes is None else binding.shapes.shapes
        weights = [binding.shapes.weights(code, context) for code in codes] if binding.shapes and shapes else None
        points, normals, diagnostics = _core.skin_points(
            path=str(binding.prim.GetPath()),
            times01=np.array(times01),
            points=rest,
            normals=self._normals,
            normal_points=self._normal_points,
            joints=joints,
            sub_shapes=shapes,
            sub_shape_weights=None if weights is None else np.array(weights),
            **binding.influences,
        )
        for found in diagnostics:
            if found.severity == "error":
                message = f"{found.message}; the prim is not drawn"
                context.diagnostics.error(found.path, found.attribute, message)
            else:
                context.diagnostics.warning(found.path, found.attribute, found.message)
        if points is None:
            raise _Rejected
        self.points.update(zip(times01, points, strict=True))
        if normals is not None:
            self.normals.update(zip(times01, normals, strict=True))


def _still(values: list[np.ndarray]) -> bool:
    if not values:
        return True
    rounding = 4 * np.finfo(np.float32).eps * np.abs(values[0]).max(initial=0.0)
    return all(np.abs(value - values[0]).max(initial=0.0) <= rounding for value in values[1:])


def _breakpoint(values: dict[float, np.ndarray], times01: list[float], finer: list[float], unit: bool = False) -> float:
    """How far values at the finer times stray from straight lines between the others; `unit`: from lines of
    directions."""
    worst = 0.0
    for time01 in sorted(set(finer) - set(times01)):
        after = int(np.searchsorted(times01, time01))
        begin, end = times01[after - 1], times01[after]
        weight = (time01 - begin) / (end - begin)
        straight = (1.0 - weight) * values[begin] + weight * values[end]
        if unit:
            straight /= np.maximum(np.linalg.norm(straight, axis=1, keepdims=True), 1e-30)
        deviation = np.linalg.norm(values[time01] - straight, axis=1)
        worst = max(worst, float(deviation.max(initial=0.0)))
    return worst


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
