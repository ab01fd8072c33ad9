"""The C++ side of msbvh (delegate/usd/bindings): translator, builder and renderer.

Arrays are C-contiguous, of the very element type, and borrowed for the call only: nothing is copied. An array
that does not fit raises TypeError (element type) or ValueError (shape) naming the argument. Objects are for
one thread at a time.

Times are ``time01``: 0 is the shutter's opening, 1 its closing. Matrices follow USD's row-vector convention
(p' = p M), in stage space. Colours are linear Rec.709.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Literal, Required, TypeAlias, TypedDict, Unpack

import numpy as np
from numpy.typing import NDArray

from ._core_film import MOST_FILTER_WIDTH as MOST_FILTER_WIDTH
from ._core_film import MOST_SHUTTER_SLICES as MOST_SHUTTER_SLICES
from ._core_film import PIXEL_FILTERS as PIXEL_FILTERS
from ._core_film import SHUTTER_CURVES as SHUTTER_CURVES
from ._core_film import FilmSettings as FilmSettings
from ._core_film import name_hash as name_hash
from ._core_frame import ABSURD_SHUTTER_FRAMES as ABSURD_SHUTTER_FRAMES
from ._core_frame import MOST_STRETCHES as MOST_STRETCHES
from ._core_frame import check_optics as check_optics
from ._core_frame import checked_planes as checked_planes
from ._core_frame import checked_scale as checked_scale
from ._core_frame import checked_shutter as checked_shutter
from ._core_frame import common_intervals as common_intervals
from ._core_frame import course_breakpoints01 as course_breakpoints01
from ._core_frame import held_stretches as held_stretches
from ._core_frame import intervals_between as intervals_between
from ._core_frame import knots_within as knots_within
from ._core_frame import lenses_of as lenses_of
from ._core_inputs import InstanceLevel as InstanceLevel
from ._core_inputs import MeshInput as MeshInput
from ._core_look import ASPECT_POLICIES as ASPECT_POLICIES
from ._core_look import LIGHT_NUMBERS as LIGHT_NUMBERS
from ._core_look import IesProfile as IesProfile
from ._core_look import LightLook as LightLook
from ._core_look import LightPicture as LightPicture
from ._core_look import LightSamples as LightSamples
from ._core_look import Optics as Optics
from ._core_look import SampledLight as SampledLight
from ._core_look import converted_colors as converted_colors
from ._core_look import exposure_scale as exposure_scale
from ._core_look import ies_profile as ies_profile
from ._core_look import image_height as image_height
from ._core_look import is_similarity as is_similarity
from ._core_look import light_emission as light_emission
from ._core_look import light_normalization as light_normalization
from ._core_look import light_picture as light_picture
from ._core_look import light_times01 as light_times01
from ._core_look import placed_light as placed_light
from ._core_look import switch_times01 as switch_times01
from ._core_materials import Asset as Asset
from ._core_materials import Displacement as Displacement
from ._core_materials import Origin as Origin
from ._core_materials import ShaderConnection as ShaderConnection
from ._core_materials import ShaderData as ShaderData
from ._core_materials import ShaderInput as ShaderInput
from ._core_materials import ShaderNetwork as ShaderNetwork
from ._core_materials import ShaderNode as ShaderNode
from ._core_materials import ShaderValue as ShaderValue
from ._core_materials import SurfaceLook as SurfaceLook
from ._core_materials import displacement as displacement
from ._core_materials import evaluated_inputs as evaluated_inputs
from ._core_materials import preview_surface as preview_surface
from ._core_materials import surface_rank as surface_rank
from ._core_render_spec import MOST_SAMPLES_OF_NOISE as MOST_SAMPLES_OF_NOISE
from ._core_render_spec import NamedSetting as NamedSetting
from ._core_render_spec import OwnSettings as OwnSettings
from ._core_render_spec import ProductSpec as ProductSpec
from ._core_render_spec import RenderBaseInput as RenderBaseInput
from ._core_render_spec import RenderProductInput as RenderProductInput
from ._core_render_spec import RenderSettingsInput as RenderSettingsInput
from ._core_render_spec import RenderSpec as RenderSpec
from ._core_render_spec import RenderVarInput as RenderVarInput
from ._core_render_spec import RenderVarSpec as RenderVarSpec
from ._core_render_spec import conformed_picture as conformed_picture
from ._core_render_spec import pixels_of as pixels_of
from ._core_render_spec import render_spec as render_spec
from ._core_render_spec import window_part as window_part
from ._core_sample import BEFORE_JUMP01 as BEFORE_JUMP01
from ._core_sample import FINEST_LEVEL as FINEST_LEVEL
from ._core_sample import LARGEST_ELEMENT as LARGEST_ELEMENT
from ._core_sample import MOST_REPEATS as MOST_REPEATS
from ._core_sample import MOST_TURNS_FOLLOWED as MOST_TURNS_FOLLOWED
from ._core_sample import Density as Density
from ._core_sample import MotionSamples as MotionSamples
from ._core_sample import PixelSize as PixelSize
from ._core_sample import PoseSampler as PoseSampler
from ._core_sample import PoseSamples as PoseSamples
from ._core_sample import SubShape as SubShape
from ._core_sample import TransformSamples as TransformSamples
from ._core_sample import Turns as Turns
from ._core_sample import ValueTime as ValueTime
from ._core_sample import angle_turns as angle_turns
from ._core_sample import dense_times01 as dense_times01
from ._core_sample import even_times01 as even_times01
from ._core_sample import joint_turns as joint_turns
from ._core_sample import orientation_turns as orientation_turns
from ._core_sample import sample_motion as sample_motion
from ._core_sample import uniform_turns as uniform_turns
from ._core_sample import usable_periods01 as usable_periods01
from ._core_sample import value_times as value_times
from ._core_shape import EDGE_LENGTHS as EDGE_LENGTHS
from ._core_shape import MOST_PLACES as MOST_PLACES
from ._core_shape import SHARED_FROM as SHARED_FROM
from ._core_shape import SIDE_COUNTS as SIDE_COUNTS
from ._core_shape import SIDES as SIDES
from ._core_shape import SILHOUETTES as SILHOUETTES
from ._core_shape import ImplicitShape as ImplicitShape
from ._core_shape import NurbsGrid as NurbsGrid
from ._core_shape import NurbsPatch as NurbsPatch
from ._core_shape import Surface as Surface
from ._core_shape import UnitForm as UnitForm
from ._core_shape import binds_faces as binds_faces
from ._core_shape import can_be_instances as can_be_instances
from ._core_shape import face_materials as face_materials
from ._core_shape import face_owners as face_owners
from ._core_shape import implicit_surface as implicit_surface
from ._core_shape import implicit_types as implicit_types
from ._core_shape import radii_in_pixels as radii_in_pixels
from ._core_shape import shapes_from_units as shapes_from_units
from ._core_shape import sides_for as sides_for
from ._core_shape import stray_of as stray_of
from ._core_shape import unit_form as unit_form
from ._core_statistics import AccelStatistics as AccelStatistics
from ._core_statistics import FoundEffect as FoundEffect
from ._core_statistics import FoundEffects as FoundEffects
from ._core_statistics import PrimCosts as PrimCosts
from ._core_statistics import ProbeReport as ProbeReport
from ._core_statistics import ProbeRow as ProbeRow
from ._core_statistics import RayCosts as RayCosts
from ._core_statistics import RayMeans as RayMeans
from ._core_statistics import RenderStatistics as RenderStatistics
from ._core_statistics import SceneStatistics as SceneStatistics
from ._core_statistics import StageSamples as StageSamples

__version__: str

F32: TypeAlias = NDArray[np.float32]
F64: TypeAlias = NDArray[np.float64]
I32: TypeAlias = NDArray[np.int32]
Rgb: TypeAlias = tuple[float, float, float]

class Error(Exception):
    """The scene or a setting is wrong; one line: the prim, the attribute, what was found and is expected."""

class Diagnostic:
    """What a translation has to say about its input. ``note``: nothing is lost; ``warning``: rendered, but something
    was left out or approximated; ``error``: the prim is not rendered."""

    @property
    def severity(self) -> Literal["note", "warning", "error"]: ...
    @property
    def path(self) -> str: ...
    @property
    def attribute(self) -> str: ...
    @property
    def message(self) -> str: ...
    @property
    def in_common(self) -> bool:
        """Many prims may have it in common: it is told once for all of them."""

class TrackReport:
    """How the motion of the camera, a mesh or a set of instances was kept."""

    @property
    def path(self) -> str: ...
    @property
    def source(self) -> str:
        """camera, points, velocities, accelerations, transform or instances."""
    @property
    def rule(self) -> str:
        """Which of USD's rules decided, in words."""
    @property
    def segments(self) -> int:
        """0 for a still track, else a power of two."""
    @property
    def degree(self) -> int:
        """Of the Bezier curves on the segments: 1 linear, 2, 3."""
    @property
    def time_remap(self) -> bool:
        """Keys lie at the breakpoints of the motion, not at even times."""
    @property
    def hidden_partly(self) -> bool:
        """Visible for a part of the shutter."""
    @property
    def moving_transform(self) -> bool:
        """A still shape under a moving transform, not one that is baked."""
    @property
    def error_pixels(self) -> float:
        """The largest deviation found from the stage's motion; of instances, of those in the picture, if there are any and
        none misses its tolerance."""
    @property
    def tolerance_pixels(self) -> float:
        """That error_pixels is held to: the motion tolerance or, outside of the picture, ``outside_tolerance`` times it."""
    @property
    def error_outside(self) -> bool:
        """error_pixels is of what moves outside of the picture."""
    @property
    def outside(self) -> int:
        """Of ``count``: that move, wholly outside of the picture throughout the shutter."""
    @property
    def coarser(self) -> int:
        """Of those: that took fewer keys than the motion tolerance asks for; after Translator.finish(): and that a ray can
        reach."""
    @property
    def keys_saved(self) -> int:
        """By all of these together."""
    @property
    def shape_error_pixels(self) -> float | None:
        """How far what is drawn strays from the prim's true surface in the picture, at most, in pixels
        (delegate/translate/stray/stray.h); None where it was not measured: delegate/translate/translator.h says of
        what."""
    @property
    def bytes(self) -> int:
        """Of the track's control points."""
    @property
    def count(self) -> int:
        """Of instances, once for each place that outer levels put a prim at; 0 of a prototype's mesh."""

