// The distance from a point to a triangle.
#pragma once

#include <algorithm>
#include <array>

#include "core/base/vec.h"

namespace msbvh {

// From the origin to the nearest point of a triangle, which may have no area: C. Ericson, Real-Time Collision
// Detection, 5.1.5.
inline double distance_to_triangle(const std::array<Vec3d, 3>& v) {
  const Vec3d ab = v[1] - v[0], ac = v[2] - v[0];
  const double d1 = dot(ab, -v[0]), d2 = dot(ac, -v[0]);
  if (d1 <= 0.0 && d2 <= 0.0) return length(v[0]);
  const double d3 = dot(ab, -v[1]), d4 = dot(ac, -v[1]);
  if (d3 >= 0.0 && d4 <= d3) return length(v[1]);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 && d1 > d3) return length(v[0] + ab * (d1 / (d1 - d3)));
  const double d5 = dot(ab, -v[2]), d6 = dot(ac, -v[2]);
  if (d6 >= 0.0 && d5 <= d6) return length(v[2]);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 && d2 > d6) return length(v[0] + ac * (d2 / (d2 - d6)));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 && (d4 - d3) + (d5 - d6) > 0.0)
    return length(v[1] + (v[2] - v[1]) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))));
  const double sum = va + vb + vc;
  if (sum == 0.0) return std::min({length(v[0]), length(v[1]), length(v[2])});
  return length(v[0] + ab * (vb / sum) + ac * (vc / sum));
}

inline double distance_to_triangle(const Vec3d& point, const std::array<Vec3d, 3>& v) {
  return distance_to_triangle({v[0] - point, v[1] - point, v[2] - point});
}

}  // namespace msbvh
