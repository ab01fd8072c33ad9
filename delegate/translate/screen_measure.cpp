#include "delegate/translate/screen_measure.h"

#include <algorithm>
#include <cmath>

#include "core/base/lerp.h"
#include "delegate/translate/time_samples.h"
#include "delegate/translate/transform_samples.h"

namespace msbvh::translate {
namespace {

// From the eye to the surface of the box.
double distance_to_surface(const Vec3d& eye, const Box3d& box) {
  const Vec3d outside = max(max(box.lo - eye, eye - box.hi), Vec3d{});
  if (!box.contains(eye)) return length(outside);
  const Vec3d inside = min(eye - box.lo, box.hi - eye);
  return std::min({inside.x, inside.y, inside.z});
}

// 1 / cos^2 of the angle between the axis and the farthest corner of the window at unit distance.
double corner_stretch(const ScreenWindow& w) {
  const double x = std::max(std::abs(double(w.left)), std::abs(double(w.right)));
  const double y = std::max(std::abs(double(w.bottom)), std::abs(double(w.top)));
  return 1.0 + x * x + y * y;
}

ScreenInstant instant_of(const CameraInput& camera, const CameraSample& sample, const Vec3d& origin,
                         std::uint32_t width, std::uint32_t height) {
  const Affine3d map = affine_from(sample.world_from_camera);
  const ScreenWindow& w = sample.window;
  const double scale =
      std::max(width / std::abs(double(w.right) - w.left), height / std::abs(double(w.top) - w.bottom));
  ScreenInstant instant;
  instant.eye = map.t - origin;
  instant.perspective = camera.projection == Projection::kPerspective;
  if (instant.perspective) {
    instant.pixels_per_unit = scale * corner_stretch(w);
    instant.nearest = camera.near_clip * length(map.z);
  } else {
    instant.pixels_per_unit = scale / std::min(length(map.x), length(map.y));
  }
  return instant;
}

}  // namespace

double ScreenInstant::in_box(double deviation, const Box3d& box) const {
  return at_distance(deviation, distance_to_surface(eye, box));
}

ScreenMeasure::ScreenMeasure(const CameraInput& camera, const Vec3d& origin, std::uint32_t width,
                             std::uint32_t height) {
  for (const CameraSample& sample : camera.samples) {
    times01_.push_back(sample.time01);
    instants_.push_back(instant_of(camera, sample, origin, width, height));
  }
}

ScreenMeasure ScreenMeasure::filled_by(const Box3d& box, std::uint32_t width, std::uint32_t height) {
  double pixels_per_unit = 1.0;
  const double size = box.empty() ? 0.0 : length(box.extent());
  if (size > 0.0) pixels_per_unit = std::hypot(double(width), double(height)) / size;
  return constant(pixels_per_unit);
}

ScreenMeasure ScreenMeasure::constant(double pixels_per_unit) {
  ScreenMeasure measure;
  ScreenInstant instant;
  instant.pixels_per_unit = pixels_per_unit;
  measure.times01_ = {0.0};
  measure.instants_ = {instant};
  return measure;
}

ScreenInstant ScreenMeasure::at(double time01) const {
  const Bracket at = bracket(times01_, time01);
  const ScreenInstant &a = instants_[at.first], &b = instants_[at.second];
  if (at.first == at.second) return a;
  return {lerp(a.eye, b.eye, at.w), lerp(a.pixels_per_unit, b.pixels_per_unit, at.w),
          lerp(a.nearest, b.nearest, at.w), a.perspective};
}

}  // namespace msbvh::translate
