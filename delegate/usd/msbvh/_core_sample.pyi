"""The part of _core that says where and how densely motion is sampled (delegate/translate/sample)."""

import enum
from collections.abc import Iterable, Sequence
from typing import Literal, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ._core import Diagnostic

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I32 = NDArray[np.int32]

FINEST_LEVEL: int
"""2^FINEST_LEVEL intervals: the most segments that a track has."""
LARGEST_ELEMENT: float
"""Of a usable matrix."""
MOST_REPEATS: float
"""Motion that repeats at most so often in the shutter is kept as one period."""
MOST_TURNS_FOLLOWED: float
"""Of a camera or a light in the shutter."""
BEFORE_JUMP01: float
"""How long before a jump its last old value is sampled."""

class Density(enum.Enum):
    """What evenly spaced times are for."""

    CAMERA = ...
    LIGHT = ...
    GLANCE = ...

class PixelSize:
    """How large a pixel is in the world, seen from a camera that may move; the smallest size counts."""

    def __init__(self, camera_box: F64, perspective: bool, per_unit: float, near: float) -> None:
        """``camera_box`` is float64[2, 3], lo and hi, around the eye over the shutter; ``per_unit`` are world units a
        pixel, at unit distance (perspective) or anywhere. No distance counts as less than ``near``."""
    @staticmethod
    def uniform(size: float) -> PixelSize:
        """As large everywhere."""
    @property
    def per_unit(self) -> float: ...
    def at_boxes(self, corners: F64) -> F64:
        """float64[N] at things whose boxes have float64[T, N, 8, 3] corners over time."""

class Turns:
    """An upper bound on the whole turns that a motion has made since the shutter opened."""

    def __init__(
        self, times01: Sequence[float] = ..., total: Sequence[float] = ..., periods01: Sequence[float] = ...
    ) -> None:
        """``times01`` increase from 0 to 1; ``total`` starts at 0 and does not decrease. Turns() is none."""
    def __add__(self, other: Turns) -> Turns:
        """Of a product of both motions."""
    @property
    def times01(self) -> list[float]: ...
    @property
    def total(self) -> list[float]: ...
    @property
    def periods01(self) -> list[float]:
        """Shares of the shutter after which the motion may repeat."""
    @property
    def rate(self) -> float:
        """Turns a shutter at the fastest."""
    @property
    def none(self) -> bool: ...
    def at(self, time01: float) -> float:
        """Turns made by then."""
    def within(self, ends01: Sequence[float]) -> list[float]:
        """Between neighbours of increasing times, as if each stretch had the largest rate that occurs in it."""

class MotionSource(Protocol):
    """Things that move together: what sample_motion() asks a front-end for."""

    @property
    def count(self) -> int: ...
    @property
    def still(self) -> bool: ...
    @property
    def breakpoints01(self) -> Sequence[float]: ...
    def turns(self, index: int) -> Turns: ...
    def evaluate(self, times01: list[float], which: NDArray[np.int64]) -> F64:
        """float64[T, M, 4, 4]."""

class TransformSamples:
    """A transform at increasing times, interpolated between them and held outside; one sample: still. Arrays are views."""

    def __init__(
        self,
        times01: F64,
        matrices: F64,
        breakpoints01: Sequence[float] | None = None,
        held: bool = False,
        error_pixels: float = 0.0,
        periods01: Sequence[float] = ...,
    ) -> None:
        """float64[T] and float64[T, 4, 4], which are copied."""
    @property
    def times01(self) -> F64: ...
    @property
    def matrices(self) -> F64: ...
    @property
    def breakpoints01(self) -> list[float] | None:
        """Where the motion may change its course; None: at every sample."""
    @property
    def held(self) -> bool:
        """Each sample holds until the next."""
    @property
    def error_pixels(self) -> float:
        """By which interpolation between the samples may stray from the stage."""
    @property
    def periods01(self) -> list[float]:
        """Shares of the shutter after which the motion may repeat; whether it does is tested."""

class MotionSamples:
    """Some of a motion's things over the shutter. Arrays are views."""

    @property
    def indices(self) -> NDArray[np.int64]:
        """int64[M] among the motion's things."""
    @property
    def times01(self) -> F64:
        """float64[T]."""
    @property
    def matrices(self) -> F64:
        """float64[T, M, 4, 4]."""
    @property
    def breakpoints01(self) -> F64:
        """float64[B]: where the motion may change its course."""
    @property
    def held(self) -> bool: ...
    @property
    def error_pixels(self) -> float:
        """By which interpolation between the samples may stray from the stage."""
    @property
    def periods01(self) -> list[list[float]]:
        """Of each thing, the shares of the shutter after which its motion may repeat; empty where nobody asked."""
    @property
    def usable(self) -> bool:
        """False where a matrix of each thing is not finite or too large: nothing can be drawn there."""
    def of(self, place: int) -> TransformSamples:
        """Of one thing: number ``place`` of the indices."""

