// How far what is drawn of a mesh strays from its true surface, in pixels: the error that cutting it into
// flat triangles makes, apart from the motion's. Measured where it is asked for.
//
//   polygons (scheme none)          0: they are the surface
//   spheres, cylinders and the like  by a closed form of their number of sides (shape/sides.h)
//   subdivided, drawn refined       refined_stray.h
//   subdivided, drawn as their cage cage_stray.h
//   subdivided and displaced        displaced_stray.h
//
// A distance in the world becomes pixels by ScreenMeasure, as the tolerances do: what is seen at that
// distance moves by no more than so many pixels. What lies outside of the picture as a whole (View::kMargin
// around it) does not count. Distances are taken at the shutter's centre and, where the mesh or the camera
// moves, at both ends.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/base/vec.h"
#include "delegate/translate/inputs.h"
#include "delegate/translate/moving_array.h"
#include "delegate/translate/screen_measure.h"
#include "delegate/translate/tessellation.h"

namespace msbvh::translate {

using TriangleCorners = std::array<Vec3d, 3>;

// A mesh's points, in the world, and the camera at one time.
struct StrayInstant {
  std::vector<Vec3f> pose;
  ScreenInstant screen;
};

// The largest found so far.
class WorstStray {
 public:
  explicit WorstStray(const ScreenInstant& screen) : screen_(screen) {}

  // Of a place off by `distance`, where `in_picture()` says that it counts; asked only where it would.
  template <typename InPicture>
  void add(double distance, const Vec3d& place, const InPicture& in_picture) {
    const double pixels = screen_.at_point(distance, place);
    if (pixels > pixels_ && in_picture()) pixels_ = pixels;
  }
  double pixels() const { return pixels_; }

 private:
  const ScreenInstant& screen_;
  double pixels_ = 0.0;
};

// False where all of the points lie beyond one side of the picture.
template <typename Points>
bool may_be_in_picture(const ScreenInstant& screen, const Points& points) {
  std::uint8_t common = 0xff;
  for (const Vec3d& p : points) common &= screen.sides_beyond(p);
  return common == 0;
}

// When it is looked at; `still`: whether all else is.
std::vector<double> stray_times01(const MovingArray& points, const ScreenMeasure& measure, bool still = true);

// The greatest stray of `drawn`, without displacement. `points`: of the mesh, in the space that `measure`
// knows. Nothing where it is not known: of a surface that is only approximated by the time it comes here
// (MeshInput::stray), or a cage that could not be subdivided.
std::optional<double> stray_pixels(const MeshInput& input, const Tessellation& drawn,
                                   const MovingArray& points, const ScreenMeasure& measure);

}  // namespace msbvh::translate
