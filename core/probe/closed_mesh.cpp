#include "core/probe/closed_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/base/affine.h"
#include "core/base/triangle_distance.h"
#include "core/trace/oracle.h"
#include "core/trace/pose.h"

namespace msbvh {
namespace {

constexpr int kTries = 16;
// Of rounded_size(): four times what a kernel may round of a vertex and of a ray.
constexpr double kClearance = 4.0 * kOracleError;

// Of the triangle as the origin sees it, signed by its side: A. van Oosterom, J. Strackee, "The Solid Angle
// of a Plane Triangle", IEEE Trans. Biomed. Eng. 30(2), 1983.
double solid_angle(const std::array<Vec3d, 3>& v) {
  const double a = length(v[0]), b = length(v[1]), c = length(v[2]);
  const double below = a * b * c + dot(v[0], v[1]) * c + dot(v[1], v[2]) * a + dot(v[2], v[0]) * b;
  return 2.0 * std::atan2(dot(v[0], cross(v[1], v[2])), below);
}

// The largest number that goes into where the mesh and a ray from the point are: what a kernel rounds is a
// share of it. Keys may be far larger than what lies between them, and a map that is nearly singular
// magnifies.
double rounded_size(const ShownMesh& shown, const MeshPose& pose, const Vec3d& point) {
  const TriangleMesh& mesh = *shown.mesh;
  double size = 0.0;
  for (std::uint32_t v = 0; v < mesh.vertex_count; ++v) {
    const auto of_vertex = [&](std::uint32_t c) {
      return largest_coordinate(Vec3d(mesh.control_positions(c)[v]));
    };
    size = std::max(size, largest_control(mesh.form(), pose.time01, of_vertex));
  }
  if (shown.instance == kNoInstance) return std::max(size, largest_coordinate(point));
  const Affine3d& map = pose.world_from_mesh;
  if (map.determinant() == 0.0) return std::numeric_limits<double>::infinity();
  const Affine3d back = inverse(map);
  const Vec3d terms = abs(back.x) * std::abs(point.x) + abs(back.y) * std::abs(point.y) +
                      abs(back.z) * std::abs(point.z) + abs(back.t);
  const double magnified = (length(map.x) + length(map.y) + length(map.z)) * largest_coordinate(terms);
  return std::max({magnified, pose.map_size * (3.0 * size + 1.0), largest_coordinate(point)});
}

// For each vertex, one that lies where it does at every control.
std::vector<std::uint32_t> welded(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> order(mesh.vertex_count), first(mesh.vertex_count);
  std::iota(order.begin(), order.end(), 0u);
  const auto compare = [&](std::uint32_t a, std::uint32_t b) {
    for (std::uint32_t c = 0; c < mesh.form().controls(); ++c) {
      const Vec3f &p = mesh.control_positions(c)[a], &q = mesh.control_positions(c)[b];
      for (int axis = 0; axis < 3; ++axis) {
        if (p[axis] != q[axis]) return p[axis] < q[axis] ? -1 : 1;
      }
    }
    return 0;
  };
  std::ranges::stable_sort(order, [&](std::uint32_t a, std::uint32_t b) { return compare(a, b) < 0; });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && compare(order[i - 1], order[i]) == 0;
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }
  return first;
}

}  // namespace

bool is_closed(const TriangleMesh& mesh) {
  const std::vector<std::uint32_t> place = welded(mesh);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> there, back;
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = place[t[k]], b = place[t[(k + 1) % 3]];
      if (a == b) continue;
      there.emplace_back(a, b);
      back.emplace_back(b, a);
    }
  }
  std::ranges::sort(there);
  std::ranges::sort(back);
  return !there.empty() && there == back;
}

std::vector<const ShownMesh*> closed_meshes(const ShownMeshes& all) {
  std::unordered_map<const TriangleMesh*, bool> known;
  std::vector<const ShownMesh*> closed;
  for (const ShownMesh& shown : all.meshes()) {
    const auto [at, is_new] = known.try_emplace(shown.mesh, false);
    if (is_new) at->second = is_closed(*shown.mesh);
    if (at->second) closed.push_back(&shown);
  }
  return closed;
}

bool is_inside(const ShownMesh& shown, const MeshPose& pose, const Vec3d& point) {
  constexpr double kSphere = 12.566370614359172;
  double angle = 0.0, nearest = 1e300;
  for (std::uint32_t i = 0; i < shown.mesh->triangles.size(); ++i) {
    std::array<Vec3d, 3> v = corners(shown, pose, i);
    for (Vec3d& corner : v) corner = corner - point;
    angle += solid_angle(v);
    nearest = std::min(nearest, distance_to_triangle(v));
  }
  return std::abs(angle) > 0.5 * kSphere && nearest > kClearance * rounded_size(shown, pose, point);
}

std::optional<Vec3f> point_inside(const ShownMesh& shown, const MeshPose& pose, ProbeRandom& random) {
  Box3d box;
  for (std::uint32_t i = 0; i < shown.mesh->triangles.size(); ++i) {
    for (const Vec3d& corner : corners(shown, pose, i)) box.grow(corner);
  }
  const double size = length(box.hi - box.lo);
  for (int i = 0; i < kTries; ++i) {
    // From a point of the surface to one side by some share of the size: thin shapes have an inside, too.
    const auto t = static_cast<std::uint32_t>(random.below(shown.mesh->triangles.size()));
    const std::array<Vec3d, 3> v = corners(shown, pose, t);
    const Vec3d normal = cross(v[1] - v[0], v[2] - v[0]);
    const double area = length(normal);
    if (!(area > 0.0)) continue;
    const Vec3d on =
        v[0] + (v[1] - v[0]) * random.uniform(0.0, 0.5) + (v[2] - v[0]) * random.uniform(0.0, 0.5);
    const double depth = size * std::exp2(random.uniform(-10.0, -1.0)) * (random.below(2) == 0 ? -1.0 : 1.0);
    const Vec3f point(on + normal * (depth / area));
    if (is_inside(shown, pose, Vec3d(point))) return point;
  }
  return std::nullopt;
}

}  // namespace msbvh
