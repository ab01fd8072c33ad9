"""What usd-core itself says is on a stage at any time code: the polygons of everything that is drawn.

Nothing here knows how the renderer reads a stage. Transforms come from UsdGeom.XformCache, points from
PointBased.ComputePointsAtTime, instances from PointInstancer.ComputeInstanceTransformsAtTime, skinning from
UsdSkel's queries, all at the very time asked for; no tracks, no keys. Where usd-core computes nothing, the
rule of its documentation is applied: motion:blurScale, motion:velocityScale, topology that changes.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from limit_surface import Cage
from msbvh import _core
from msbvh.base.errors import Diagnostics
from msbvh.motion.context import FrameContext
from msbvh.motion.times import Shutter
from msbvh.scene.implicit import IMPLICIT_TYPES, SIDES, read_implicit
from pxr import Gf, Sdf, Usd, UsdGeom
from round_truth import bezier_vertices, drawn_curves, drawn_points
from skinning_truth import Skinning

DEFINED = Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)
PROTOTYPE = Usd.TraverseInstanceProxies(Usd.PrimIsActive & Usd.PrimIsLoaded & ~Usd.PrimIsAbstract)
"""Prototypes of point instancers may be mere overs."""


@dataclass(frozen=True)
class Polygons:
    """A mesh at one time, and every place where it stands."""

    path: str
    points: np.ndarray
    """float64[N, 3] in a space of its own."""
    world_from_points: np.ndarray
    """float64[I, 4, 4] for row vectors: one for each instance, [1, 4, 4] outside of instancers."""
    counts: np.ndarray
    """int[F] vertices a face; holes are left out."""
    indices: np.ndarray
    """int[sum(counts)]."""

    def world_points(self) -> np.ndarray:
        """float64[I, N, 3]."""
        matrices = self.world_from_points
        return self.points @ matrices[:, :3, :3] + matrices[:, None, 3, :3]


class StageTruth:
    """A frame of a stage. Times are time codes; the topology is the frame's."""

    def __init__(
        self,
        stage: Usd.Stage,
        frame: float,
        shutter: tuple[float, float] = (0.0, 0.0),
        purposes: tuple[str, ...] = ("proxy",),
        subdivisions: int = 0,
    ) -> None:
        """`shutter` is opening and closing relative to the frame: where a topology changes within it, the
        pose is held. `purposes` are drawn beside the default one. `subdivisions`: steps by which cages are refined; 0: they
        are drawn as polygons."""
        self._uses_motion_api = any(prim.HasAPI(UsdGeom.MotionAPI) for prim in _every_prim(stage))
        self.stage = _with_scaled_velocities(stage, frame) if self._uses_motion_api else stage
        self.frame = frame
        self._shutter = (frame + shutter[0], frame + shutter[1])
        self._purposes = {"default", *purposes}
        self._caches: dict[float, UsdGeom.XformCache] = {}
        self._holds: dict[str, bool] = {}
        self._skinning = Skinning(self.stage)
        self._subdivisions = subdivisions
        self._surfaces: dict[tuple, Cage] = {}

    def polygons(self, time: float, eye: np.ndarray | None = None, vertices: bool = False) -> list[Polygons]:
        """Everything visible at a time code; curves and points where there is an eye, as it sees them, or where their
        vertices are wanted: of curves the Bezier vertices, as if of one polygon."""
        self._caches.clear()
        self._eye, self._vertices = eye, vertices
        return list(self._drawn(self.stage.GetPseudoRoot(), None, np.eye(4)[None], time, DEFINED))

    def world_points(self, path: str, time: float) -> np.ndarray:
        """The points of one mesh, or of one instance proxy, that stands in the world: float64[N, 3]."""
        self._caches.clear()
        return self._mesh(self.stage.GetPrimAtPath(path), None, np.eye(4)[None], time).world_points()[0]

    def instance_points(self, time: float) -> dict[str, np.ndarray]:
        """World-space points float64[N, 3] by `path`, or `path[i]` where a point instancer draws it."""
        found = {}
        for drawn in self.polygons(time):
            every = drawn.world_points()
            for i, points in enumerate(every):
                found[drawn.path if len(every) == 1 else f"{drawn.path}[{i}]"] = points
        return found

    def camera(self, path: str, time: float) -> Gf.Camera:
        """The camera at a time code."""
        return UsdGeom.Camera.Get(self.stage, path).GetCamera(time)

    def _drawn(
        self, top: Usd.Prim, root: Usd.Prim | None, world: np.ndarray, time: float, predicate: object
    ) -> Iterator[Polygons]:
        """The shapes below `top` at a time; `root` is the prototype's root, `world` float64[I, 4, 4] its instances'
        places, to which the root's own transform leads. What hides the root's ancestors does not count."""
        prims = iter(Usd.PrimRange(top, predicate))
        for prim in prims:
            if _is_invisible(prim, time):
                prims.PruneChildren()
            elif prim.IsA(UsdGeom.PointInstancer):
                prims.PruneChildren()
                if self._has_purpose(prim):
                    yield from self._instances(UsdGeom.PointInstancer(prim), root, world, time)
            elif (prim.IsA(UsdGeom.Mesh) or prim.GetTypeName() in IMPLICIT_TYPES) and self._has_purpose(prim):
                drawn = self._mesh(prim, root, world, time)
                if len(drawn.points):
                    yield drawn
            elif (self._eye is not None or self._vertices) and self._has_purpose(prim) and prim.IsA(UsdGeom.PointBased):
                yield from self._round(UsdGeom.PointBased(prim), root, world, time)

    def _instances(
        self, instancer: UsdGeom.PointInstancer, root: Usd.Prim | None, world: np.ndarray, time: float
    ) -> Iterator[Polygons]:
        """USD's own instance transforms, instances of the mask alone, by prototype. A prototype's root is a prim of
        its own, with a motion:blurScale of its own."""
        prim_time = self._prim_time(instancer.GetPrim(), time)
        exclude = UsdGeom.PointInstancer.ExcludeProtoXform
        every = UsdGeom.PointInstancer.IgnoreMask
        computed = instancer.ComputeInstanceTransformsAtTime(prim_time, self.frame, exclude, every)
        matrices = np.array(computed, float).reshape(-1, 4, 4)
        indices, mask = self._shown(instancer, prim_time, time)
        indices = np.where(mask, indices, -1) if len(mask) == len(indices) else indices
        if not len(matrices):  # USD computes none where positions are missing or do not fit.
            return
        assert len(indices) == len(matrices), f"{instancer.GetPath()}: {len(indices)} != {len(matrices)}"
        above = self._relative(instancer.GetPrim(), root, prim_time, time)
        places = np.einsum("mij,jk,wkl->wmil", matrices, above, world)
        for index, path in enumerate(instancer.GetPrototypesRel().GetForwardedTargets()):
            prototype, chosen = self.stage.GetPrimAtPath(path), indices == index
            if prototype and chosen.any():
                own = places[:, chosen].reshape(-1, 4, 4)
                yield from self._drawn(prototype, prototype, own, time, PROTOTYPE)

    def _shown(self, instancer: UsdGeom.PointInstancer, prim_time: float, time: float) -> tuple[np.ndarray, np.ndarray]:
        """Prototype indices int[N] and mask bool[N] at a time. Ids and invisibleIds are visibility, which no
        blur scale stretches. Instances that velocities carry, or whose number changes, are the frame's."""
        attribute, ids = instancer.GetProtoIndicesAttr(), instancer.GetIdsAttr()
        indices = np.array(attribute.Get(self.frame) or (), int)
        speeds = (instancer.GetVelocitiesAttr(), instancer.GetAngularVelocitiesAttr())
        same = not any(speed.GetNumTimeSamples() for speed in speeds)
        same = same and not self._differs(attribute, len_only=True)
        if same:
            indices = np.array(attribute.Get(prim_time) or (), int)
        known = ids.Get(time if same else self.frame) or range(len(indices))
        hidden = {*(instancer.GetInvisibleIdsAttr().Get(time) or ()), *_inactive_ids(instancer)}
        return indices, np.array([known_id not in hidden for known_id in known], bool)

    def _mesh(self, prim: Usd.Prim, root: Usd.Prim | None, world: np.ndarray, time: float) -> Polygons:
        """One shape at a time."""
        prim_time, frame = self._prim_time(prim, time), self.frame
        path = str(prim.GetPath())
        if not prim.IsA(UsdGeom.Mesh):
            context = FrameContext(self.stage, Shutter(prim_time), False, Diagnostics())
            surface = _core.MeshInput()
            samples = read_implicit(prim, context).fill(surface, SIDES)
            points = np.asarray(samples.values[0][1], float)
            counts, indices = surface.face_vertex_counts, surface.face_vertex_indices
            rigid = self._skinning.transform(prim, prim_time)
            local = self._relative(prim, root, prim_time, time)
            if rigid is not None:
                local = rigid[0] @ self._relative(rigid[1], root, prim_time, time)
            return Polygons(path, points, local @ world, counts, indices)
        mesh = UsdGeom.Mesh(prim)
        point_time = frame if self._holds_pose(mesh) else prim_time
        skinned = self._skinning.points(prim, point_time)
        if skinned is None:
            points, space = mesh.ComputePointsAtTime(point_time, frame), prim
        else:
            points, space = skinned
        topology_time = frame if self._topology_varies(mesh) else prim_time
        matrices = self._relative(space, root, prim_time, time) @ world
        own = np.array(points, float).reshape(-1, 3)
        if self._subdivisions and mesh.GetSubdivisionSchemeAttr().Get() != UsdGeom.Tokens.none:
            surface = self._surface(mesh, len(own), topology_time)
            return Polygons(path, surface.weights @ own, matrices, *surface.drawn())
        return Polygons(path, own, matrices, *self._topology(mesh, topology_time))

    def _surface(self, mesh: UsdGeom.Mesh, count: int, time: float) -> Cage:
        """The cage of a mesh of `count` points, refined; holes are those of a time, all else is the frame's."""
        holes = tuple(mesh.GetHoleIndicesAttr().Get(time) or ())
        key = str(mesh.GetPath()), count, holes
        if key not in self._surfaces:
            self._surfaces[key] = cage_of(mesh, count, holes, self.frame).refined(self._subdivisions)
        return self._surfaces[key]

    def _round(
        self, prim: UsdGeom.PointBased, root: Usd.Prim | None, world: np.ndarray, time: float
    ) -> Iterator[Polygons]:
        """Curves or points at a time, each place of theirs by itself, since it is seen from elsewhere."""
        curves = UsdGeom.BasisCurves(prim)
        shape = curves or UsdGeom.Points(prim)
        if not shape:
            return
        prim_time, frame = self._prim_time(prim.GetPrim(), time), self.frame
        varies = self._differs(prim.GetPointsAttr(), len_only=True)
        varies = varies or (bool(curves) and self._differs(curves.GetCurveVertexCountsAttr(), len_only=False))
        held = varies and not self._carried(prim)
        skinned = self._skinning.points(prim.GetPrim(), frame if held else prim_time)
        points, space = skinned or (prim.ComputePointsAtTime(frame if held else prim_time, frame), prim.GetPrim())
        own = np.array(points, float).reshape(-1, 3)
        places = self._relative(space, root, prim_time, time) @ world
        if self._vertices:
            if curves:
                own = bezier_vertices(curves, own, frame if varies else prim_time)
            yield Polygons(str(prim.GetPath()), own, places, np.array([max(3, len(own))]), np.arange(len(own)))
            return
        widths = np.array(shape.GetWidthsAttr().Get(frame if varies else prim_time), float)
        normals = np.array(prim.GetNormalsAttr().Get(prim_time) or (), float).reshape(-1, 3)
        for matrix in places:
            there, size = own @ matrix[:3, :3] + matrix[3, :3], abs(np.linalg.det(matrix[:3, :3])) ** (1 / 3)
            across = normals @ np.linalg.inv(matrix[:3, :3]).T if len(normals) else None
            if curves:
                drawn = drawn_curves(curves, there, size * widths, across, self._eye, frame if varies else prim_time)
            else:
                drawn = drawn_points(there, size * widths, self._eye)
            yield Polygons(str(prim.GetPath()), drawn[0], np.eye(4)[None], drawn[1], drawn[2])

    def _relative(self, prim: Usd.Prim, root: Usd.Prim | None, prim_time: float, time: float) -> np.ndarray:
        """float64[4, 4] to the space in which `root` is instanced, or to the world. The root's own transform is taken
        at its own time; a reset in between leads past it (UsdImaging resets the stack at the root)."""
        cache = self._cache(prim_time)
        if root is None:
            return np.array(cache.GetLocalToWorldTransform(prim))
        own = np.array(self._cache(self._prim_time(root, time)).GetLocalTransformation(root)[0])
        if prim == root:
            return own
        between, resets = cache.ComputeRelativeTransform(prim, root)
        return np.array(between) if resets else np.array(between) @ own

    def _cache(self, time: float) -> UsdGeom.XformCache:
        return self._caches.setdefault(time, UsdGeom.XformCache(time))

    def _prim_time(self, prim: Usd.Prim, time: float) -> float:
        """motion:blurScale stretches a prim's whole motion about the frame (UsdGeomMotionAPI)."""
        if not self._uses_motion_api:
            return time
        scale = UsdGeom.MotionAPI(prim).ComputeMotionBlurScale(self.frame)
        return self.frame + scale * (time - self.frame)

    def _has_purpose(self, prim: Usd.Prim) -> bool:
        return str(UsdGeom.Imageable(prim).ComputePurpose()) in self._purposes

    def _topology(self, mesh: UsdGeom.Mesh, time: float) -> tuple[np.ndarray, np.ndarray]:
        """The frame's face counts and indices, without the holes of a time."""
        counts = np.array(mesh.GetFaceVertexCountsAttr().Get(self.frame) or (), int)
        indices = np.array(mesh.GetFaceVertexIndicesAttr().Get(self.frame) or (), int)
        solid = np.ones(len(counts), bool)
        solid[np.array(mesh.GetHoleIndicesAttr().Get(time) or (), int)] = False
        return counts[solid], indices[np.repeat(solid, counts)]

    def _holds_pose(self, mesh: UsdGeom.Mesh) -> bool:
        """Whether the topology changes within the shutter and no velocities carry the frame's points."""
        path = str(mesh.GetPath())
        if path not in self._holds:
            varies = self._topology_varies(mesh) or self._differs(mesh.GetPointsAttr(), len_only=True)
            self._holds[path] = varies and not self._carried(mesh)
        return self._holds[path]

    def _topology_varies(self, mesh: UsdGeom.Mesh) -> bool:
        """Whether faces are others within the shutter than at the frame."""
        attributes = (mesh.GetFaceVertexCountsAttr(), mesh.GetFaceVertexIndicesAttr())
        return any(self._differs(attribute, len_only=False) for attribute in attributes)

    def _differs(self, attribute: Usd.Attribute, len_only: bool) -> bool:
        """Whether an array, or its length, is not the frame's everywhere in the shutter."""
        opening, closing = self._shutter
        inside = attribute.GetTimeSamplesInInterval(Gf.Interval(opening, closing))
        values = [attribute.Get(time) for time in (self.frame, opening, *inside)]
        if len_only:
            return len({len(value) for value in values if value is not None}) > 1
        return any(value != values[0] for value in values)

    def _carried(self, mesh: UsdGeom.Mesh) -> bool:
        """Whether velocities belong to the sample of the points that is the frame's (ComputePointsAtTime)."""
        velocities, points = mesh.GetVelocitiesAttr(), mesh.GetPointsAttr()
        around = points.GetBracketingTimeSamples(self.frame)
        if not around or velocities.GetBracketingTimeSamples(self.frame) != around:
            return False
        return len(velocities.Get(around[0]) or ()) == len(points.Get(around[0]) or ()) > 0


