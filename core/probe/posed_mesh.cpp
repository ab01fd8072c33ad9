#include "core/probe/posed_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/affine.h"
#include "core/base/box.h"
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

}  // namespace

PosedMesh::PosedMesh(const ShownMesh& shown, const MeshPose& pose)
    : shown_(shown), pose_(pose), places_(shown.mesh->vertex_count) {
  const TriangleMesh& mesh = *shown.mesh;
  for (std::uint32_t v = 0; v < mesh.vertex_count; ++v) {
    places_[v] = pose.world_from_mesh.point(vertex_at(mesh, v, pose.time01));
    const auto of_vertex = [&](std::uint32_t c) {
      return largest_coordinate(Vec3d(mesh.control_positions(c)[v]));
    };
    control_size_ = std::max(control_size_, largest_control(mesh.form(), pose.time01, of_vertex));
  }
}

std::array<Vec3d, 3> PosedMesh::corners(std::uint32_t triangle) const {
  const Triangle& t = shown_.mesh->triangles[triangle];
  return {places_[t[0]], places_[t[1]], places_[t[2]]};
}

// The largest number that goes into where the mesh and a ray from the point are: what a kernel rounds is a
// share of it. Keys may be far larger than what lies between them, and a map that is nearly singular
// magnifies.
double PosedMesh::rounded_size(const Vec3d& point) const {
  if (shown_.instance == kNoInstance) return std::max(control_size_, largest_coordinate(point));
  const Affine3d& map = pose_.world_from_mesh;
  if (map.determinant() == 0.0) return std::numeric_limits<double>::infinity();
  const Affine3d back = inverse(map);
  const Vec3d terms = abs(back.x) * std::abs(point.x) + abs(back.y) * std::abs(point.y) +
                      abs(back.z) * std::abs(point.z) + abs(back.t);
  const double magnified = (length(map.x) + length(map.y) + length(map.z)) * largest_coordinate(terms);
  return std::max({magnified, pose_.map_size * (3.0 * control_size_ + 1.0), largest_coordinate(point)});
}

bool PosedMesh::surrounds(const Vec3d& point) const {
  constexpr double kSphere = 12.566370614359172;
  double angle = 0.0, nearest = 1e300;
  for (std::uint32_t i = 0; i < triangle_count(); ++i) {
    std::array<Vec3d, 3> v = corners(i);
    for (Vec3d& corner : v) corner = corner - point;
    angle += solid_angle(v);
    nearest = std::min(nearest, distance_to_triangle(v));
  }
  return std::abs(angle) > 0.5 * kSphere && nearest > kClearance * rounded_size(point);
}

std::optional<Vec3f> PosedMesh::point_inside(ProbeRandom& random) const {
  Box3d box;
  for (const Triangle& triangle : shown_.mesh->triangles) {
    for (const std::uint32_t v : triangle) box.grow(places_[v]);
  }
  const double size = length(box.hi - box.lo);
  for (int i = 0; i < kTries; ++i) {
    // From a point of the surface to one side by some share of the size: thin shapes have an inside, too.
    const std::array<Vec3d, 3> v = corners(random_triangle(random));
    const Vec3d normal = cross(v[1] - v[0], v[2] - v[0]);
    const double area = length(normal);
    if (!(area > 0.0)) continue;
    const Vec3d on =
        v[0] + (v[1] - v[0]) * random.uniform(0.0, 0.5) + (v[2] - v[0]) * random.uniform(0.0, 0.5);
    const double depth = size * std::exp2(random.uniform(-10.0, -1.0)) * (random.below(2) == 0 ? -1.0 : 1.0);
    const Vec3f point(on + normal * (depth / area));
    if (surrounds(Vec3d(point))) return point;
  }
  return std::nullopt;
}

}  // namespace msbvh
