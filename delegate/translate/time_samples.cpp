#include "delegate/translate/time_samples.h"

#include <algorithm>
#include <cmath>

namespace msbvh::translate {

Bracket bracket(std::span<const double> times01, double time01, bool held) {
  const auto after = std::upper_bound(times01.begin(), times01.end(), time01);
  const std::size_t second = std::size_t(after - times01.begin());
  if (second == 0) return {0, 0, 0.0};
  const std::size_t first = second - 1;
  if (held || second == times01.size() || times01[first] == time01) return {first, first, 0.0};
  return {first, second, (time01 - times01[first]) / (times01[second] - times01[first])};
}

SampleRange samples_of_shutter(std::span<const double> times01, bool held) {
  const std::size_t first = bracket(times01, 0.0).first;
  if (!held) return {first, bracket(times01, 1.0).second};
  const auto close = std::lower_bound(times01.begin(), times01.end(), 1.0);
  return {first, std::max(first, std::size_t(close - times01.begin()) - (close == times01.begin() ? 0 : 1))};
}

TrackTime locate_key(double time01, std::uint32_t segments) {
  if (segments == 0) return {0, 0.0};
  const double scaled = time01 * segments;
  const std::uint32_t key = std::min(std::uint32_t(scaled), segments - 1);
  return {key, scaled - key};
}

std::vector<double> knots(std::span<const double> times01, std::uint32_t segments) {
  std::vector<double> result{0.0, 1.0};
  for (std::uint32_t key = 1; key < segments; ++key) result.push_back(double(key) / segments);
  for (const double time01 : times01) {
    if (time01 > 0.0 && time01 < 1.0) result.push_back(time01);
  }
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

std::vector<double> test_times(std::span<const double> times01, std::uint32_t segments, bool held) {
  const std::vector<double> ends = knots(times01, segments);
  std::vector<double> result;
  for (std::size_t i = 1; i < ends.size(); ++i) result.push_back(0.5 * (ends[i - 1] + ends[i]));
  if (!held) result.insert(result.end(), ends.begin(), ends.end());
  return result;
}

bool check_times(std::span<const double> times01, const std::string& attribute, PrimLog& log) {
  if (times01.empty()) return log.reject(attribute, "no samples; expected at least one");
  for (std::size_t i = 0; i < times01.size(); ++i) {
    if (!std::isfinite(times01[i])) {
      return log.reject(attribute,
                        message("sample ", i, " is at time ", times01[i], "; expected a finite time"));
    }
    if (i > 0 && times01[i] <= times01[i - 1]) {
      return log.reject(attribute, message("sample ", i, " is at time ", times01[i], " after one at ",
                                           times01[i - 1], "; expected increasing times"));
    }
  }
  return true;
}

}  // namespace msbvh::translate
