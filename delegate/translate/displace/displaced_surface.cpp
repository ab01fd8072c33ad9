#include "delegate/translate/displace/displaced_surface.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/parallel.h"
#include "core/geometry/triangle_mesh.h"
#include "delegate/translate/mesh.h"

namespace msbvh::translate {
namespace {

// Motion is tested on some of the points of some of the faces, and on the one of each that goes farthest. A
// surface turns smoothly: faces far apart say more than points side by side.
constexpr std::size_t kMostFaces = 512, kMostPointsOfFace = 24;

// Unit sums of the normals of a point's triangles, weighted by their areas; zero where they cancel.
std::vector<Vec3d> smooth_normals_of(const std::vector<Triangle>& triangles,
                                     const std::vector<Vec3f>& positions) {
  std::vector<Vec3d> normals(positions.size());
  for (const Triangle& t : triangles) {
    const Vec3d a(positions[t[0]]);
    const Vec3d twice_area = cross(Vec3d(positions[t[1]]) - a, Vec3d(positions[t[2]]) - a);
    for (const std::uint32_t vertex : t) normals[vertex] += twice_area;
  }
  for (Vec3d& normal : normals) normal = normalize(normal);
  return normals;
}

}  // namespace

// A face, and the points of it that are looked at.
struct DisplacedSurface::Pick {
  Pick(const LimitSurface& limit, std::uint32_t face, std::vector<FacePoint> some)
      : surface(limit, face), points(std::move(some)) {}

  FaceSurface surface;
  std::vector<FacePoint> points;
};

DisplacedSurface::DisplacedSurface(const MovingArray& points, const Tessellation& faces,
                                   PointDistances distances)
    : points_(points),
      faces_(faces),
      distances_(std::move(distances)),
      shift_(exact_origin(bounds({points.values, TransformTrack(Affine3d{})}))) {
  if (faces.refinement() && !is_still()) pick();
}

DisplacedSurface::~DisplacedSurface() = default;

void DisplacedSurface::pick() {
  const RefinedMesh& mesh = *faces_.refinement()->mesh;
  const std::vector<std::uint32_t>& drawn = mesh.drawn_faces();
  const std::size_t faces = std::min(drawn.size(), kMostFaces);
  const std::vector<double> distances = distances_.at(0.5);
  const auto farther = [&](const FacePoint& a, const FacePoint& b) {
    return std::abs(distances[a.id]) < std::abs(distances[b.id]);
  };
  for (std::size_t i = 0; i < faces; ++i) {
    const std::uint32_t face = drawn[i * drawn.size() / faces];
    const std::vector<FacePoint> all = mesh.points_of(face);
    const std::size_t count = std::min(all.size(), kMostPointsOfFace);
    std::vector<FacePoint> some;
    for (std::size_t k = 0; k < count; ++k) some.push_back(all[k * all.size() / count]);
    some.push_back(*std::ranges::max_element(all, farther));
    picks_.push_back(std::make_unique<Pick>(mesh.surface(), face, std::move(some)));
  }
}

std::size_t DisplacedSurface::size() const {
  return faces_.refinement() ? faces_.refinement()->mesh->point_count() : points_.size();
}

std::vector<Breakpoint> DisplacedSurface::breakpoints() const {
  std::vector<Breakpoint> result = points_.breakpoints();
  if (!distances_.is_still()) {
    for (const double time01 : distances_.times01()) result.emplace_back(time01);
  }
  return normalized_breakpoints(std::move(result));
}

std::vector<Vec3f> DisplacedSurface::pose(double time01, double within) const {
  const ArrayInstant values = points_.values.at(time01, within);
  std::vector<Vec3f> pose;
  pose.reserve(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) pose.push_back(Vec3f(values[i] - shift_));
  return pose;
}

std::vector<Vec3d> DisplacedSurface::at(double time01, double within) const {
  const std::vector<Vec3f> own = pose(time01, within);
  const Affine3d map = points_.transform.at(time01, within);
  const std::vector<double> distances = distances_.at(time01);
  RefinedMesh::LimitPoints surface;
  if (const Refinement* refinement = faces_.refinement()) {
    surface = refinement->mesh->limit(own.data());
  } else {
    surface.normals = smooth_normals_of(faces_.triangles(), own);
    for (const Vec3f& p : own) surface.positions.push_back(Vec3d(p));
  }
  for (std::size_t i = 0; i < distances.size(); ++i) {
    surface.positions[i] = placed(map, surface.positions[i] + surface.normals[i] * distances[i]);
  }
  return std::move(surface.positions);
}

std::vector<Vec3d> DisplacedSurface::picked_at(double time01, double within) const {
  if (!faces_.refinement()) return at(time01, within);
  const std::vector<Vec3f> own = pose(time01, within);
  const Affine3d map = points_.transform.at(time01, within);
  const std::vector<double> distances = distances_.at(time01);
  std::vector<std::vector<Vec3d>> found(picks_.size());
  parallel_for(picks_.size(), [&](std::size_t i) {
    Pick& pick = *picks_[i];
    pick.surface.set_values(&own.data()->x, 3);
    for (const FacePoint& p : pick.points) {
      const LimitPoint limit = pick.surface.evaluate(p.square, p.s, p.t);
      const Vec3d normal = normalize(cross(limit.du, limit.dv));
      found[i].push_back(placed(map, limit.position + normal * distances[p.id]));
    }
  });
  std::vector<Vec3d> result;
  for (const std::vector<Vec3d>& points : found) result.insert(result.end(), points.begin(), points.end());
  return result;
}

}  // namespace msbvh::translate
