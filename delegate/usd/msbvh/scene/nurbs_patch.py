"""NurbsPatch prims: what they are, looked up here, and the polygons that they are drawn as, which the core makes."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from math import nan

import numpy as np
from pxr import Usd, UsdGeom

from .._core import MeshInput, NurbsGrid, PixelSize
from .._core import NurbsPatch as Patch
from ..motion.boxes import Box
from ..motion.context import FrameContext, array
from ..motion.held_values import warn_of_change
from ..motion.points import RawSamples, Samples, sample_points
from ..motion.times import sample_times
from ..stage.value_types import DOUBLE2, DOUBLES, FLOAT3S, INT, INTS
from ..stage.values import Unreadable, might_vary, required, value
from .primvars import MovingPrimvar

_DENSE = 16
"""Times at which a patch is evaluated between two samples of weights that change: no line follows it there."""


@dataclass
class NurbsShape:
    """A patch over the shutter, read once; polygons at as many points as its size calls for."""

    path: str
    patch: Patch
    controls: Samples
    """Its control points."""
    context: FrameContext
    weights: np.ndarray | None = None
    """float64[N], at the frame; None: not rational."""
    moving_weights: list[np.ndarray] | None = None
    """For each of the samples, where they change within the shutter."""

    @property
    def box(self) -> Box:
        """Around its control points over the shutter, and so around the surface: weights are positive."""
        return self.controls.box()

    def refined(
        self, mesh: MeshInput, controls: Samples, matrices: np.ndarray, pixel_size: PixelSize, edge_pixels: float
    ) -> tuple[Samples, RefinedPatch]:
        """Sets the topology and what carries the points, for control points as the shape's own, or as a skeleton has
        moved them. Returns the points, and what the mesh's primvars are still to be refined by."""
        poses = [points for _, points in controls.values]
        weights = self.weights
        u, v, said = self.patch.cells(self.path, poses, weights, matrices, pixel_size, edge_pixels)
        self.context.diagnostics.take(said)
        grid = self.patch.grid(u, v, poses, weights, _varies(mesh))
        if not len(grid.counts):
            self.context.diagnostics.group(self.path, "", "empty: its surface is a point", "note")
        mesh.face_vertex_counts, mesh.face_vertex_indices = grid.counts, grid.indices
        mesh.velocities, mesh.accelerations = (
            None if rates is None else self._rates(rates, grid) for rates in (mesh.velocities, mesh.accelerations)
        )
        mesh.computed_points, mesh.stray = True, nan
        every = self.moving_weights if controls is self.controls else None
        points = [
            (time01, grid.positions(pose, every[number] if every else weights))
            for number, (time01, pose) in enumerate(controls.values)
        ]
        return Samples(points, controls.held), RefinedPatch(self.path, self.patch, grid, weights, self.context)

    def _rates(self, rates: RawSamples, grid: NurbsGrid) -> RawSamples:
        """Of the points; none of a sample that has another number of them."""
        count, none = self.patch.control_count, np.zeros((0, 3), np.float32)
        return [(time01, grid.positions(each, self.weights) if len(each) == count else none) for time01, each in rates]


@dataclass(frozen=True)
class RefinedPatch:
    """What primvars of a patch become on its polygons."""

    path: str
    patch: Patch
    grid: NurbsGrid
    weights: np.ndarray | None
    context: FrameContext

    def set_primvars(self, mesh: MeshInput) -> None:
        """From those of the patch to those of its polygons."""
        mesh.display_color = self._refined(mesh.display_color, "primvars:displayColor")
        mesh.display_opacity = self._refined(mesh.display_opacity, "primvars:displayOpacity")

    def set_named_primvars(self, mesh: MeshInput) -> None:
        """Likewise of those that materials read."""
        refined = {name: self._refined(each, f"primvars:{name}") for name, each in (mesh.named_primvars or {}).items()}
        mesh.named_primvars = {name: each for name, each in refined.items() if each is not None}

    def _refined(self, primvar: MovingPrimvar | None, attribute: str) -> MovingPrimvar | None:
        if primvar is None:
            return None
        interpolation, values, indices = primvar
        count = len(values[0][1]) if isinstance(values, list) else len(values)
        fits, said = self.patch.check_primvar(self.path, attribute, interpolation, count, indices)
        self.context.diagnostics.take(said)
        if not fits:
            return None
        if interpolation == "constant":
            return primvar
        if interpolation == "uniform":
            return interpolation, values, self.grid.segments if indices is None else indices[self.grid.segments]

        def at_points(given: np.ndarray) -> np.ndarray:
            chosen = np.ascontiguousarray(given if indices is None else given[indices])
            if interpolation == "varying":
                return self.grid.varying_values(chosen)
            return self.grid.vertex_values(chosen, self.weights)

        if isinstance(values, list):
            return "vertex", [(time01, at_points(each)) for time01, each in values], None
        return "vertex", at_points(values), None


def _varies(mesh: MeshInput) -> bool:
    """Whether a primvar may have several values where the surface closes."""
    primvars = (mesh.display_color, mesh.display_opacity)
    return any(primvar is not None and primvar[0] in ("varying", "vertex") for primvar in primvars)