def cage_of(mesh: UsdGeom.Mesh, count: int, holes: tuple[int, ...], frame: float) -> Cage:
    """A mesh's cage at a frame."""

    def found(name: str) -> list:
        return list(mesh.GetPrim().GetAttribute(name).Get(frame) or ())

    ends = np.cumsum(found("faceVertexCounts"))
    indices = found("faceVertexIndices")
    faces = [tuple(indices[end - n : end]) for end, n in zip(ends, found("faceVertexCounts"), strict=True)]
    edges, chain = [], found("creaseIndices")
    lengths, sharpnesses = found("creaseLengths"), found("creaseSharpnesses")
    for length in lengths:
        edges.append(list(itertools.pairwise(chain[:length])))
        chain = chain[length:]
    if len(sharpnesses) == len(lengths):  # one a crease; else one an edge
        sharpnesses = [sharpness for sharpness, of_crease in zip(sharpnesses, edges, strict=True) for _ in of_crease]
    creases = dict(zip(itertools.chain(*edges), sharpnesses, strict=True))
    corners = dict(zip(found("cornerIndices"), found("cornerSharpnesses"), strict=True))
    scheme, boundary = mesh.GetSubdivisionSchemeAttr().Get(), mesh.GetInterpolateBoundaryAttr().Get(frame)
    return Cage.of(faces, count, str(scheme), str(boundary), creases, corners, holes)


