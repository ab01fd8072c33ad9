"""The part of _core that says what implicit shapes and subsets are (delegate/translate/shape)."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ._core import Diagnostic
from ._core_sample import PixelSize

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I32 = NDArray[np.int32]

SIDE_COUNTS: tuple[int, ...]
"""How many sides a shape may have around its axis; half as many from pole to pole."""
SIDES: int
"""Where nobody knows how large a shape is seen."""
SILHOUETTES: dict[str, float]
"""Pixels by which a shape may lie inside of the true one, by usdrecord's --complexity."""
EDGE_LENGTHS: dict[str, float]
"""About how long edges of a subdivided surface are in pixels, by the same; 0: its cage is drawn as polygons."""
SHARED_FROM: int
"""Shapes that are alike; fewer are meshes of their own."""
MOST_PLACES: int
"""Of a group whose shapes are placed one by one, in each of its places."""

def implicit_types() -> list[tuple[str, tuple[str, ...], bool]]:
    """Of each prim type its name, its parameters' attributes, and whether its normals are smooth."""

class Surface:
    """A polygon mesh. Arrays are views."""

    @property
    def counts(self) -> I32:
        """int32[F] vertices a face."""
    @property
    def indices(self) -> I32:
        """int32[I], counter-clockwise seen from outside."""
    @property
    def points(self) -> F64:
        """float64[N, 3]."""

def implicit_surface(kind: str, values: Sequence[float], sides: int) -> Surface:
    """Along z around the origin. ``values``: the parameters; ``sides``: at least 4."""

class ImplicitShape:
    """An implicit prim over the shutter."""

    @staticmethod
    def make(
        path: str, kind: str, axis: str, values: Sequence[Sequence[float]]
    ) -> tuple[ImplicitShape | None, list[Diagnostic]]:
        """``values`` are the parameters at some times. None, with an error, for one that is no finite number of at most
        2^60 in size; an axis other than X, Y and Z counts as Z, with a warning."""
    @property
    def radius(self) -> float:
        """The largest around the axis; 0 where there is none."""
    def box(self, sides: int) -> F64:
        """float64[2, 3]: lo and hi over all times."""
    def surface(self, time: int, sides: int) -> Surface:
        """At time number ``time``."""

Axis = tuple[int, int, F64, tuple[float, float] | None]
"""Of a patch: vertex count, order, knots, and the range that is drawn, None for all."""

class NurbsPatch:
    """A NURBS patch: where its surface is. Weights are float64[N], one a control point; None: it is not rational."""

    @staticmethod
    def make(path: str, u: Axis, v: Axis) -> tuple[NurbsPatch | None, list[Diagnostic]]:
        """None, with an error, for what makes no surface."""
    @property
    def control_count(self) -> int:
        """N: they lie row by row, from one to the next along u."""
    def check_points(self, path: str, time01: float, points: F32) -> tuple[bool, list[Diagnostic]]:
        """Whether float32[N, 3] are finite; an error where not."""
    def check_weights(self, path: str, weights: F64) -> tuple[bool, list[Diagnostic]]:
        """Whether they are weights; a warning where not."""
    def check_primvar(
        self, path: str, attribute: str, interpolation: str, value_count: int, indices: I32 | None
    ) -> tuple[bool, list[Diagnostic]]:
        """Whether so many values and such indices fit; a warning where not."""
    def cells(
        self,
        path: str,
        poses: list[F32],
        weights: F64 | None,
        matrices: F64,
        pixel_size: PixelSize,
        edge_pixels: float,
    ) -> tuple[list[int], list[int], list[Diagnostic]]:
        """Into how many cells each span of u and of v is cut, for edges of about ``edge_pixels`` wherever one of the poses
        (float32[N, 3]) is seen largest under float64[T, 4, 4] matrices."""
    def grid(
        self, u_cells: list[int], v_cells: list[int], poses: list[F32], weights: F64 | None, apart: bool
    ) -> NurbsGrid:
        """``poses``: all that are to be evaluated. ``apart``: primvars may have several values at seams and poles."""

class NurbsGrid:
    """A patch as polygons. Arrays are views."""

    @property
    def counts(self) -> I32:
        """int32[F] vertices a face."""
    @property
    def indices(self) -> I32:
        """int32[I]."""
    @property
    def segments(self) -> I32:
        """int32[F]: the number of the uniform value of each face."""
    def positions(self, values: F32, weights: F64 | None) -> F32:
        """float32[P, 3]: of float32[N, 3] points, velocities or accelerations of the control points."""
    def vertex_values(self, values: F32, weights: F64 | None) -> F32:
        """float32[P] or float32[P, 3]: of one value a control point."""
    def varying_values(self, values: F32) -> F32:
        """The same of one value a crossing of knots."""

def sides_for(radii_pixels: F64, silhouette_pixels: float, side_counts: Sequence[int]) -> I32:
    """int32[N]: the fewest of ``side_counts``, which increase, for which shapes of float64[N] radii stray by
    ``silhouette_pixels`` at most. SIDES for NaN."""

def stray_of(kind: str, sides: int) -> float:
    """How far the faces of a shape of radius 1 lie off the true one, at most. ``sides``: a multiple of 4."""

def radii_in_pixels(kind: str, radius: float, box: F64, matrices: F64, pixel_size: PixelSize) -> F64:
    """float64[N]: the largest of shapes of that radius in that box (float64[2, 3]) under float64[T, N, 4, 4] matrices.
    NaN where there is no radius, or a matrix that is not finite."""

class UnitForm:
    """A shape as a unit shape under a scale."""

    @property
    def parameters(self) -> tuple[float, ...]:
        """Of the unit shape, which stands along z."""

def unit_form(kind: str, values: Sequence[float], axis: str) -> UnitForm | None:
    """None for a shape that stands for itself: flat, a needle, or with a value that is negative, larger than 2^60 or
    no number."""

def shapes_from_units(forms: Sequence[UnitForm]) -> F64:
    """float64[N, 4, 4]: what makes each shape of its unit shape."""

def can_be_instances(matrices: F64, colors: F32 | None, opacity: float | None) -> NDArray[np.bool_]:
    """bool[N]: which shapes can be instances: those whose float64[T, N, 4, 4] matrices from the unit shape are affine,
    finite and never flat, not even between two times, and whose colours (float32[N, 3]) and opacity are usable."""

def binds_faces(element_type: str, family_name: str) -> bool:
    """Whether a GeomSubset's faces may have a material of their own. No ``element_type``: the schema's."""

def face_owners(subsets: Sequence[tuple[str, I32]], face_count: int) -> tuple[I32, list[Diagnostic]]:
    """int32[face_count]: the number of the subset (path and indices) that each face belongs to, -1 for none; and
    warnings. A face of several belongs to the last one."""

def face_materials(owners: I32, of_subsets: Sequence[int | None], own: int | None) -> I32:
    """int32[F]: the material of each face, negative for none; ``own`` is that of faces of no subset."""
