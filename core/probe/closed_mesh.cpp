#include "core/probe/closed_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "core/base/affine.h"
#include "core/trace/oracle.h"

namespace msbvh {
namespace {

constexpr int kTries = 16;
// Of the largest coordinate: four times what a kernel may round of a vertex and of a ray.
constexpr double kClearance = 4.0 * kOracleError;

// Of the triangle, nearest to the origin: C. Ericson, Real-Time Collision Detection, 5.1.5.
double distance_to_triangle(const std::array<Vec3d, 3>& v) {
  const Vec3d ab = v[1] - v[0], ac = v[2] - v[0];
  const double d1 = dot(ab, -v[0]), d2 = dot(ac, -v[0]);
  if (d1 <= 0.0 && d2 <= 0.0) return length(v[0]);
  const double d3 = dot(ab, -v[1]), d4 = dot(ac, -v[1]);
  if (d3 >= 0.0 && d4 <= d3) return length(v[1]);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return length(v[0] + ab * (d1 / (d1 - d3)));
  const double d5 = dot(ab, -v[2]), d6 = dot(ac, -v[2]);
  if (d6 >= 0.0 && d5 <= d6) return length(v[2]);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return length(v[0] + ac * (d2 / (d2 - d6)));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0)
    return length(v[1] + (v[2] - v[1]) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))));
  const double sum = va + vb + vc;
  if (sum == 0.0) return std::min({length(v[0]), length(v[1]), length(v[2])});
  return length(v[0] + ab * (vb / sum) + ac * (vc / sum));
}

// Of the triangle as the origin sees it, signed by its side: A. van Oosterom, J. Strackee, "The Solid Angle
// of a Plane Triangle", IEEE Trans. Biomed. Eng. 30(2), 1983.
double solid_angle(const std::array<Vec3d, 3>& v) {
  const double a = length(v[0]), b = length(v[1]), c = length(v[2]);
  const double below = a * b * c + dot(v[0], v[1]) * c + dot(v[1], v[2]) * a + dot(v[2], v[0]) * b;
  return 2.0 * std::atan2(dot(v[0], cross(v[1], v[2])), below);
}

// Whether the mesh winds around the point, and no part of it is near.
bool is_inside(const ShownMesh& shown, const MeshPose& pose, const Vec3d& point) {
  constexpr double kSphere = 12.566370614359172;
  double angle = 0.0, nearest = 1e300, size = 0.0;
  for (std::uint32_t i = 0; i < shown.mesh->triangles.size(); ++i) {
    std::array<Vec3d, 3> v = corners(shown, pose, i);
    for (Vec3d& corner : v) {
      const Vec3d m = abs(corner);
      size = std::max({size, m.x, m.y, m.z});
      corner = corner - point;
    }
    angle += solid_angle(v);
    nearest = std::min(nearest, distance_to_triangle(v));
  }
  return std::abs(angle) > 0.5 * kSphere && nearest > kClearance * size;
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
