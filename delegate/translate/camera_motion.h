// A camera over the shutter in double precision: its transform, window, lens and clipping range as the
// front-end sampled them, and interpolated as a track of it is.
#pragma once

#include <array>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "core/base/affine.h"
#include "core/base/lerp.h"
#include "core/motion/bezier_fit.h"
#include "delegate/translate/inputs.h"
#include "delegate/translate/smooth_times.h"
#include "delegate/translate/time_layout.h"
#include "delegate/translate/transform_samples.h"

namespace msbvh::translate {

struct WindowD {
  double left, right, bottom, top;
};

inline WindowD window_of(const ScreenWindow& w) { return {w.left, w.right, w.bottom, w.top}; }

inline WindowD lerp(const WindowD& a, const WindowD& b, double w) {
  return {msbvh::lerp(a.left, b.left, w), msbvh::lerp(a.right, b.right, w),
          msbvh::lerp(a.bottom, b.bottom, w), msbvh::lerp(a.top, b.top, w)};
}

struct LensD {
  double radius, focus_distance;

  // Of the disc that a point at a depth is spread over, at unit distance; the sign says on which side of the
  // plane in focus the point lies.
  double blur_radius(double depth) const { return radius * (1.0 / depth - 1.0 / focus_distance); }
};

inline LensD lens_of(const Lens& lens) { return {lens.radius, lens.focus_distance}; }

inline LensD lerp(const LensD& a, const LensD& b, double w) {
  return {msbvh::lerp(a.radius, b.radius, w), msbvh::lerp(a.focus_distance, b.focus_distance, w)};
}

struct ClipD {
  double near_clip, far_clip;
};

inline ClipD clip_of(const CameraInput& camera, const CameraSample& sample) {
  const ClipRange clip = sample.clip.value_or(ClipRange{camera.near_clip, camera.far_clip});
  return {clip.near_clip, clip.far_clip};
}

inline ClipD lerp(const ClipD& a, const ClipD& b, double w) {
  return {msbvh::lerp(a.near_clip, b.near_clip, w), msbvh::lerp(a.far_clip, b.far_clip, w)};
}

struct CameraInstant {
  Affine3d world_from_camera;
  WindowD window;
  LensD lens;
  ClipD clip;
};

inline CameraInstant lerp(const CameraInstant& a, const CameraInstant& b, double w) {
  return {msbvh::lerp(a.world_from_camera, b.world_from_camera, w), lerp(a.window, b.window, w),
          lerp(a.lens, b.lens, w), lerp(a.clip, b.clip, w)};
}

// All that a camera's tracks hold at one time, as numbers that can be interpolated.
struct CameraValues {
  std::array<double, 20> v;

  explicit CameraValues(const CameraInstant& c) {
    const Affine3d& m = c.world_from_camera;
    v = {m.x.x,
         m.x.y,
         m.x.z,
         m.y.x,
         m.y.y,
         m.y.z,
         m.z.x,
         m.z.y,
         m.z.z,
         m.t.x,
         m.t.y,
         m.t.z,
         c.window.left,
         c.window.right,
         c.window.bottom,
         c.window.top,
         c.lens.radius,
         c.lens.focus_distance,
         c.clip.near_clip,
         c.clip.far_clip};
  }
  CameraInstant instant() const {
    return {{{v[0], v[1], v[2]}, {v[3], v[4], v[5]}, {v[6], v[7], v[8]}, {v[9], v[10], v[11]}},
            {v[12], v[13], v[14], v[15]},
            {v[16], v[17]},
            {v[18], v[19]}};
  }
  CameraValues operator+(const CameraValues& b) const { return combined(1.0, b, 1.0); }
  CameraValues operator-(const CameraValues& b) const { return combined(1.0, b, -1.0); }
  CameraValues operator*(double s) const { return combined(s, *this, 0.0); }

 private:
  CameraValues combined(double mine, const CameraValues& b, double others) const {
    CameraValues result = *this;
    for (std::size_t i = 0; i < v.size(); ++i) result.v[i] = mine * v[i] + others * b.v[i];
    return result;
  }
};

// The samples, rebased to the frame's origin and interpolated (smooth_times.h).
class CameraMotion {
 public:
  CameraMotion(const CameraInput& camera, const Vec3d& origin)
      : smooth_({}, {}, false), periods01_(camera.periods01) {
    for (const CameraSample& sample : camera.samples) {
      times01_.push_back(sample.time01);
      instants_.emplace_back(CameraInstant{rebased(affine_from(sample.world_from_camera), {}, origin),
                                           window_of(sample.window), lens_of(sample.lens),
                                           clip_of(camera, sample)});
    }
    smooth_ = SmoothTimes(times01_, camera.breakpoints01, false);
    if (times01_.size() < 2) return;
    for (const double time01 : camera.breakpoints01.value_or(times01_)) breakpoints_.push_back({time01});
    breakpoints_ = normalized_breakpoints(std::move(breakpoints_));
  }
  CameraInstant at(double time01) const {
    const SmoothTimes::Mix mix = smooth_.at(time01, time01);
    CameraValues sum = instants_[mix.first] * mix.weight[0];
    for (std::size_t i = 1; i < mix.count; ++i) sum = sum + instants_[mix.first + i] * mix.weight[i];
    return sum.instant();
  }
  // Controls of a segment, degree + 1.
  std::vector<CameraInstant> controls(const LayoutSegment& segment, std::uint32_t degree) const {
    std::vector<CameraValues> values;
    for (const double node : fit_nodes(degree)) values.emplace_back(at(segment.at(node)));
    controls_from_values([&](std::uint32_t i) -> CameraValues& { return values[i]; }, degree);
    std::vector<CameraInstant> result;
    for (const CameraValues& value : values) result.push_back(value.instant());
    return result;
  }
  std::span<const Breakpoint> breakpoints() const { return breakpoints_; }
  const std::vector<double>& times01() const { return times01_; }
  const std::vector<double>& periods01() const { return periods01_; }

 private:
  std::vector<double> times01_;
  std::vector<CameraValues> instants_;
  SmoothTimes smooth_;
  std::vector<Breakpoint> breakpoints_;
  std::vector<double> periods01_;
};

// A point (or, at infinity, a direction) in camera space at a place of the window, (0, 0) to (1, 1).
inline Vec3d camera_point(const WindowD& w, double x01, double y01, double depth, bool perspective) {
  const double x = msbvh::lerp(w.left, w.right, x01), y = msbvh::lerp(w.bottom, w.top, y01);
  if (!perspective) return {x, y, -depth};
  return std::isinf(depth) ? Vec3d{x, y, -1.0} : Vec3d{x * depth, y * depth, -depth};
}

}  // namespace msbvh::translate