class Scene:
    """A finished frame, for Renderer."""

    def statistics(self) -> SceneStatistics: ...
    @property
    def mesh_names(self) -> list[str]:
        """Of the prims that primId counts, in its order."""
    @property
    def materials(self) -> list[dict[str, Any]]:
        """By number: every constant by its name, ``texture_reads``, and ``driven``, by input."""
    @property
    def textures(self) -> list[dict[str, Any]]:
        """That ``texture`` of a material's texture_reads counts."""
    @property
    def primvars(self) -> list[tuple[str, dict[str, tuple[str, int, F32]]]]:
        """Of each mesh, grids, curves and points: its prim's path, and by the names that materials read: interpolation
        (constant, triangle, vertex, faceVarying), segments, float32[keys * values, 3]."""
    @property
    def instance_primvars(self) -> list[tuple[str, dict[str, Any]]]:
        """Of each set of instances, likewise: one value an instance, displayOpacity among them."""
    def camera(self, time01: float) -> tuple[list[list[float]], tuple[float, float, float, float], tuple[float, float]]:
        """The camera at a time, from its tracks: world_from_camera [4, 4] in stage space, the window, and the lens's
        radius and focus distance."""
    def poses(self, time01: float) -> list[tuple[str, str, F64]]:
        """What is visible at a time: (path of the mesh, path of what instances it or again the mesh's,
        float64[M, N, 3] stage-space vertices of M instances), from the tracks as they are traced."""

