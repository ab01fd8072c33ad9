#include "delegate/translate/stray/stray.h"

#include <algorithm>
#include <cmath>

#include "core/base/stretch.h"
#include "delegate/translate/stray/cage_stray.h"
#include "delegate/translate/stray/refined_stray.h"

namespace msbvh::translate {
namespace {

StrayInstant instant_at(const MovingArray& points, const ScreenMeasure& measure, double time01) {
  const Affine3d map = points.transform.at(time01, time01);
  const ArrayInstant values = points.values.at(time01, time01);
  StrayInstant instant{{}, measure.at(time01)};
  instant.pose.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) instant.pose.push_back(Vec3f(map.point(values[i])));
  return instant;
}

// Of a shape that strays by so much in its own space, where it is seen largest.
double stray_of_shape(double distance, const MovingArray& points, const ScreenMeasure& measure,
                      const std::vector<double>& times01) {
  double worst = 0.0;
  for (const double time01 : times01) {
    const Affine3d map = points.transform.at(time01, time01);
    const StrayInstant instant = instant_at(points, measure, time01);
    const std::vector<Vec3d> pose(instant.pose.begin(), instant.pose.end());
    if (!may_be_in_picture(instant.screen, pose)) continue;
    for (const Vec3d& p : pose)
      worst = std::max(worst, instant.screen.at_point(distance * largest_stretch(map), p));
  }
  return worst;
}

}  // namespace

std::vector<double> stray_times01(const MovingArray& points, const ScreenMeasure& measure, bool still) {
  if (still && points.is_still() && measure.is_still()) return {0.5};
  return {0.0, 0.5, 1.0};
}

std::optional<double> stray_pixels(const MeshInput& input, const Tessellation& drawn,
                                   const MovingArray& points, const ScreenMeasure& measure) {
  if (std::isnan(input.stray)) return std::nullopt;
  const std::vector<double> times01 = stray_times01(points, measure);
  if (input.stray > 0.0) return stray_of_shape(input.stray, points, measure, times01);
  if (input.subdivision.scheme == "none") return 0.0;
  std::vector<StrayInstant> instants;
  for (const double time01 : times01) instants.push_back(instant_at(points, measure, time01));
  if (const Refinement* refinement = drawn.refinement()) return refined_stray(*refinement->mesh, instants);
  return cage_stray(input, drawn.polygons(), points.size(), instants);
}

}  // namespace msbvh::translate
