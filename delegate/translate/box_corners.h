// The eight corners of a box under affine maps: what a whole object does is bounded by what they do, because
// the difference of two affine maps is affine and its length convex.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/affine.h"
#include "core/base/box.h"

namespace msbvh::translate {

using BoxCorners = std::array<Vec3d, 8>;

inline BoxCorners corners_of(const Box3d& box) {
  BoxCorners corners;
  for (int i = 0; i < 8; ++i) {
    corners[i] = {i & 1 ? box.hi.x : box.lo.x, i & 2 ? box.hi.y : box.lo.y, i & 4 ? box.hi.z : box.lo.z};
  }
  return corners;
}

inline Box3d bounds_of(const BoxCorners& corners, const Affine3d& map) {
  Box3d box;
  for (const Vec3d& corner : corners) box.grow(map.point(corner));
  return box;
}

// Of any point in the box under the one map from the same point under the other.
inline double largest_distance(const BoxCorners& corners, const Affine3d& a, const Affine3d& b) {
  const Affine3d difference{a.x - b.x, a.y - b.y, a.z - b.z, a.t - b.t};
  double square = 0.0;
  for (const Vec3d& corner : corners) {
    const Vec3d d = difference.point(corner);
    square = std::max(square, dot(d, d));
  }
  return std::sqrt(square);
}

}  // namespace msbvh::translate