def sample_motion(
    motion: MotionSource, boxes: F64, pixel_size: PixelSize, tolerance_pixels: float, held: bool
) -> list[MotionSamples]:
    """Matrices over the shutter, as dense as interpolation between them needs. ``boxes`` is float64[N, 2, 3], of each
    thing in its own space, or float64[1, 2, 3], of all."""

def even_times01(level: int, breakpoints01: Sequence[float], held: bool = False) -> list[float]:
    """2^level even intervals of the shutter and the breakpoints inside."""

def dense_times01(density: Density, turns: float, breakpoints01: Sequence[float], held: bool = False) -> list[float]:
    """As many times as something needs that turns so often in the shutter."""

class ValueTime:
    """When a value is read that may jump."""

    @property
    def time01(self) -> float:
        """Of the sample."""
    @property
    def read_at01(self) -> float:
        """When the stage is read for it."""
    @property
    def authored(self) -> int | None:
        """Which of the authored times this is: there the stage is read at the authored time code itself."""

def value_times(authored01: Sequence[float], switched01: Sequence[float]) -> list[ValueTime]:
    """2^FINEST_LEVEL even intervals of the shutter, the authored times and those of switches, and an instant before each
    of these; increasing from 0 to 1."""

def uniform_turns(turns: float) -> Turns:
    """At a constant rate."""

def angle_turns(
    times01: Sequence[float], degrees: Sequence[Sequence[float]], loop_periods01: Iterable[float] = ...
) -> Turns:
    """Of angles about one axis or several, a row a time, linear between the times."""

def orientation_turns(times01: Sequence[float], orientations: Sequence[Sequence[float]]) -> Turns:
    """Of quaternions, a row (i, j, k, real) a time, along the shorter arc."""

def joint_turns(times01: Sequence[float], rotations: F64, parents: Sequence[int]) -> Turns:
    """The most that a joint of a skeleton turns together with all that it hangs on: [T, J, 4] quaternions (i, j, k, real);
    the parent of each joint, negative for none. None where a rotation is not finite."""

def usable_periods01(periods01: Sequence[float]) -> list[float]:
    """Those that are worth a track of their own."""

SubShape: TypeAlias = tuple[str, F32 | None, F32 | None, I32 | None]
"""(path of the blend shape, offsets [K, 3], normal offsets [K, 3], the points [K] that they move; None: all
points in their order)."""

class PoseSource(Protocol):
    """A mesh and its skeleton: what PoseSampler asks a front-end for."""

    @property
    def still(self) -> bool:
        """Nothing that acts on the mesh changes over the shutter."""
    @property
    def breakpoints01(self) -> Sequence[float]:
        """Authored times of what acts on it."""
    def turns(self) -> Turns:
        """How far a joint turns at most, with all that it hangs on."""
    @property
    def moves_rest(self) -> bool:
        """Whether the rest points change: then it is evaluated at one time after the other."""
    def evaluate(self, times01: list[float]) -> tuple[F64 | None, F32 | None, F32 | None] | None:
        """Joints [T, J, 4, 4] and weights [T, S] as skin_points() takes them, and rest points [N, 3] that change; None
        where the values cannot be used, which the front-end has said."""

class PoseSamples:
    """A skinned mesh at increasing times. Arrays are read-only and keep themselves alive."""

    @property
    def points(self) -> list[tuple[float, F32]]:
        """(time01, [N, 3]) each, in the skeleton's space; one: still."""
    @property
    def normals(self) -> list[tuple[float, F32]]:
        """(time01, [M, 3]) each; empty without rest normals."""
    @property
    def held(self) -> bool:
        """Each holds until the next."""
    @property
    def follows(self) -> bool:
        """False where so many poses as it takes cannot be afforded."""

class PoseSampler:
    """Poses one mesh, at each time once, however often it is sampled."""

    def __init__(
        self,
        *,
        path: str,
        points: F32,
        normals: F32 | None = None,
        normal_points: I32 | None = None,
        method: Literal["classicLinear", "dualQuaternion"],
        joint_indices: I32 | None = None,
        joint_weights: F32 | None = None,
        influences_per_point: int,
        constant_influences: bool,
        geom_bind: F64,
        sub_shapes: Sequence[SubShape],
    ) -> None:
        """As skin_points() takes them. Keeps the arrays."""
    def sample(
        self, poses: PoseSource, placed: MotionSource, pixel_size: PixelSize, tolerance_pixels: float, held: bool
    ) -> tuple[PoseSamples | None, list[Diagnostic]]:
        """As dense as straight lines between the poses need. ``placed``, of which the first thing counts, places the
        skeleton's space. None where the mesh cannot be skinned. See delegate/translate/sample/pose_sampler.h. Skins
        without the GIL."""
