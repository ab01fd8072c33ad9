#include "core/build/centre_pose.h"

#include "core/base/parallel.h"

namespace msbvh {
namespace {

constexpr std::size_t kVerticesPerTask = 16384;

std::vector<Vec3f> evaluate(const TriangleMesh& mesh, float centre) {
  std::vector<Vec3f> out(mesh.vertex_count + TriangleMesh::kGuard);
  parallel_for_ranges(mesh.vertex_count, kVerticesPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) out[v] = mesh.position(static_cast<std::uint32_t>(v), centre);
  });
  return out;
}

}  // namespace

CentrePose::CentrePose(const Primitives& primitives)
    : primitives_(primitives), positions_(primitives.meshes.size()), evaluated_(primitives.meshes.size()) {
  for (std::size_t m = 0; m < positions_.size(); ++m) {
    const TriangleMesh& mesh = *primitives.meshes[m];
    if (mesh.segments == 1 || (mesh.segments != 0 && !primitives.slice.whole())) {
      evaluated_[m] = evaluate(mesh, primitives.slice.time(0.5f));
      positions_[m] = evaluated_[m].data();
    } else {
      // Still, or a key at the centre, which every even number of segments has.
      positions_[m] = mesh.control_positions(mesh.segments / 2 * mesh.degree);
    }
  }
}

}  // namespace msbvh