class RefinementCache:
    """Refined subdivision cages, kept from frame to frame: core/geometry/subdivision/refinement_cache.h."""

    def __init__(self, most_bytes: int = 268435456) -> None: ...
    @property
    def bytes(self) -> int: ...
    @property
    def counts(self) -> dict[str, int]:
        """cages_made, cages_kept, meshes_made, meshes_kept: of all frames so far."""

class LeftOut(TypedDict):
    """A prim that is drawn, but that no ray can reach: delegate/translate/unreached.h."""

    path: str
    why: Literal["hidden", "outside the picture"]
    count: int
    """Of instances; else 1."""

class Translator:
    """From what was read of a stage to a Scene: checks, triangulates, and fits the fewest keys that follow
    the samples within ``motion_tolerance`` pixels. See delegate/translate/translator.h."""

    def __init__(
        self,
        *,
        path: str,
        projection: Literal["perspective", "orthographic"],
        times01: F64,
        world_from_camera: F64,
        windows: F32,
        breakpoints01: F64 | None = None,
        periods01: F64 | None = None,
        lenses: F32 | None = None,
        near_clip: float,
        far_clip: float,
        clips: F32 | None = None,
        clipping_planes: F32 | None = None,
        width: int,
        height: int,
        motion_tolerance: float = 0.1,
        outside_tolerance: float = 8.0,
        max_segments: int = 128,
        interpolation: Literal["auto", "linear", "quadratic", "cubic"] = "auto",
        segments: int = 0,
        keep_faces: bool = False,
        measure_shape: bool = False,
        edge_length: float = 1.0,
        displacement: Literal["auto", "patches", "tessellate", "none"] = "auto",
        displaced_triangle_bytes: int = 2**28,
        curves: Literal["ribbon", "tube"] = "ribbon",
        max_bounces: int | None = None,
        refinements: RefinementCache | None = None,
    ) -> None:
        """The camera at ``times01`` [T]: ``world_from_camera`` [T, 4, 4], ``windows`` [T, 4] (left, right,
        bottom, top; at unit distance for a perspective camera, in scene units for an orthographic one),
        ``breakpoints01``: where its motion may change its course; None: at every time. ``periods01``: shares of the
        shutter after which it may repeat.
        ``lenses`` [T, 2] (radius and focus distance of a thin lens, in camera space; None: a pinhole).
        ``clipping_planes`` [P, 4]: of checked_planes().
        ``outside_tolerance``: how many times as far may stray what moves wholly outside of the picture; at least 1.
        ``keep_faces``: for the AOV elementId. ``measure_shape``: whether TrackReport.shape_error_pixels is.
        ``edge_length``: about how long edges of a subdivided surface are in pixels;
        0: cages are drawn as polygons. ``displacement``: what surfaces become whose
        materials displace them; auto: triangles, as long as their trees take about
        ``displaced_triangle_bytes``, then patches. ``curves``: flat, across their normals where they have some, or round.
        ``max_bounces``: of the render that the scene is for, whose rays decide what is left out; None: any.
        ``refinements``: of earlier frames, for this one and the next.

        Raises Error for a camera or settings that cannot be used.
        """
    def add_mesh(self, mesh: MeshInput) -> None:
        """Into the world. Bad data leaves a Diagnostic and raises nothing."""
    def begin_prototype(self, path: str, pixels_per_unit: float = 0.0) -> int:
        """``pixels_per_unit``: of the instance that is seen largest; 0: not known."""
    def pixels_per_unit(self, *, levels: Sequence[InstanceLevel], box: F64) -> float:
        """Pixels that a unit of the space inside the levels covers at most; ``box`` [2, 3] encloses what is
        there."""
    def add_prototype_mesh(self, prototype: int, mesh: MeshInput) -> None: ...
    def add_instances(
        self,
        *,
        path: str,
        prototype: int,
        levels: Sequence[InstanceLevel],
        visible: F64 | None = None,
        display_color: F32 | None = None,
        display_opacity: F32 | None = None,
        primvars: dict[str, tuple[str, F32, None]] | None = None,
        materials: I32 | None = None,
        paths: Sequence[str] = (),
        report_whole: bool = False,
        ids: I32 | None = None,
    ) -> None:
        """As many instances as the product of the levels' counts, the outermost (last) level varying slowest;
        ``display_color`` [N, 3], ``display_opacity`` [N], ``primvars`` (their values [N, 3]) and ``materials`` [N]
        (negative: none) override the prototype's own. ``paths``: of
        the prims that the innermost level places, for a track report each; ``report_whole``: and one of all.
        ``ids`` [N]: their numbers in the AOV instanceId; None: counted. After the prototype's meshes."""
    def add_material(self, look: SurfaceLook, displacement: Displacement | None = None) -> int:
        """Before the meshes that are bound to it. Returns its number."""
    def add_light(
        self,
        *,
        name: str,
        kind: Literal["distant", "dome", "sphere", "rect", "disk", "cylinder", "mesh", "camera"],
        radiance: Rgb,
        angle_degrees: float,
        radius: float,
        width: float,
        height: float,
        times01: F64,
        world_from_light: F64,
        values_times01: F64 | None = None,
        radiances: F32 | None = None,
        numbers: F32 | None = None,
        length: float = 1.0,
        focus: float = 0.0,
        cone_angle_degrees: float = 180.0,
        cone_softness: float = 0.0,
        diffuse: float = 1.0,
        specular: float = 1.0,
        look: LightLook | None = None,
        surface: str = ...,
        material_sync: Literal["materialGlowTintsLight", "independent", "noMaterialResponse"] = ...,
        normalize: bool = ...,
        portals: Sequence[tuple[float, float, F64, F64]] | None = None,
    ) -> None:
        """``world_from_light`` [T, 4, 4] at times01 [T]. Where a light's values change inside the shutter,
        ``radiances`` [V, 3] and ``numbers`` [V, 10] (LIGHT_NUMBERS) at ``values_times01`` [V] are taken
        instead of the still ones. Two samples within 2e-6 make a jump. A mesh light shines from the mesh of the path
        ``surface`` wherever it stands, its radiance divided by the area there if ``normalize``; the three are of
        mesh lights alone. ``portals`` of a dome: width, height, times01 [T] and world_from_portal [T, 4, 4] of each."""
    def keep_primvar(self, name: str) -> None:
        """Of every prim that brings it along, whatever its materials read. Before the meshes."""
    def set_light_groups(self, groups: Mapping[str, Sequence[int]]) -> None:
        """Of prims by their paths, or instances by what places them, one or one an instance: see LightLook.set_links.
        Of all others 0."""
    @property
    def empty(self) -> bool:
        """Whether there is nothing that could be seen."""
    @property
    def empty_meshes(self) -> int:
        """Meshes without a face to draw, which are no error."""
    def diagnostics(self) -> list[Diagnostic]: ...
    def tracks(self) -> list[TrackReport]:
        """The camera's first."""
    def left_out(self) -> list[LeftOut]:
        """Prims that no ray can reach, after finish()."""
    def finish(self) -> Scene:
        """The translator is empty afterwards."""

