#include "core/geometry/triangle_mesh.h"

#include <cmath>

#include "core/base/error.h"

namespace msbvh {
namespace {

[[noreturn]] void fail(const TriangleMesh& mesh, const std::string& what) {
  throw Error((mesh.name.empty() ? std::string("mesh") : mesh.name) + ": " + what);
}

void check_positions(const TriangleMesh& mesh, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3f& p = mesh.positions[i];
    for (int axis = 0; axis < 3; ++axis) {
      if (std::abs(p[axis]) <= kMaxCoordinate) continue;  // false for NaN too
      fail(mesh, "positions: vertex " + std::to_string(i % mesh.vertex_count) + " at key " +
                     std::to_string(i / mesh.vertex_count) + " has the coordinate " +
                     std::to_string(p[axis]) + "; expected a finite number of at most 2^60 in size");
    }
  }
}

}  // namespace

TriangleMesh validated(TriangleMesh mesh) {
  if (!is_valid_segment_count(mesh.segments)) {
    fail(mesh,
         "segments: found " + std::to_string(mesh.segments) + "; expected 0 or a power of two up to 128");
  }
  const std::size_t count = std::size_t(key_count(mesh.segments)) * mesh.vertex_count;
  if (mesh.positions.size() != count && mesh.positions.size() != count + TriangleMesh::kGuard) {
    fail(mesh, "positions: found " + std::to_string(mesh.positions.size()) + "; expected " +
                   std::to_string(key_count(mesh.segments)) + " keys x " + std::to_string(mesh.vertex_count) +
                   " vertices");
  }
  if (count > 0) check_positions(mesh, count);
  mesh.positions.resize(count + TriangleMesh::kGuard);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (const std::uint32_t v : mesh.triangles[i]) {
      if (v >= mesh.vertex_count) {
        fail(mesh, "triangles: triangle " + std::to_string(i) + " uses vertex " + std::to_string(v) +
                       "; expected less than " + std::to_string(mesh.vertex_count));
      }
    }
  }
  return mesh;
}

}  // namespace msbvh
