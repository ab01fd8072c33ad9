#include "core/build/kept_topology.h"

#include <algorithm>
#include <span>
#include <utility>

#include "core/base/parallel.h"

namespace msbvh {
namespace {

constexpr float kCentre = 0.5f;
constexpr std::size_t kVerticesPerTask = 1 << 16;

// A copy without the slots that threads took and did not use.
class Compaction {
 public:
  explicit Compaction(const Topology& from) : from_(from) {
    out_.nodes = RawArray<BinaryNode>(from.node_count);  // those that were taken, of which some are unused
    out_.references = RawArray<Reference>(from.reference_count);
  }

  Topology run() {
    if (from_.node_count > 0) {
      out_.node_count = 1;
      copy(0, 0);
    }
    out_.reference_count = from_.reference_count;
    return std::move(out_);
  }

 private:
  void copy(std::uint32_t source, std::uint32_t target) {
    BinaryNode node = from_.nodes[source];
    if (node.is_leaf()) {
      const Reference* first = from_.references.data() + node.first;
      std::copy(first, first + node.count, out_.references.data() + references_);
      node.first = references_;
      references_ += node.count;
    } else {
      const std::uint32_t children = out_.node_count;
      out_.node_count += 2;
      copy(node.first, children);
      copy(node.first + 1, children + 1);
      node.first = children;
    }
    out_.nodes[target] = node;
  }

  const Topology& from_;
  Topology out_;
  std::uint32_t references_ = 0;
};

RestPose centre_pose(const TriangleMesh& mesh) {
  RestPose pose(mesh.vertex_count);
  parallel_for_ranges(pose.size(), kVerticesPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      pose[v] = mesh.position(static_cast<std::uint32_t>(v), kCentre);
    }
  });
  return pose;
}

// By mesh, whether anything refers to fragments of it.
struct CutMeshes {
  std::vector<bool> meshes, grids;

  CutMeshes(const Topology& topology, const Primitives& primitives)
      : meshes(primitives.meshes.size()), grids(primitives.grids.size()) {
    for (const Reference& r : std::span(topology.references.data(), topology.references.size())) {
      if (r.is_instance() || !r.is_clipped()) continue;
      if (r.is_grid()) {
        grids[r.grid_mesh()] = true;
      } else {
        meshes[r.mesh()] = true;
      }
    }
  }
};

}  // namespace

std::size_t KeptTopology::bytes() const {
  std::size_t sum = sizeof(KeptTopology) + topology.nodes.size() * sizeof(BinaryNode) +
                    topology.references.size() * sizeof(Reference) + rest.size() * sizeof(RestPose) +
                    parts.size() * sizeof(InstancePart) + there.size() / 8;
  for (const RestPose& pose : rest) sum += pose.size() * sizeof(Vec3f);
  return sum;
}

KeptTopology keep(const Topology& topology, const Primitives& primitives) {
  KeptTopology kept;
  kept.topology = Compaction(topology).run();
  const CutMeshes cut(kept.topology, primitives);
  kept.rest.resize(cut.meshes.size());
  for (std::size_t m = 0; m < cut.meshes.size(); ++m) {
    if (cut.meshes[m]) kept.rest[m] = centre_pose(*primitives.meshes[m]);
  }
  kept.rest_grids.resize(cut.grids.size());
  for (std::size_t m = 0; m < cut.grids.size(); ++m) {
    if (cut.grids[m])
      kept.rest_grids[m] = std::make_shared<const GridMesh>(still_at(*primitives.grids[m], kCentre));
  }
  kept.parts.assign(primitives.parts.begin(), primitives.parts.end());
  for (const InstanceBounds& bounds : primitives.instances) kept.there.push_back(!bounds.controls.empty());
  return kept;
}

}  // namespace msbvh