class RenderSettings(TypedDict, total=False):
    """What Renderer takes beside the scene; see core/api/renderer.h and core/build/settings.h."""

    width: Required[int]
    height: Required[int]
    spp: int
    seed: int
    max_bounces: int
    threads: int
    """0: all."""
    show_domes: bool
    builder: Literal["msbvh", "mbvh", "swept", "timesplit"]
    layout: Literal["full", "compact"]
    refit: Literal["auto", "always", "never"]
    keep_topology: bool
    """So that the next commit() can refit."""
    aovs: Sequence[str]
    """Of aov_names(); what render_with_aovs() returns beside colour."""
    sampler: Literal["sobol", "independent"]
    split_budget: float
    """References that spatial splits may add, as a share of the triangles."""
    sample_stages: bool
    """Whether statistics say what threads were found at: ``stages``."""
    film: FilmSettings
    texture_memory_mb: float
    """Of texels that are kept, at most."""
    noise: float
    """Relative error that a pixel may keep, core/film/noise_goal.h; spp is then the most. 0: off."""
    min_spp: int
    clamp_indirect: float
    """Most indirect light of a path; 0: off."""
    texture_rate: float
    """Times the widths that textures are filtered over."""
    refraction: bool
    """Whether what is transparent bends light."""
    rendering_space: str
    """That textures are converted to: OpenColorIO's name."""

