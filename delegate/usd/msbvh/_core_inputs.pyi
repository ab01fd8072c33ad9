"""The part of _core that a reader fills in and hands to the translator (delegate/translate/inputs.h)."""

from collections.abc import Sequence
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ._core_sample import TransformSamples

F32: TypeAlias = NDArray[np.float32]
F64: TypeAlias = NDArray[np.float64]
I32: TypeAlias = NDArray[np.int32]
Samples: TypeAlias = Sequence[tuple[float | None, F32]]
"""(time01, float32[N, 3]) at increasing times; one of (None, values) for a value that is authored for all times,
not as a time sample."""

class MeshInput:
    """A mesh for Translator.add_mesh(), or curves or points, attribute by attribute. None stands for what is not given;
    without a path, points, a transform and, of a mesh, faces there is none."""

    path: str
    round: Literal["curves", "points"] | None
    """What it is if no mesh. Neither has faces."""
    curve_type: str | None
    curve_basis: str | None
    curve_wrap: str | None
    curve_vertex_counts: I32 | None
    curve_orders: I32 | None
    """This and the next three: of curve_type nurbs. One a curve."""
    curve_knots: F64 | None
    curve_ranges: F64 | None
    """Two a curve."""
    curve_weights: F64 | None
    widths: tuple[str, F32 | list[tuple[float, F32]], I32 | None] | None
    """As display_color: of curves and points."""
    face_vertex_counts: I32
    face_vertex_indices: I32
    indices_name: str | None
    """Of the attribute that has them, for messages; None: faceVertexIndices."""
    hole_indices: I32 | None
    left_handed: bool | None
    subdivision_scheme: str | None
    """None: none, polygons. The other tokens are UsdGeomMesh's, too."""
    interpolate_boundary: str | None
    face_varying_linear: str | None
    triangle_rule: str | None
    crease_lengths: I32 | None
    crease_indices: I32 | None
    crease_sharpnesses: F32 | None
    """One a crease, or one an edge."""
    corner_indices: I32 | None
    corner_sharpnesses: F32 | None
    points: Samples
    points_held: bool
    """Samples (of normals and rates too) hold until the next instead of being interpolated."""
    velocities: Samples | None
    accelerations: Samples | None
    frame01: float
    """Where the frame lies in the shutter: velocities carry points from the sample at or before it."""
    seconds_per_shutter: float
    velocity_scale: float
    topology_varies: bool
    """Faces change within the shutter."""
    computed_points: bool
    """Points are not authored as they stand."""
    stray: float | None
    """How far the faces lie off the surface that they stand for, at most, in the mesh's own space; None: they are that
    surface; NaN: not known."""
    visible: F64 | None
    """[K, 2]: intervals of the shutter; None: always."""
    transform: TransformSamples
    """Stage from object space; prototype from object space for a prototype's mesh."""
    normals: Samples | None
    normals_interpolation: str
    normals_indices: I32 | None
    computed_normals: Literal["faceted", "smooth"]
    """What to take where no normals are authored."""
    display_color: tuple[str, F32 | list[tuple[float, F32]], I32 | None] | None
    """(interpolation, float32[K, 3], indices); a list of (time01, float32[K, 3]) where it changes inside the
    shutter. Two samples within 2e-6 make a jump."""
    display_opacity: tuple[str, F32 | list[tuple[float, F32]], I32 | None] | None
    """(interpolation, float32[K] or such samples, indices)."""
    named_primvars: dict[str, tuple[str, F32 | list[tuple[float, F32]], I32 | None]] | None
    """That displacement reads, as display_color: numbers of one to three parts, the rest 0."""
    displaced: bool | None
    """False: its materials do not displace it."""
    material: int | None
    """From Translator.add_material."""
    face_materials: I32 | None
    """[F] in place of ``material``; negative: none."""

    def copy(self) -> MeshInput:
        """Of the attributes, not of their arrays."""

class InstanceLevel:
    """A level of instancing, attribute by attribute: either ``times01`` [T] and ``matrices`` [T, N, 4, 4], the outer from
    the inner space, or the arrays of a UsdGeomPointInstancer and which of its instances count. None stands for what is not
    given."""

    held: bool | None
    times01: F64
    matrices: F64
    breakpoints01: F64 | None
    periods01: F64 | None
    selected: I32
    path: str
    count: int
    """Of all its instances."""
    positions: Samples
    scales: Samples | None
    orientations: Sequence[tuple[float | None, F32]] | None
    """float32[N, 4]: i, j, k, real."""
    orientations_name: str
    """Of the attribute, for messages."""
    velocities: Samples | None
    accelerations: Samples | None
    angular_velocities: Samples | None
    frame01: float
    seconds_per_shutter: float
    velocity_scale: float

    def copy(self) -> InstanceLevel:
        """Of the attributes, not of their arrays."""
