// How far the blur of a track is from the blur of the stage's motion: which of the tracks that are all too
// coarse makes the best picture.
//
// A blurred picture shows how long things are where, not when. So two motions are compared by the
// distributions of their coordinates over the shutter: by the Wasserstein distance of order 1, which in one
// dimension is the mean distance between sorted samples (Villani, "Topics in Optimal Transportation", 2003,
// section 2.2).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <vector>

#include "core/base/vec.h"
#include "delegate/translate/time_layout.h"

namespace msbvh::translate {

inline constexpr std::size_t kBlurTimes = 512;

// Spread evenly over the shutter and met by no period: the golden ratio's multiples.
inline double blur_time01(std::size_t i) {
  const double turns = (double(i) + 0.5) / std::numbers::phi;
  return turns - std::floor(turns);
}

// The segment of a layout that does not repeat in which a time lies, and the place in it; an unused one gives
// way to the next.
struct PlaceInLayout {
  std::uint32_t segment;
  double w;
};
inline PlaceInLayout locate(const TimeLayout& layout, double time01) {
  std::uint32_t i = 0;
  while (i + 1 < layout.segments() && (time01 >= layout.segment(i).end01 || !layout.segment(i).used)) ++i;
  const LayoutSegment segment = layout.segment(i);
  const double w = (time01 - segment.begin01) / (segment.end01 - segment.begin01);
  return {i, std::clamp(w, 0.0, 1.0)};
}

// Of one point, at the same times in both.
inline double blur_distance(std::span<const Vec3d> a, std::span<const Vec3d> b) {
  Vec3d mean;
  std::vector<double> first(a.size()), second(b.size());
  for (int axis = 0; axis < 3; ++axis) {
    std::ranges::transform(a, first.begin(), [axis](const Vec3d& p) { return p[axis]; });
    std::ranges::transform(b, second.begin(), [axis](const Vec3d& p) { return p[axis]; });
    std::ranges::sort(first);
    std::ranges::sort(second);
    for (std::size_t i = 0; i < first.size(); ++i) {
      mean[axis] += std::abs(first[i] - second[i]) / double(first.size());
    }
  }
  return length(mean);
}

}  // namespace msbvh::translate