def aov_names() -> tuple[str, ...]:
    """Of what a pixel can tell beside its colour: core/film/aov.h says what each means."""

def aov_merges() -> dict[str, Literal["nearest", "mean", "total", "error", "coverage"]]:
    """How pictures of some of a pixel's samples make one of all: core/film/aov.h."""

def aov_channels(aov: str, layer: str) -> list[str]:
    """The channels of an AOV as a layer of that name: "normal.X", ...; the layer's own name where there is one alone.

    Raises ValueError for an unknown AOV.
    """

def effects(scene: Scene, *, max_bounces: int = ..., aovs: str = "", refraction: bool = False) -> FoundEffects:
    """All that a scene calls for, without building trees, and without the GIL. ``aovs``: their names, as text.

    Raises Error for a scene that is wrong.
    """

class Renderer:
    def __init__(self, scene: Scene, **settings: Unpack[RenderSettings]) -> None:
        """Validates, plans and builds, without the GIL; a signal's exception stops it.

        Raises Error for a scene or settings that are wrong.
        """
    def commit(self, scene: Scene, **settings: Unpack[RenderSettings]) -> None:
        """The next frame, whose trees come from the last one's as ``refit`` says; else as the constructor.

        Not while render() runs on another thread. Where it raises, the last frame stays.
        """
    def render(self, progress: Callable[[float], object] | None = None) -> F32:
        """[height, width, 4]: top row first, linear, premultiplied; alpha is coverage.

        Without the GIL. ``progress`` is called with the finished share about ten times a second on the
        calling thread; its exception, or a signal's, stops within a tile and is raised here.
        """
    def render_with_aovs(self, progress: Callable[[float], object] | None = None) -> tuple[F32, dict[str, F32 | I32]]:
        """render(), and each AOV by its name: int32[height, width] of ids, else float32[height, width, channels]."""
    def render_sliced(
        self, progress: Callable[[float], object] | None = None, time_limit: float | None = None
    ) -> tuple[F32, dict[str, F32 | I32], F32]:
        """render_with_aovs(), and [slice, height, width, 4]: the light of each part of the shutter; they sum up to the
        pixels. ``time_limit``: seconds after which no more samples are taken; ``statistics["spp"]`` says how many were."""
    def crypto_manifest(self, aov: str, hashes: NDArray[np.uint32]) -> list[tuple[str, int]]:
        """The names behind hashes [N] of a Cryptomatte, the bits of its ids. Raises Error where none is asked for."""
    def render_samples(
        self, first: int, count: int, progress: Callable[[float], object] | None = None
    ) -> tuple[F32, dict[str, F32 | I32]]:
        """render_with_aovs() of some of each pixel's samples, also beyond ``spp``. Two ranges side by side, weighted by
        their counts, have the mean of all at once."""
    def verify(self) -> None:
        """Proves the invariants of every tree that was built; raises Error naming the node that breaks one.

        Without the GIL. For tests: takes seconds on large scenes.
        """
    def probe(self, *, rays: int, seed: int, progress: Callable[[float], object] | None = None) -> ProbeReport:
        """Traces rays that are likely to find a defect, by every instruction set of this machine: `rays` of each probe.

        Without the GIL; ``progress`` as of render().
        """
    def ray_costs(self, *, camera_samples: int = 20000, progress: Callable[[float], object] | None = None) -> RayCosts:
        """Traces a sample of the frame's own paths again, evenly over the image, and counts what its rays test and whose it
        is: about ``camera_samples`` of the frame's width * height * spp. core/cost/ray_costs.h says what shares leave out.

        The same on any number of threads, but for build_share. Without the GIL; ``progress`` as of render().
        """
    @property
    def texture_faults(self) -> list[tuple[str, str, str]]:
        """(texture as authored, file, reason) of those that could not be read until now; their fallbacks were drawn."""
    @property
    def plan(self) -> list[tuple[str, str, str]]:
        """(effect, prim, why)."""
    @property
    def statistics(self) -> RenderStatistics: ...

