// Interleaved repetitions: in every round each side has its turn, forwards and backwards alternately, so that
// what the machine does meanwhile falls on all of them.
#pragma once

#include <algorithm>
#include <functional>
#include <limits>
#include <vector>

#include "core/base/stopwatch.h"

namespace msbvh::bench {

struct Spread {
  double median = std::numeric_limits<double>::quiet_NaN();
  double low = std::numeric_limits<double>::quiet_NaN(), high = std::numeric_limits<double>::quiet_NaN();
};

inline Spread spread_of(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return {n % 2 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]), values.front(), values.back()};
}

// Seconds of each side in each round: [side][round]. Rounds end early when `limit_seconds` are spent,
// but not before `least`.
inline std::vector<std::vector<double>> interleave(std::size_t sides, int rounds, int least,
                                                   double limit_seconds,
                                                   const std::function<void(std::size_t)>& work) {
  std::vector<std::vector<double>> seconds(sides);
  const Stopwatch whole;
  for (int round = 0; round < rounds && (round < least || whole.seconds() < limit_seconds); ++round) {
    for (std::size_t i = 0; i < sides; ++i) {
      const std::size_t side = round % 2 ? sides - 1 - i : i;
      const Stopwatch watch;
      work(side);
      seconds[side].push_back(watch.seconds());
    }
  }
  return seconds;
}

// How many times as fast `a` is as `b`, from rounds that stand side by side.
inline Spread speed_ratio(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) ratios.push_back(b[i] / a[i]);
  return spread_of(std::move(ratios));
}

}  // namespace msbvh::bench
