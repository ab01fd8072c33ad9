#include "delegate/translate/transform_fit.h"

#include <algorithm>

#include "core/base/lerp.h"
#include "core/motion/track.h"
#include "delegate/translate/time_samples.h"

namespace msbvh::translate {

TransformFitter::TransformFitter(std::span<const double> times01, const ScreenMeasure& measure,
                                 const FitSettings& settings)
    : times01_(times01.begin(), times01.end()), settings_(settings) {
  for (const double time01 : knots(times01, 0)) tests_.push_back({time01, measure.at(time01)});
}

Affine3d TransformFitter::sample(std::span<const Affine3d> maps, double time01) const {
  const Bracket at = bracket(times01_, time01);
  return at.first == at.second ? maps[at.first] : lerp(maps[at.first], maps[at.second], at.w);
}

Affine3d TransformFitter::track(std::span<const Affine3d> maps, double time01, std::uint32_t segments) const {
  if (segments == 0) return sample(maps, key_time(0, 0));
  const TrackTime at = locate_key(time01, segments);
  return lerp(sample(maps, key_time(at.key, segments)), sample(maps, key_time(at.key + 1, segments)), at.w);
}

double TransformFitter::error(std::span<const Affine3d> maps, const BoxCorners& box, std::uint32_t segments,
                              double limit) const {
  double worst = 0.0;
  for (const Test& test : tests_) {
    const Affine3d truth = sample(maps, test.time01);
    const double deviation = largest_distance(box, truth, track(maps, test.time01, segments));
    if (deviation == 0.0) continue;
    worst = std::max(worst, test.screen.in_box(deviation, bounds_of(box, truth)));
    if (worst > limit) break;
  }
  return worst;
}

Fit TransformFitter::fit(std::span<const Affine3d> maps, const BoxCorners& box) const {
  if (std::all_of(maps.begin(), maps.end(), [&](const Affine3d& map) { return map == maps.front(); }))
    return {};
  return fewest_segments(
      settings_, [&](std::uint32_t segments, double limit) { return error(maps, box, segments, limit); });
}

void TransformFitter::keys(std::span<const Affine3d> maps, std::uint32_t segments, Affine3f* keys) const {
  for (std::uint32_t key = 0; key < key_count(segments); ++key) {
    keys[key] = Affine3f(sample(maps, key_time(key, segments)));
  }
}

}  // namespace msbvh::translate