def skin_points(
    *,
    path: str,
    times01: F64,
    points: F32,
    normals: F32 | None = None,
    normal_points: I32 | None = None,
    method: Literal["classicLinear", "dualQuaternion"],
    joint_indices: I32 | None = None,
    joint_weights: F32 | None = None,
    influences_per_point: int,
    constant_influences: bool,
    geom_bind: F64,
    joints: F64 | None = None,
    sub_shapes: Sequence[SubShape],
    sub_shape_weights: F32 | None = None,
) -> tuple[F32 | None, F32 | None, list[Diagnostic]]:
    """Blend shapes, then joints, at ``times01`` [T]: points [T, N, 3] and normals [T, M, 3].

    ``points`` [N, 3] and ``normals`` [M, 3] are in the mesh's space at rest; ``normal_points`` [M] says which point each
    normal belongs to (None: one normal a point). ``joint_indices`` and ``joint_weights`` are [N * influences_per_point],
    or [influences_per_point] for ``constant_influences``; ``geom_bind`` is [4, 4] and ``joints``, the skinning transforms
    in the order that the indices count in, [T, J, 4, 4]. Results are in the skeleton's space; in the mesh's where there
    are no ``joint_indices``. ``sub_shape_weights`` is [T, len(sub_shapes)].

    Points are None where the input cannot be used (an error among the diagnostics); normals also where there
    are none. See delegate/translate/skinning.h. Releases the GIL.
    """

