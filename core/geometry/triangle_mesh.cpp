#include "core/geometry/triangle_mesh.h"

#include <cmath>
#include <cstddef>
#include <string>

#include "core/base/error.h"

namespace msbvh {
namespace {

[[noreturn]] void fail(const TriangleMesh& mesh, const std::string& what) {
  throw Error((mesh.name.empty() ? std::string("mesh") : mesh.name) + ": " + what);
}

void check_form(const TriangleMesh& mesh) {
  if (!is_valid_segment_count(mesh.segments)) {
    fail(mesh, "segments: found " + std::to_string(mesh.segments) + "; expected 0 or a power of two up to " +
                   std::to_string(kMaxSegments));
  }
  if (is_valid_form(mesh.form())) return;
  fail(mesh, "degree: found " + std::to_string(mesh.degree) + " on " + std::to_string(mesh.segments) +
                 " segments; expected 1 to " + std::to_string(kMaxDegree) + ", and 1 for a still mesh");
}

void check_size(const TriangleMesh& mesh) {
  if (mesh.positions.size() == mesh.position_count() + TriangleMesh::kGuard) return;
  fail(mesh, "positions: found " + std::to_string(mesh.positions.size()) + "; expected " +
                 std::to_string(mesh.form().controls()) + " controls x " + std::to_string(mesh.vertex_count) +
                 " vertices, and a guard of " + std::to_string(TriangleMesh::kGuard));
}

void check_positions(const TriangleMesh& mesh) {
  for (std::size_t i = 0; i < mesh.position_count(); ++i) {
    const Vec3f& p = mesh.positions[i];
    for (int axis = 0; axis < 3; ++axis) {
      if (std::abs(p[axis]) <= kMaxCoordinate) continue;  // false for NaN too
      fail(mesh, "positions: vertex " + std::to_string(i % mesh.vertex_count) + " at control " +
                     std::to_string(i / mesh.vertex_count) + " has the coordinate " +
                     std::to_string(p[axis]) + "; expected a finite number of at most 2^60 in size");
    }
  }
}

void check_triangles(const TriangleMesh& mesh) {
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (const std::uint32_t v : mesh.triangles[i]) {
      if (v < mesh.vertex_count) continue;
      fail(mesh, "triangles: triangle " + std::to_string(i) + " uses vertex " + std::to_string(v) +
                     "; expected less than " + std::to_string(mesh.vertex_count));
    }
  }
}

}  // namespace

void validate(const TriangleMesh& mesh) {
  check_form(mesh);
  check_size(mesh);
  check_positions(mesh);
  check_triangles(mesh);
}

TriangleMesh validated(TriangleMesh mesh) {
  if (mesh.positions.size() == mesh.position_count()) {
    mesh.positions.resize(mesh.positions.size() + TriangleMesh::kGuard);
  }
  validate(mesh);
  return mesh;
}

}  // namespace msbvh
