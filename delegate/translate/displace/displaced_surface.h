// A mesh's surface displaced along its normals, over the shutter: in the object's space, where distances are
// what the material says, then under the transform.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/vec.h"
#include "delegate/translate/displace/distances.h"
#include "delegate/translate/fit.h"
#include "delegate/translate/moving_array.h"
#include "delegate/translate/screen_measure.h"
#include "delegate/translate/tessellation.h"

namespace msbvh::translate {

class DisplacedSurface {
 public:
  // `points`: of the mesh itself, in the space that the surface is wanted in; `distances` of the points of
  // `faces`. Borrows the first two.
  DisplacedSurface(const MovingArray& points, const Tessellation& faces, PointDistances distances);
  ~DisplacedSurface();

  std::size_t size() const;  // points of the surface
  // As the stage has them at a time, on the side of a jump that `within` is on.
  std::vector<Vec3d> at(double time01, double within) const;
  // Some of them, evenly picked: enough to see how far a track strays.
  std::vector<Vec3d> picked_at(double time01, double within) const;

  bool is_still() const { return points_.is_still() && distances_.is_still(); }
  std::vector<Breakpoint> breakpoints() const;
  std::vector<double> dense_times01() const { return points_.dense_times01(); }
  double error_pixels() const { return points_.transform.error_pixels(); }

 private:
  struct Pick;
  void pick();
  // The mesh's points in the object's space, its origin moved so that floats hold them.
  std::vector<Vec3f> pose(double time01, double within) const;
  Vec3d placed(const Affine3d& map, const Vec3d& point) const { return map.point(point + shift_); }

  const MovingArray& points_;
  const Tessellation& faces_;
  PointDistances distances_;
  Vec3d shift_;
  std::vector<std::unique_ptr<Pick>> picks_;
};

// The cheapest track that follows the surface: its normals turn, so that points do not move as the mesh's
// own do. Of at most so many controls. Error in pixels.
PointFit fit_displaced(const DisplacedSurface& surface, const ScreenMeasure& measure,
                       const FitSettings& settings, std::uint64_t most_controls);
// As point_controls().
std::vector<Vec3f> displaced_controls(const DisplacedSurface& surface, const Candidate& track);

}  // namespace msbvh::translate
