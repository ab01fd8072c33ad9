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

View view_of(const Affine3d& world_from_camera, const ScreenWindow& w) {
  const double x = View::kMargin * (double(w.right) - w.left), y = View::kMargin * (double(w.top) - w.bottom);
  return {inverse(world_from_camera), std::min(w.left - x, w.right + x), std::max(w.left - x, w.right + x),
          std::min(w.bottom - y, w.top + y), std::max(w.bottom - y, w.top + y)};
}

View between(const View& a, const View& b, double w) {
  const Affine3d &p = a.camera_from_world, &q = b.camera_from_world;
  return {{lerp(p.x, q.x, w), lerp(p.y, q.y, w), lerp(p.z, q.z, w), lerp(p.t, q.t, w)},
          lerp(a.left, b.left, w),
          lerp(a.right, b.right, w),
          lerp(a.bottom, b.bottom, w),
          lerp(a.top, b.top, w)};
}

ScreenInstant instant_of(const CameraInput& camera, const CameraSample& sample, const Vec3d& origin,
                         std::uint32_t width, std::uint32_t height) {
  const Affine3d map = affine_from(sample.world_from_camera);
  const ScreenWindow& w = sample.window;
  const double scale =
      std::max(width / std::abs(double(w.right) - w.left), height / std::abs(double(w.top) - w.bottom));
  ScreenInstant instant;
  instant.eye = map.t - origin;
  Affine3d world_from_camera = map;
  world_from_camera.t = instant.eye;
  if (map.determinant() != 0.0) instant.view = view_of(world_from_camera, w);
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

std::uint8_t ScreenInstant::sides_beyond(const Vec3d& point) const {
  if (!view) return 0;
  const Vec3d p = view->camera_from_world.point(point);
  const double depth = -p.z, scale = perspective ? depth : 1.0;
  const auto bit = [](bool beyond, int place) { return std::uint8_t(int(beyond) << place); };
  return std::uint8_t(bit(p.x < view->left * scale, 0) | bit(p.x > view->right * scale, 1) |
                      bit(p.y < view->bottom * scale, 2) | bit(p.y > view->top * scale, 3) |
                      bit(depth < 0.0, 4));
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
  ScreenInstant result{lerp(a.eye, b.eye, at.w), lerp(a.pixels_per_unit, b.pixels_per_unit, at.w),
                       lerp(a.nearest, b.nearest, at.w), a.perspective};
  if (a.view && b.view) result.view = between(*a.view, *b.view, at.w);
  return result;
}

}  // namespace msbvh::translate
