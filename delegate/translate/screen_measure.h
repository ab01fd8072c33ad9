// How many pixels a deviation in the world can be seen as.
//
// A point at distance r from a perspective eye, seen at an angle a off the axis, lies at depth r cos a; moved
// by d it moves on the image plane by at most d / (r cos^2 a) (moved along the direction in which the
// projection stretches). Inside the window a is at most the corner's, so that
//
//   pixels <= d * pixels_per_unit / max(near_clip, r)
//   pixels_per_unit = pixels per unit of the window / cos^2 a_corner
//
// The bound is first order in d / r, and holds for whatever is in the picture; things behind or beside the
// camera, which only reflections, shadows and indirect light show, are measured as if they stood in front of
// it. An orthographic camera has no distance in it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/affine.h"
#include "core/base/box.h"
#include "delegate/translate/inputs.h"

namespace msbvh::translate {

// Where the picture is. A little is left around it, since a filter reaches over its sides.
struct View {
  static constexpr double kMargin = 0.1;  // of its width and height

  Affine3d camera_from_world;
  double left, right, bottom, top;  // as of ScreenWindow, with the margin
};

// The measure at one time.
struct ScreenInstant {
  Vec3d eye;                     // frame's world
  double pixels_per_unit = 1.0;  // at unit distance, in world units
  double nearest = 0.0;          // no distance counts for less
  bool perspective = false;
  // What the picture shows; none of a measure that no camera has made.
  std::optional<View> view{};

  double at_distance(double deviation, double distance) const {
    return deviation * pixels_per_unit / (perspective ? std::max(nearest, distance) : 1.0);
  }
  double at_point(double deviation, const Vec3d& point) const {
    return at_distance(deviation, length(point - eye));
  }
  // An eye inside the box looks at the box from within: what surrounds the eye (a dome, a room) is mostly
  // hollow.
  double in_box(double deviation, const Box3d& box) const;
  // A bit for each side of the picture beyond which the point lies, and one where it lies behind the camera.
  // What lies between points that have a bit in common is not in the picture.
  std::uint8_t sides_beyond(const Vec3d& point) const;
};

class ScreenMeasure {
 public:
  // `camera` as checked by check_camera(); `origin` of the frame's world in stage space.
  ScreenMeasure(const CameraInput& camera, const Vec3d& origin, std::uint32_t width, std::uint32_t height);
  // For a prototype, whose instances are not known yet: as if `box` filled the image.
  static ScreenMeasure filled_by(const Box3d& box, std::uint32_t width, std::uint32_t height);

  // For a prototype of whose instances the one that is seen largest is known.
  static ScreenMeasure constant(double pixels_per_unit);

  ScreenInstant at(double time01) const;
  bool is_still() const { return instants_.size() == 1; }

 private:
  ScreenMeasure() = default;

  std::vector<double> times01_;
  std::vector<ScreenInstant> instants_;
};

}  // namespace msbvh::translate
