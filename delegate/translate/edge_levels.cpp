#include "delegate/translate/edge_levels.h"

#include <algorithm>
#include <cmath>

namespace msbvh::translate {
namespace {

constexpr std::size_t kMostTimes = 17;

std::vector<double> times_to_look(const MovingArray& points, const ScreenMeasure& measure) {
  if (points.is_still() && measure.is_still()) return {0.5};
  std::vector<double> times01{0.0, 0.25, 0.5, 0.75, 1.0};
  const std::vector<double> dense = points.is_still() ? std::vector<double>{} : points.dense_times01();
  const std::size_t taken = std::min(dense.size(), kMostTimes - times01.size());
  for (std::size_t i = 0; i < taken; ++i) times01.push_back(dense[i * dense.size() / taken]);
  return times01;
}

// What the vertices of all faces around each vertex have in common.
std::vector<std::uint8_t> around(const MeshInput& faces, const std::vector<std::uint8_t>& of_vertices) {
  std::vector<std::uint8_t> result = of_vertices;
  const int* corner = faces.face_vertex_indices.data();
  for (const int count : faces.face_vertex_counts) {
    std::uint8_t common = 0xff;
    for (int i = 0; i < count; ++i) common &= of_vertices[std::size_t(corner[i])];
    for (int i = 0; i < count; ++i) result[std::size_t(corner[i])] &= common;
    corner += count;
  }
  return result;
}

double pixels_between(const Vec3d& a, const Vec3d& b, const ScreenInstant& screen) {
  const Vec3d along = b - a;
  const double length2 = dot(along, along);
  if (!(length2 > 0.0)) return 0.0;
  // Where it comes nearest to the eye.
  const double w = std::clamp(dot(screen.eye - a, along) / length2, 0.0, 1.0);
  return screen.at_point(std::sqrt(length2), a + along * w);
}

// Common to all of a cube of `reach` to either side.
std::uint8_t sides_beyond(const ScreenInstant& screen, const Vec3d& point, double reach) {
  if (reach == 0.0) return screen.sides_beyond(point);
  std::uint8_t common = 0xff;
  for (int corner = 0; corner < 8; ++corner) {
    const auto side = [&](int bit) { return (corner & bit) != 0 ? reach : -reach; };
    common &= screen.sides_beyond(point + Vec3d{side(1), side(2), side(4)});
  }
  return common;
}

// By which lengths grow at most.
double largest_scale(const Affine3d& map) {
  return std::sqrt(dot(map.x, map.x) + dot(map.y, map.y) + dot(map.z, map.z));
}

}  // namespace

EdgeRule::Instant EdgeRule::instant_at(const MeshInput& faces, const MovingArray& points,
                                       const EdgeLength& edges, double time01) {
  const Affine3d map = points.transform.at(time01, time01);
  const ArrayInstant values = points.values.at(time01, time01);
  const double reach = edges.reach == 0.0 ? 0.0 : edges.reach * largest_scale(map);
  Instant instant{{}, edges.measure.at(time01), {}};
  std::vector<std::uint8_t> beyond;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3d p = map.point(values[i]);
    instant.pose.push_back(Vec3f(p));
    beyond.push_back(sides_beyond(instant.screen, p, reach));
  }
  if (std::ranges::any_of(beyond, [](std::uint8_t sides) { return sides != 0; }))
    instant.beyond =
        around(faces, around(faces, beyond));  // a face depends on the vertices of those around it
  return instant;
}

EdgeRule::EdgeRule(const MeshInput& faces, const MovingArray& points, const EdgeLength& edges)
    : pixels_(edges.pixels) {
  for (const double time01 : times_to_look(points, edges.measure))
    instants_.push_back(instant_at(faces, points, edges, time01));
}

std::vector<const Vec3f*> EdgeRule::poses() const {
  std::vector<const Vec3f*> result;
  for (const Instant& instant : instants_) result.push_back(instant.pose.data());
  return result;
}

std::uint32_t EdgeRule::level(const CageEdge& edge) const {
  double longest = 0.0;
  for (std::size_t i = 0; i < instants_.size(); ++i) {
    const auto& [start, middle, end] = edge.curves[i];
    const Instant& instant = instants_[i];
    double pixels = 2.0 * std::max(pixels_between(start, middle, instant.screen),
                                   pixels_between(middle, end, instant.screen));
    if (!instant.beyond.empty() && (instant.beyond[edge.a] | instant.beyond[edge.b]) != 0)
      pixels /= kLongerOutside;
    longest = std::max(longest, pixels);
  }
  const double level = std::round(std::log2(longest / pixels_));
  if (!(level > 0.0)) return 0;
  return level < double(kMaxEdgeLevel) ? std::uint32_t(level) : kMaxEdgeLevel;
}

}  // namespace msbvh::translate
