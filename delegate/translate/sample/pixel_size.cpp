#include "delegate/translate/sample/pixel_size.h"

#include <algorithm>
#include <cmath>

namespace msbvh::translate {

PixelSize::PixelSize(const Box3d& camera, bool perspective, double per_unit, double near)
    : camera_(camera), perspective_(perspective), per_unit_(per_unit), near_(near) {}

PixelSize PixelSize::uniform(double size) { return PixelSize({}, false, size, 0.0); }

double PixelSize::at_shell(const Vec3d& centre, double outer, double inner) const {
  if (!perspective_) return per_unit_;
  const Vec3d zero{0.0, 0.0, 0.0};
  const Vec3d to_nearest = max(max(centre - camera_.hi, camera_.lo - centre), zero);
  const Vec3d a = centre - camera_.lo, b = centre - camera_.hi;
  const Vec3d to_farthest{std::max(std::abs(a.x), std::abs(b.x)), std::max(std::abs(a.y), std::abs(b.y)),
                          std::max(std::abs(a.z), std::abs(b.z))};
  const double outside = length(to_nearest) - outer, inside = inner - length(to_farthest);
  return per_unit_ * std::max(std::max(outside, inside), near_);
}

double PixelSize::at_box(const Box3d& box) const {
  if (!perspective_) return per_unit_;
  const Vec3d gap = max(max(box.lo - camera_.hi, camera_.lo - box.hi), Vec3d{0.0, 0.0, 0.0});
  return per_unit_ * std::max(length(gap), near_);
}

}  // namespace msbvh::translate
