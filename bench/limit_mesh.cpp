#include "bench/limit_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "core/geometry/subdivision/refined_mesh.h"

namespace msbvh::bench {
namespace {

constexpr std::uint32_t kAround = 24, kAcross = 10;
constexpr std::uint64_t kMostPoints = std::uint64_t(1) << 25;

Pose torus(procedural::Random& random) {
  Pose pose;
  for (std::uint32_t i = 0; i < kAround; ++i) {
    for (std::uint32_t j = 0; j < kAcross; ++j) {
      const double a = 2.0 * std::numbers::pi * i / kAround, b = 2.0 * std::numbers::pi * j / kAcross;
      const double tube = 0.35 * random.uniform(0.6f, 1.4f), ring = 0.8 + tube * std::cos(b);
      pose.positions.push_back(Vec3f(Vec3d{ring * std::cos(a), tube * std::sin(b), ring * std::sin(a)}));
    }
  }
  return pose;
}

// Edges of the cage differ by up to a few times; twice its area is about that of the limit's triangles'
// quads.
double area(const SubdivisionMesh& cage) {
  double sum = 0.0;
  for (std::size_t i = 0; i < cage.face_vertex_indices.size(); i += 4) {
    const auto at = [&](std::size_t k) { return Vec3d(cage.positions[cage.face_vertex_indices[i + k]]); };
    sum += 0.5 * length(cross(at(2) - at(0), at(3) - at(1)));
  }
  return sum;
}

double curve_length(const std::array<Vec3d, 3>& curve) {
  return length(curve[1] - curve[0]) + length(curve[2] - curve[1]);
}

std::uint32_t level_of(double length, double unit) {
  const double level = std::round(std::log2(length / unit));
  return level > 0.0 ? std::min(kMaxEdgeLevel, static_cast<std::uint32_t>(level)) : 0;
}

EdgeLevels levels_of(RefinableCage& cage, const Vec3f* pose, double unit, EdgeRates rates) {
  const EdgeLevel by_length = [&](const CageEdge& edge) {
    return level_of(curve_length(edge.curves[0]), unit);
  };
  const std::array<const Vec3f*, 1> poses{pose};
  EdgeLevels levels = cage.edge_levels(poses, by_length, kMostPoints);
  if (rates == EdgeRates::kFinest) std::ranges::fill(levels.of_edges, levels.finest());
  return levels;
}

}  // namespace

SubdivisionMesh torus_cage(const TrackForm& form, procedural::Random& random) {
  const auto twist = [](std::uint32_t, const Vec3d& p, double u) {
    const double angle = 0.8 * (p.y + 0.5) * (u - 0.5), c = std::cos(angle), s = std::sin(angle);
    return Vec3d{c * p.x + s * p.z + 0.05 * (u - 0.5), p.y, c * p.z - s * p.x};
  };
  TriangleMesh moved = moved_mesh("cage", torus(random), form, twist);
  SubdivisionMesh cage;
  cage.name = "cage";
  cage.segments = form.segments;
  cage.degree = form.degree;
  cage.vertex_count = moved.vertex_count;
  cage.positions.assign(moved.positions.begin(),
                        moved.positions.begin() + std::ptrdiff_t(moved.position_count()));
  for (std::uint32_t i = 0; i < kAround; ++i) {
    for (std::uint32_t j = 0; j < kAcross; ++j) {
      const std::uint32_t k = (i + 1) % kAround, l = (j + 1) % kAcross;
      cage.face_vertex_counts.push_back(4);
      for (const auto& [row, column] : {std::pair(i, j), {i, l}, {k, l}, {k, j}})
        cage.face_vertex_indices.push_back(row * kAcross + column);
    }
  }
  return cage;
}

TriangleMesh limit_mesh(const SubdivisionMesh& cage, std::uint32_t triangles, EdgeRates rates) {
  auto refinable = std::make_shared<RefinableCage>(cage);
  const double unit = std::sqrt(2.0 * area(cage) / triangles);
  EdgeLevels levels = levels_of(*refinable, cage.control_positions(0), unit, rates);
  const RefinedMesh refined(std::move(refinable), std::move(levels));
  TriangleMesh mesh;
  mesh.name = cage.name;
  mesh.segments = cage.segments;
  mesh.degree = cage.degree;
  mesh.vertex_count = refined.point_count();
  mesh.triangles = refined.triangles();
  mesh.positions.resize(mesh.position_count() + TriangleMesh::kGuard);
  std::vector<const float*> from;
  std::vector<float*> to;
  for (std::uint32_t control = 0; control < cage.form().controls(); ++control) {
    from.push_back(&cage.control_positions(control)->x);
    to.push_back(&mesh.positions[std::size_t(control) * mesh.vertex_count].x);
  }
  refined.at_points({}, 3, from, to);
  return validated(std::move(mesh));
}

}  // namespace msbvh::bench
