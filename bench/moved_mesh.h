// Meshes of the benchmark: a pose at the shutter's centre, and a motion for each vertex.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/geometry/triangle_mesh.h"
#include "core/motion/bezier_fit.h"

namespace msbvh::bench {

struct Pose {
  std::vector<Vec3f> positions;
  std::vector<Triangle> triangles;
};

// `motion(vertex, position, u)` is where the vertex is at u in [0, 1], in double. The track passes through it
// at the keys and, for curves, at places between.
template <typename Motion>
TriangleMesh moved_mesh(std::string name, Pose pose, const TrackForm& form, const Motion& motion) {
  TriangleMesh mesh;
  mesh.name = std::move(name);
  mesh.segments = form.segments;
  mesh.degree = form.degree;
  mesh.vertex_count = static_cast<std::uint32_t>(pose.positions.size());
  mesh.triangles = std::move(pose.triangles);
  mesh.positions.assign(mesh.position_count(), {});
  const auto nodes = fit_nodes(form.degree);
  for (std::uint32_t v = 0; v < mesh.vertex_count; ++v) {
    const Vec3d p(pose.positions[v]);
    if (!form.moving()) mesh.positions[v] = Vec3f(motion(v, p, 0.5));
    for (std::uint32_t k = 0; k < form.segments; ++k) {
      Vec3d values[kMaxDegree + 1];
      for (std::uint32_t i = 0; i <= form.degree; ++i)
        values[i] = motion(v, p, (k + nodes[i]) / form.segments);
      controls_from_values([&](std::uint32_t i) -> Vec3d& { return values[i]; }, form.degree);
      for (std::uint32_t i = 0; i <= form.degree; ++i) {
        mesh.positions[std::size_t(k * form.degree + i) * mesh.vertex_count + v] = Vec3f(values[i]);
      }
    }
  }
  return validated(std::move(mesh));
}

}  // namespace msbvh::bench
