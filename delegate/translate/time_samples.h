// Increasing sample times: where an instant lies among them, and which instants a fitted track is tested at.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "delegate/translate/diagnostics.h"

namespace msbvh::translate {

// Between samples `first` and `second` (equal where a sample is held) with weight w in [0, 1] on the second.
struct Bracket {
  std::size_t first, second;
  double w;
};

// Held before the first and after the last time; with `held`, each sample holds until the next one's time.
Bracket bracket(std::span<const double> times01, double time01, bool held = false);

// The samples [first, last] that the open shutter sees: those inside [0, 1] and the bracketing ones. Held
// samples: those in force for more than an instant, so one at 1 does not count.
struct SampleRange {
  std::size_t first, last;
  std::size_t count() const { return last - first + 1; }
};
SampleRange samples_of_shutter(std::span<const double> times01, bool held = false);

// Key `key` of a track: i / segments. A still track shows the shutter's centre.
constexpr double key_time(std::uint32_t key, std::uint32_t segments) {
  return segments == 0 ? 0.5 : double(key) / segments;
}

// core/motion's locate() in double precision.
struct TrackTime {
  std::uint32_t key;
  double w;
};
TrackTime locate_key(double time01, std::uint32_t segments);

// 0, 1, the times inside the shutter and the keys of a track: increasing, without repetition. Between two of
// them a piecewise-linear input and the track are both linear.
std::vector<double> knots(std::span<const double> times01, std::uint32_t segments);

// Where a track with keys at i / segments is compared with an input of these sample times: at the knots and
// the middles between them. A point that moves linearly under a matrix that does so is quadratic between
// knots, and the largest of these three values is then at least 4/5 of its largest deviation (5/4: Lebesgue
// constant of three equidistant nodes). Held samples jump at knots, where no deviation can be told: there
// only the middles count.
std::vector<double> test_times(std::span<const double> times01, std::uint32_t segments, bool held = false);

// At least one, finite and increasing.
bool check_times(std::span<const double> times01, const std::string& attribute, PrimLog& log);

}  // namespace msbvh::translate
