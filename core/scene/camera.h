// The camera that a frame is seen through.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/affine.h"
#include "core/base/lerp.h"
#include "core/motion/time_remap.h"
#include "core/motion/track.h"

namespace msbvh {

// The part of the image plane that the image shows, at unit distance from the eye for a perspective camera,
// in scene units for an orthographic one. left < right, bottom < top, unless the camera mirrors.
struct ScreenWindow {
  float left = -1.0f, right = 1.0f, bottom = -1.0f, top = 1.0f;
};

constexpr ScreenWindow lerp(const ScreenWindow& a, const ScreenWindow& b, float w) {
  return {lerp(a.left, b.left, w), lerp(a.right, b.right, w), lerp(a.bottom, b.bottom, w),
          lerp(a.top, b.top, w)};
}

// A thin lens at the eye, across the camera's z axis, in camera space.
struct Lens {
  float radius = 0.0f;          // of its aperture, a disc
  float focus_distance = 1.0f;  // along -z, of the plane in focus
};

constexpr Lens lerp(const Lens& a, const Lens& b, float w) {
  return {lerp(a.radius, b.radius, w), lerp(a.focus_distance, b.focus_distance, w)};
}

// Distances along -z between which camera rays see.
struct ClipRange {
  float near_clip = 1.0f, far_clip = 1.0e6f;
};

constexpr ClipRange lerp(const ClipRange& a, const ClipRange& b, float w) {
  return {lerp(a.near_clip, b.near_clip, w), lerp(a.far_clip, b.far_clip, w)};
}

// What lies below it, seen by dot(normal, point) + offset < 0 in camera space, is cut off.
struct ClippingPlane {
  Vec3f normal;
  float offset = 0.0f;
};

enum class Projection : std::uint8_t { kPerspective, kOrthographic };

// Looks along -z with y up, as USD cameras do.
struct Camera {
  std::string name;
  Projection projection = Projection::kPerspective;
  std::uint32_t segments = 0;
  std::vector<Affine3f> world_from_camera;  // form().controls(), rigid or not
  std::vector<ScreenWindow> window;         // form().controls()
  std::vector<Lens> lens;                   // empty: a pinhole; else form().controls(), perspective only
  float near_clip = 1.0f;  // distances along -z; what lies outside is not seen by camera rays
  float far_clip = 1.0e6f;
  std::uint32_t degree = 1;
  TimeRemap time_remap{};         // of the tracks; hides nothing
  std::vector<ClipRange> clip{};  // empty: near_clip to far_clip throughout; else form().controls()
  std::vector<ClippingPlane> clipping_planes{};  // of camera rays; they move with the camera

  TrackForm form() const { return {segments, degree}; }
};

}  // namespace msbvh
