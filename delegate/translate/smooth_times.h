// Interpolation between samples of a transform that lie on curves between breakpoints.
//
// Between two breakpoints motion is smooth and its samples lie evenly: the cubic through the four around a
// time errs by the fourth power of their distance, so that a turn takes dozens of samples and not thousands.
// Where a stretch has fewer than four samples, or samples are breakpoints themselves, straight lines say what
// the stage says.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/base/affine.h"

namespace msbvh::translate {

class SmoothTimes {
 public:
  // Increasing times; `breakpoints01` not given: every sample is one. `held`: each sample holds until the
  // next.
  SmoothTimes(std::span<const double> times01, const std::optional<std::vector<double>>& breakpoints01,
              bool held);

  // A weighted sum of `count` neighbouring samples, the first of them number `first`; held outside all times.
  struct Mix {
    std::size_t first = 0, count = 1;
    std::array<double, 4> weight{1.0, 0.0, 0.0, 0.0};
  };
  // `within` is a time on the side of a jump that is meant.
  Mix at(double time01, double within) const;

 private:
  std::vector<double> times01_;
  std::vector<std::size_t> ends_;  // samples that a stretch begins or ends at, increasing; empty: all of them
  bool held_;
};

// `map(i)` gives sample i.
template <typename Maps>
Affine3d mixed(const SmoothTimes::Mix& mix, const Maps& map) {
  if (mix.count == 1) return map(mix.first);
  Affine3d sum{{}, {}, {}, {}};
  for (std::size_t i = 0; i < mix.count; ++i) {
    const Affine3d m = map(mix.first + i);
    const double w = mix.weight[i];
    sum = {sum.x + m.x * w, sum.y + m.y * w, sum.z + m.z * w, sum.t + m.t * w};
  }
  return sum;
}

}  // namespace msbvh::translate