def read_nurbs_patch(prim: Usd.Prim, context: FrameContext, authored: frozenset[str]) -> tuple[NurbsShape, dict] | None:
    """A patch, and the translator's names of its velocities and accelerations; None, with an error, for what makes no
    surface. Raises Unreadable."""
    path = prim.GetPath().pathString
    patch, said = Patch.make(path, *(_axis(prim, name, context) for name in ("u", "v")))
    context.diagnostics.take(said)
    if patch is None:
        return None
    samples, carried_by = sample_points(UsdGeom.PointBased(prim), context, "velocities" in authored)
    fitting = _of_count(samples, patch.control_count, path, context)
    for time01, points in fitting.values:
        sound, said = patch.check_points(path, 0.0 if time01 is None else time01, points)
        context.diagnostics.take(said)
        if not sound:
            return None
    for name, rates in carried_by.items():
        _warn_of_rates(name, rates, patch.control_count, path, context)
    _warn_of_trim_curves(prim, context)
    shape = NurbsShape(path, patch, fitting, context)
    if "pointWeights" in authored:
        _add_weights(shape, prim, bool(carried_by))
    return shape, carried_by


def _axis(prim: Usd.Prim, name: str, context: FrameContext) -> tuple:
    """A direction as the core takes it."""
    code = context.code

    def at_frame(attribute: str) -> Usd.Attribute:
        found = prim.GetAttribute(f"{name}{attribute}")
        warn_of_change(found, ", as the topology", context.shutter, context.diagnostics)
        return found

    count, order = (required(at_frame(each), code, INT) for each in ("VertexCount", "Order"))
    knots = array(required(at_frame("Knots"), code, DOUBLES), np.float64)
    given = required(at_frame("Range"), code, DOUBLE2)
    return count or 0, order or 0, knots, None if given is None else tuple(given)


def _of_count(samples: Samples, count: int, path: str, context: FrameContext) -> Samples:
    """Those samples that have a point for each control point. Raises Unreadable where the frame's has not."""
    found = len(samples.at_frame(context))
    if found != count:
        raise Unreadable(
            path, "points", f"found {found} points, expected {count}, as uVertexCount and vVertexCount say"
        )
    fitting = [sample for sample in samples.values if len(sample[1]) == count]
    if len(fitting) < len(samples.values):
        message = f"their number changes within the shutter; took the samples of {count}, as at the frame"
        context.diagnostics.warning(path, "points", message)
    return Samples(fitting, samples.held)


def _warn_of_rates(name: str, rates: RawSamples, count: int, path: str, context: FrameContext) -> None:
    found = next((len(each) for _, each in rates if len(each) != count), None)
    if found is not None:
        message = f"not used: found {found} values, expected {count}, as many as points"
        context.diagnostics.warning(path, name, message)


def _warn_of_trim_curves(prim: Usd.Prim, context: FrameContext) -> None:
    counts = prim.GetAttribute("trimCurve:counts")
    if counts.HasAuthoredValue() and len(value(counts, context.code, INTS) or ()):
        message = "trim curves are not supported yet; drawn untrimmed"
        context.diagnostics.group(prim.GetPath().pathString, "trimCurve:counts", message)


def _add_weights(shape: NurbsShape, prim: Usd.Prim, carried: bool) -> None:
    """Sets the weights. Where they change within the shutter, so are the control points: at the same, dense times."""
    attribute, context = prim.GetAttribute("pointWeights"), shape.context
    at_frame = _weights(shape, attribute, context.code)
    if at_frame is None:
        return
    shape.weights = at_frame
    if not context.shutter.moving or not might_vary(attribute):
        return
    times = sample_times([attribute, prim.GetAttribute("points")], context.shutter)
    codes = [Usd.TimeCode(time) for time in (times if context.held else _dense(times))]
    found = [_weights(shape, attribute, code) for code in codes]
    weights = [each for each in found if each is not None]
    if all(np.array_equal(each, at_frame) for each in weights):
        return
    if carried or len(weights) < len(codes):
        message = "they change within the shutter, where velocities carry the points" if carried else "they come and go"
        context.diagnostics.warning(shape.path, "pointWeights", f"{message}; held the frame's")
        return
    points = prim.GetAttribute("points")
    poses = [array(required(points, code, FLOAT3S), np.float32, 3) for code in codes]
    if any(len(pose) != shape.patch.control_count for pose in poses):
        return
    times01 = [context.shutter.time01(code.GetValue()) for code in codes]
    shape.controls = Samples(list(zip(times01, poses, strict=True)), context.held)
    shape.moving_weights = weights


def _weights(shape: NurbsShape, attribute: Usd.Attribute, code: Usd.TimeCode) -> np.ndarray | None:
    """None, with a warning, for what cannot be weights."""
    found = array(value(attribute, code, DOUBLES), np.float64)
    if not len(found):
        return None
    sound, said = shape.patch.check_weights(shape.path, found)
    shape.context.diagnostics.take(said)
    return found if sound else None


def _dense(times: list[float]) -> list[float]:
    """With others evenly between two of them."""
    between = [time for a, b in pairwise(times) for time in np.linspace(a, b, _DENSE, endpoint=False).tolist()]
    return [*between, times[-1]] if times else []
