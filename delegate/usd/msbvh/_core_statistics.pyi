"""What _core counts: dictionaries by these keys. Names for type checkers; there is no such module at run time."""

from typing import TypedDict

class SceneStatistics(TypedDict):
    meshes: int
    triangles: int
    keys: int
    """Of meshes and instances, still ones counted as one."""
    instances: int
    lights: int

class AccelStatistics(TypedDict):
    triangles: int
    quads: int
    """Of displaced patches, which are in no tree as triangles."""
    instances: int
    references: int
    nodes: int
    leaves: int
    node_bytes: int
    leaf_bytes: int
    vertex_bytes: int
    """The meshes' tracks that leaves read."""
    grid_bytes: int
    """The displaced patches' points."""
    instance_bytes: int
    other_bytes: int
    """Alignment, root boxes, the trees' records."""
    topology_bytes: int
    """What keep_topology leaves for the next frame, until that takes it over."""
    total_bytes: int
    max_segments: int
    depth: int
    sah_cost: float
    build_seconds: float
    topology_seconds: float
    bounds_seconds: float
    refit_seconds: float
    """Of build_seconds, on refits, also on those that were given up."""
    built: int
    refitted: int
    """Trees that have an earlier frame's topology at this frame's keys."""
    kept: int
    """Trees of the last frame, as they were."""

class RenderStatistics(TypedDict):
    build_seconds: float
    trace_seconds: float
    rays: int
    rays_in_packets: int
    """16 that go down a tree together."""
    rays_interleaved: int
    """Many at once, each on its own way."""
    rays_single: int
    """One after another."""
    camera_rays: int
    trees: int
    accel: AccelStatistics
    """Sums over all trees; depth and max_segments are the largest of any."""

class ProbeRow(TypedDict):
    probe: str
    instruction_set: str
    rays: int
    """Traced one by one, interleaved and in packets."""
    judged: int
    """By the oracle."""
    wrong: int
    first: str
    """Of the wrong ones: the ray, and what is wrong; empty for none."""

class ProbeReport(TypedDict):
    meshes: int
    closed_meshes: int
    probes: list[ProbeRow]

class FoundEffect(TypedDict):
    effect: str
    asked_by: list[tuple[str, str]]
    """(prim, why), in the scene's order, each prim once; the prim is empty where a setting asks. Empty: off."""
    geometry_bytes: int

class FoundEffects(TypedDict):
    base_bytes: int
    """Of geometry that no effect brings."""
    effects: list[FoundEffect]
    """Every effect, on or off, in the order of core/plan/effect_plan.h."""
