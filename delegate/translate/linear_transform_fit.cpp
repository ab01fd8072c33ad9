#include "delegate/translate/linear_transform_fit.h"

#include <algorithm>

#include "core/base/lerp.h"
#include "core/motion/track.h"
#include "delegate/translate/time_samples.h"

namespace msbvh::translate {

LinearTransformFitter::LinearTransformFitter(const TransformTrack& maps, const ScreenMeasure& measure,
                                             const FitSettings& settings)
    : maps_(maps), settings_(settings) {
  for (const double time01 : knots(maps.times01(), 0)) tests_.push_back({time01, measure.at(time01)});
}

Affine3d LinearTransformFitter::track(double time01, std::uint32_t segments) const {
  if (segments == 0) return maps_.at(key_time(0, 0));
  const TrackTime at = locate_key(time01, segments);
  return lerp(maps_.at(key_time(at.key, segments)), maps_.at(key_time(at.key + 1, segments)), at.w);
}

double LinearTransformFitter::error(const BoxCorners& box, std::uint32_t segments, double limit) const {
  double worst = 0.0;
  for (const Test& test : tests_) {
    const Affine3d truth = maps_.at(test.time01);
    const double deviation = largest_distance(box, truth, track(test.time01, segments));
    if (deviation == 0.0) continue;
    worst = std::max(worst, test.screen.in_box(deviation, bounds_of(box, truth)));
    if (worst > limit) break;
  }
  return worst;
}

Fit LinearTransformFitter::fit(const BoxCorners& box) const {
  if (maps_.is_still()) return {};
  return fewest_segments(settings_,
                         [&](std::uint32_t segments, double limit) { return error(box, segments, limit); });
}

void LinearTransformFitter::keys(std::uint32_t segments, Affine3f* keys) const {
  for (std::uint32_t key = 0; key < key_count(segments); ++key) {
    keys[key] = Affine3f(maps_.at(key_time(key, segments)));
  }
}

}  // namespace msbvh::translate