def _every_prim(stage: Usd.Stage) -> Iterator[Usd.Prim]:
    """Prims of instances and prototypes included."""
    yield from Usd.PrimRange.Stage(stage, Usd.TraverseInstanceProxies(Usd.PrimAllPrimsPredicate))


def _inactive_ids(instancer: UsdGeom.PointInstancer) -> list[int]:
    """Metadata, a list that layers may edit."""
    return (instancer.GetPrim().GetMetadata("inactiveIds") or Sdf.Int64ListOp()).ApplyOperations([])


def _is_invisible(prim: Usd.Prim, time: float) -> bool:
    """Of its own; visibility is held between samples, as all tokens are."""
    if not prim.IsA(UsdGeom.Imageable):
        return False
    return UsdGeom.Imageable(prim).GetVisibilityAttr().Get(time) == UsdGeom.Tokens.invisible


def _with_scaled_velocities(stage: Usd.Stage, frame: float) -> Usd.Stage:
    """A view of the stage with motion:velocityScale multiplied into its velocities.

    usd-core 26.11 computes the scale, but leaves its use to the renderer. Multiplied in a session layer, the
    rest stays usd-core's own computation: p + scale * v * dt + a * dt^2 / 2.
    """
    scaled = Usd.Stage.Open(stage.GetRootLayer(), _session_copy(stage))
    scaled.SetInterpolationType(stage.GetInterpolationType())
    scaled.SetEditTarget(scaled.GetSessionLayer())
    for prim in _every_prim(scaled):
        scale = UsdGeom.MotionAPI(prim).ComputeVelocityScale(frame)
        for name in ("velocities", "angularVelocities") if scale != 1.0 else ():
            attribute = prim.GetAttribute(name)
            if not attribute or not attribute.HasAuthoredValue():
                continue
            assert not prim.IsInstanceProxy(), f"{prim.GetPath()}: cannot be edited inside an instance"
            # All are read before the first is written, which hides those of the layers below.
            times = attribute.GetTimeSamples() or [Usd.TimeCode.Default()]
            for time, value in [(time, attribute.Get(time)) for time in times]:
                attribute.Set(type(value).FromNumpy(np.array(value) * np.float32(scale)), time)
    return scaled


def _session_copy(stage: Usd.Stage) -> Sdf.Layer:
    copy = Sdf.Layer.CreateAnonymous()
    if stage.GetSessionLayer():
        copy.TransferContent(stage.GetSessionLayer())
    # Another rate would scale the times written to it, and rounded they belong to no sample of the points.
    copy.timeCodesPerSecond = stage.GetTimeCodesPerSecond()
    return copy
