// Figures of a built tree.
#pragma once

#include <algorithm>
#include <cstdint>

namespace msbvh {

struct BvhStatistics {
  std::uint64_t triangles = 0;
  std::uint64_t instances = 0;
  std::uint64_t patches = 0;  // of grids
  std::uint64_t quads = 0;    // in them
  std::uint64_t spans = 0;    // of curves
  std::uint64_t points = 0;
  // Leaf entries; over triangles + patches + spans + points + instances it is the duplication.
  std::uint64_t references = 0;
  std::uint64_t nodes = 0;  // 8-wide
  std::uint64_t leaves = 0;
  std::uint64_t node_bytes = 0;
  std::uint64_t leaf_bytes = 0;
  std::uint64_t vertex_bytes = 0;    // the vertex tracks that indexed leaves read; they are the meshes' own
  std::uint64_t instance_bytes = 0;  // instances, their maps and their time remaps
  std::uint64_t other_bytes = 0;     // what aligns the arena's parts, the root's boxes, the tree's own record
  std::uint64_t topology_bytes = 0;  // what keep_topology leaves for the next frame, until that takes it over
  std::uint64_t grid_bytes = 0;      // the grids' points, all keys; they are the meshes' own
  std::uint64_t round_bytes = 0;     // vertices of curves and points, all keys; likewise
  std::uint32_t max_segments = 0;
  std::uint32_t depth = 0;
  double sah_cost = 0.0;       // averaged over the shutter, in units of one node test
  double build_seconds = 0.0;  // topology, bounds and flattening
  double topology_seconds = 0.0;
  double bounds_seconds = 0.0;
  double refit_seconds = 0.0;  // of build_seconds, on refits, also on those that were given up
  // How the tree came about: one of these is 1.
  std::uint64_t built = 0;
  std::uint64_t refitted = 0;  // the topology of an earlier frame at this frame's keys
  std::uint64_t kept = 0;      // the last frame's, as it was

  // What a tree holds of the allocator's bytes, to within 10 % from 100 triangles on (tests/memory). Meshes
  // are not the tree's: it only borrows them, and shares them with whoever made them.
  std::uint64_t held_bytes() const {
    return node_bytes + leaf_bytes + instance_bytes + other_bytes + topology_bytes;
  }
  // All that must be in memory for rays to be traced and the next frame to be refitted.
  std::uint64_t total_bytes() const { return held_bytes() + vertex_bytes; }

  // Sums over trees; depth and segments are the largest of any.
  BvhStatistics& operator+=(const BvhStatistics& tree) {
    triangles += tree.triangles;
    instances += tree.instances;
    patches += tree.patches;
    quads += tree.quads;
    references += tree.references;
    nodes += tree.nodes;
    leaves += tree.leaves;
    node_bytes += tree.node_bytes;
    leaf_bytes += tree.leaf_bytes;
    vertex_bytes += tree.vertex_bytes;
    grid_bytes += tree.grid_bytes;
    round_bytes += tree.round_bytes;
    spans += tree.spans;
    points += tree.points;
    instance_bytes += tree.instance_bytes;
    other_bytes += tree.other_bytes;
    topology_bytes += tree.topology_bytes;
    max_segments = std::max(max_segments, tree.max_segments);
    depth = std::max(depth, tree.depth);
    sah_cost += tree.sah_cost;
    build_seconds += tree.build_seconds;
    topology_seconds += tree.topology_seconds;
    bounds_seconds += tree.bounds_seconds;
    refit_seconds += tree.refit_seconds;
    built += tree.built;
    refitted += tree.refitted;
    kept += tree.kept;
    return *this;
  }
};

}  // namespace msbvh
