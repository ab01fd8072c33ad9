// How much a linear map stretches.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/base/affine.h"

namespace msbvh {

// The largest factor by which the map lengthens a vector: its largest singular value, the root of the largest
// eigenvalue of A^T A. O. K. Smith, "Eigenvalues of a symmetric 3 x 3 matrix", Comm. ACM 4(4), 1961. Not
// smaller than the truth by more than rounding.
inline double largest_stretch(const Affine3d& a) {
  const double xx = dot(a.x, a.x), yy = dot(a.y, a.y), zz = dot(a.z, a.z);
  const double xy = dot(a.x, a.y), yz = dot(a.y, a.z), zx = dot(a.z, a.x);
  const double mean = (xx + yy + zz) / 3.0;
  const double off = xy * xy + yz * yz + zx * zx;
  const double x = xx - mean, y = yy - mean, z = zz - mean;
  const double spread = std::sqrt((x * x + y * y + z * z + 2.0 * off) / 6.0);
  if (!(spread > 0.0)) return std::sqrt(mean);
  const double half_determinant =
      0.5 * (x * (y * z - yz * yz) - xy * (xy * z - yz * zx) + zx * (xy * yz - y * zx)) /
      (spread * spread * spread);
  const double angle = std::acos(std::clamp(half_determinant, -1.0, 1.0)) / 3.0;
  return std::sqrt(mean + 2.0 * spread * std::cos(angle));
}

}  // namespace msbvh
