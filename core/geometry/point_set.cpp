#include "core/geometry/point_set.h"

#include <algorithm>
#include <cmath>

#include "core/base/lerp.h"
#include "core/geometry/round_check.h"

namespace msbvh {
namespace {

// Of the largest coordinate: interpolation of the centre, of the radius and of the box, kLerpError a degree,
// and the sum's rounding.
constexpr float kPad = 3.0f * static_cast<float>(kMaxDegree) * kLerpError;

Box3f box_of(const RoundVertex& v) {
  const float size = std::max({std::abs(v.p.x), std::abs(v.p.y), std::abs(v.p.z)});
  const float out = v.radius + kPad * (size + v.radius);
  const Vec3f pad{out, out, out};
  return {v.p - pad, v.p + pad};
}

}  // namespace

void validate(const PointSet& points) {
  const std::string part = points.name.empty() ? "points" : points.name;
  check_form(points.form(), part);
  check_vertices(points.vertices, points.form(), points.point_count, part);
}

bool is_there(const PointSet& points, std::uint32_t point) {
  for (std::uint32_t c = 0; c < points.form().controls(); ++c) {
    if (points.control_vertices(c)[point].radius > 0.0f) return true;
  }
  return false;
}

Box3f point_box(const PointSet& points, std::uint32_t point, std::uint32_t control) {
  return box_of(points.control_vertices(control)[point]);
}

Box3f point_box_at(const PointSet& points, std::uint32_t point, float u) {
  return box_of(points.vertex(point, u));
}

}  // namespace msbvh
