#include "delegate/translate/rates.h"

#include <algorithm>
#include <cmath>

namespace msbvh::translate {
namespace {

// UsdTimeCode::SafeStep() is of this order for all times that occur; on a sample the next interval counts.
constexpr double kSafeStep = 1e-6;
constexpr double kSame = 1e-9;

bool same(double a, double b) { return std::abs(a - b) <= kSame * std::max(1.0, std::abs(a)); }

}  // namespace

SampleTimes times_of(const ArraySamples& samples) {
  SampleTimes times{{}, samples.timeless};
  for (const ArraySample& sample : samples.samples) times.times01.push_back(sample.time01);
  return times;
}

SampleTimes times_of(const QuaternionSamples& samples) {
  SampleTimes times{{}, samples.timeless};
  for (const QuaternionSample& sample : samples.samples) times.times01.push_back(sample.time01);
  return times;
}

std::size_t base_sample(const SampleTimes& times, double frame01) {
  const auto after = std::ranges::upper_bound(times.times01, frame01 + kSame);
  return after == times.times01.begin() ? 0 : std::size_t(after - times.times01.begin()) - 1;
}

std::optional<FrameBracket> frame_bracket(const SampleTimes& times, double frame01) {
  if (times.timeless || times.times01.empty()) return std::nullopt;
  const std::vector<double>& t = times.times01;
  FrameBracket bracket{base_sample(times, frame01), t.front(), t.front()};
  if (frame01 + kSafeStep < t.front()) return bracket;
  bracket.lower01 = t[bracket.base];
  bracket.upper01 = t[std::min(bracket.base + 1, t.size() - 1)];
  return bracket;
}

bool rate_applies(const RateCheck& check, double frame01, PrimLog& log) {
  if (check.rate.times01.empty() || check.rate_size == 0) return false;
  if (check.array_size == 0) return false;  // what is missing is the array; whoever reads it says so
  const std::optional<FrameBracket> array = frame_bracket(check.array, frame01);
  const std::optional<FrameBracket> rate = frame_bracket(check.rate, frame01);
  if (!array || !rate || !same(array->lower01, rate->lower01) || !same(array->upper01, rate->upper01)) {
    log.warn(check.rate_name,
             message("not used: the samples do not align with those of ", check.array_name, " (USD's rule)"));
    return false;
  }
  if (check.rate_size != check.array_size) {
    log.warn(check.rate_name, message("not used: found ", check.rate_size, " values, expected ",
                                      check.array_size, ", as many as ", check.array_name));
    return false;
  }
  return true;
}

}  // namespace msbvh::translate
