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

class StageSamples(TypedDict):
    """How often threads were found at one place of a frame's work: core/integrate/stage_mark.h."""

    stage: str
    tracing: bool
    """Whether rays went through the trees."""
    bounced: bool
    """Whether the paths had left their first surface."""
    samples: int

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
    """Samples of the picture, of all pixels."""
    spp: int
    """With which the same picture is rendered again: fewer than asked for where a time limit was over."""
    trees: int
    stages: list[StageSamples]
    """Of the last render, about a thousand looks a second at each thread; empty without ``sample_stages``."""
    accel: AccelStatistics
    """Sums over all trees; depth and max_segments are the largest of any."""

class RayMeans(TypedDict):
    """Means over rays, as if each went by itself."""

    rays: int
    nodes_per_ray: float
    """8-wide nodes whose boxes were tested."""
    blocks_per_ray: float
    """Leaf blocks of up to 8 primitives, and tiles of displaced patches."""
    tests_per_ray: float
    """Triangles, spans of curves and points in them."""
    instances_per_ray: float
    """Entered."""

class PrimCosts(TypedDict):
    """Of one of Scene.mesh_names, whatever shows it: instances are the mesh's that they show."""

    path: str
    nodes: float
    """Sums over the rays that were traced again. Nodes and instances in fractions: what stands above several meshes is split
    among them."""
    blocks: int
    tests: int
    instances: float
    share: float
    """Of all rays' traversal, by a model that gives nodes, blocks and instances a price each (core/cost/ray_costs.h)."""
    build_share: float
    """Of the seconds that the trees' builds took: of each tree's in proportion to the mesh's leaf entries there. All 0 where
    every tree was kept from the frame before."""
    tree_bytes: float
    """Of the bytes that the trees hold, split likewise."""

class RayCosts(RayMeans):
    """Of camera, bounce and shadow rays together. The prims' shares and empty_share sum up to 1."""

    paths: int
    """Camera samples of the frame that were traced again."""
    cost: float
    """Of all rays together, in tests of a still node, by the model that shares are of."""
    camera: RayMeans
    """Of rays from the camera."""
    prims: list[PrimCosts]
    """In the order of Scene.mesh_names."""
    empty_nodes: float
    empty_share: float
    """Rays that got to no node of one prim alone."""

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
