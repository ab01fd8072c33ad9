// How large a pixel is in the world, seen from a camera that may move: the smallest size that counts for
// something that covers a box or a sphere over the shutter. What a track strays by is measured more closely,
// time by time (screen_measure.h); this says how densely to sample and how finely to cut shapes.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/base/box.h"

namespace msbvh::translate {

class PixelSize {
 public:
  // `camera` is around the eye over the shutter; `per_unit` are world units a pixel, at unit distance
  // (perspective) or anywhere. No distance counts as less than `near`: what lies nearer is not seen.
  PixelSize(const Box3d& camera, bool perspective, double per_unit, double near);
  // As large everywhere.
  static PixelSize uniform(double size);

  // At the surface, seen from outside or inside, that lies between two spheres about a point.
  double at_shell(const Vec3d& centre, double outer, double inner) const;
  double at_box(const Box3d& box) const;
  // World units a pixel: at unit distance (perspective) or anywhere.
  double per_unit() const { return per_unit_; }

 private:
  Box3d camera_;
  bool perspective_;
  double per_unit_, near_;
};

}  // namespace msbvh::translate