def supported_instruction_sets() -> list[str]:
    """Those that the kernels are compiled for and this machine has; worst first."""

def can_read_textures() -> bool:
    """Whether this was built with OpenImageIO."""

def builders() -> list[str]:
    """Names that Renderer and the benchmark take; the default first."""

class BenchClass(TypedDict):
    name: str
    what: str
    triangles: int
    quick_triangles: int
    forms: list[tuple[int, int]]
    """(segments, degree) of the tracks that are measured."""
    quick_forms: list[tuple[int, int]]

def bench_classes() -> list[BenchClass]:
    """The benchmark's procedural scenes (bench/scene_classes.h)."""

def bench_scene(
    name: str, *, triangles: int, segments: int, degree: int, seed: int
) -> tuple[Scene, tuple[float, float, float, float]]:
    """A scene, and a ball in it (center, radius) from which every ray hits something; radius 0: none."""

def bench_run(
    scene: Scene,
    interior: tuple[float, float, float, float],
    *,
    name: str,
    builders: Sequence[str],
    threads: Sequence[int],
    rays: int,
    repetitions: int,
    build_repetitions: int,
    seed: int,
    oracle_tests: float,
    robust: Sequence[bool],
    peer: str,
    peer_folder: str,
) -> list[str]:
    """Rows as JSON. ``builders`` empty: msbvh and mbvh; ``threads`` 0: all; ``peer``: path of its library, empty for none;
    ``peer_folder``: where the peer finds the ray tracer's libraries; ``robust``: the peer with its flag and without;
    ``oracle_tests``: triangles that the oracle tests a builder and kind of ray.

    Without the GIL; a signal's exception ends it between two measurements.
    """

def bench_peer_name(path: str, folder: str) -> str:
    """The name, version and instruction set that a peer's library states; arguments as in bench_run."""

StabilityCell = tuple[str, str, int, int, float, float]
"""(shape, motion, segments, degree, position, scale)."""

def stability_cells() -> list[StabilityCell]:
    """All that the stability bench knows (bench/stability_scene.h)."""

def stability_shapes() -> dict[str, str]:
    """What each is, in a line."""

def stability_motions() -> dict[str, str]:
    """What each does, in a line."""

def stability_run(
    cell: StabilityCell, *, rays: int, seed: int, oracle_tests: float, peer: str, peer_folder: str
) -> str:
    """A row as JSON (bench/stability.h); ``peer`` and ``peer_folder`` as in bench_run. Raises Error for a cell that
    cannot be. Without the GIL; a signal's exception ends it between two measurements."""

def arm_crash_line(line: str) -> None: ...
def disarm_crash_line() -> None: ...

class PipeReader:
    """Keeps in memory what a library writes to a path. In contrast to a file, a pipe has no limit and is never full;
    its writer cannot seek."""

    def __init__(self) -> None: ...
    @property
    def path(self) -> str:
        """Valid until finish()."""

    def finish(self) -> bytes:
        """All that was written, once whoever wrote is done."""
