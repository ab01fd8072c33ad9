#include "delegate/translate/smooth_times.h"

#include <algorithm>

#include "delegate/translate/time_layout.h"
#include "delegate/translate/time_samples.h"

namespace msbvh::translate {
namespace {

constexpr std::size_t kCubic = 4;

bool is_breakpoint(std::span<const double> breakpoints01, double time01) {
  const auto at = std::ranges::lower_bound(breakpoints01, time01 - kSameTime);
  return at != breakpoints01.end() && *at <= time01 + kSameTime;
}

// Of the polynomial through samples at four times, at another.
std::array<double, 4> lagrange(std::span<const double> times01, double time01) {
  std::array<double, 4> weight;
  for (std::size_t i = 0; i < kCubic; ++i) {
    weight[i] = 1.0;
    for (std::size_t j = 0; j < kCubic; ++j) {
      if (j != i) weight[i] *= (time01 - times01[j]) / (times01[i] - times01[j]);
    }
  }
  return weight;
}

}  // namespace

SmoothTimes::SmoothTimes(std::span<const double> times01,
                         const std::optional<std::vector<double>>& breakpoints01, bool held)
    : times01_(times01.begin(), times01.end()), held_(held) {
  if (!breakpoints01 || held || times01_.size() < kCubic) return;
  std::vector<double> sorted = *breakpoints01;
  std::ranges::sort(sorted);
  for (std::size_t i = 0; i < times01_.size(); ++i) {
    if (i == 0 || i + 1 == times01_.size() || is_breakpoint(sorted, times01_[i])) ends_.push_back(i);
  }
}

SmoothTimes::Mix SmoothTimes::at(double time01, double within) const {
  const Bracket at = bracket(times01_, held_ ? within : time01, held_);
  if (at.first == at.second || at.w == 0.0) return {at.first, 1, {1.0}};
  const auto after = std::ranges::upper_bound(ends_, at.first);
  if (after != ends_.begin() && after != ends_.end()) {
    const std::size_t begin = *(after - 1), end = *after;
    if (end - begin + 1 >= kCubic) {
      const std::size_t first = std::clamp(at.first == 0 ? 0 : at.first - 1, begin, end + 1 - kCubic);
      return {first, kCubic, lagrange(std::span(times01_).subspan(first, kCubic), time01)};
    }
  }
  return {at.first, 2, {1.0 - at.w, at.w}};
}

}  // namespace msbvh::translate
