#include "core/build/kept_topology.h"

#include <algorithm>

#include "core/base/parallel.h"

namespace msbvh {
namespace {

constexpr float kCentre = 0.5f;
constexpr std::size_t kVerticesPerTask = 1 << 16;

Topology compacted(const Topology& topology) {
  Topology out;
  out.node_count = topology.node_count;
  out.reference_count = topology.reference_count;
  out.nodes.reset(new BinaryNode[topology.node_count]);
  out.references.reserve(topology.reference_count);
  for (std::uint32_t i = 0; i < topology.node_count; ++i) {
    BinaryNode& node = out.nodes[i] = topology.nodes[i];
    if (!node.is_leaf()) continue;
    const Reference* first = topology.references.data() + node.first;
    node.first = static_cast<std::uint32_t>(out.references.size());
    out.references.insert(out.references.end(), first, first + node.count);
  }
  return out;
}

CentrePose centre_pose(const TriangleMesh& mesh) {
  CentrePose pose(mesh.vertex_count);
  parallel_for_ranges(pose.size(), kVerticesPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      pose[v] = mesh.position(static_cast<std::uint32_t>(v), kCentre);
    }
  });
  return pose;
}

}  // namespace

KeptTopology keep(const Topology& topology, const Primitives& primitives) {
  KeptTopology kept;
  kept.topology = compacted(topology);
  std::vector<bool> cut(primitives.meshes.size());
  for (const Reference& r : kept.topology.references) {
    if (!r.is_instance() && r.is_clipped()) cut[r.mesh()] = true;
  }
  kept.rest.resize(cut.size());
  for (std::size_t m = 0; m < cut.size(); ++m) {
    if (cut[m]) kept.rest[m] = centre_pose(*primitives.meshes[m]);
  }
  for (const InstanceBounds& bounds : primitives.instances) kept.there.push_back(!bounds.controls.empty());
  return kept;
}

}  // namespace msbvh
