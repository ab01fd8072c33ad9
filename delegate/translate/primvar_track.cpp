#include "delegate/translate/primvar_track.h"

#include <algorithm>
#include <cmath>

#include "core/motion/track.h"
#include "delegate/translate/fit.h"
#include "delegate/translate/primvars.h"
#include "delegate/translate/time_samples.h"
#include "delegate/translate/value_track.h"

namespace msbvh::translate {
namespace {

double magnitude(double value) { return std::abs(value); }
double magnitude(const Vec3d& value) {
  return std::max({std::abs(value.x), std::abs(value.y), std::abs(value.z)});
}

template <typename T>
struct Wide;
template <>
struct Wide<float> {
  using Type = double;
};
template <>
struct Wide<Vec3f> {
  using Type = Vec3d;
};

template <typename T>
typename Wide<T>::Type mixed(const PrimvarInput<T>& input, const Mix& mix, std::size_t element) {
  typename Wide<T>::Type sum{};
  for (const Share& share : mix) {
    sum = sum + typename Wide<T>::Type(input.samples[share.sample].values[element]) * share.weight;
  }
  return sum;
}

template <typename T>
bool check_samples(const PrimvarInput<T>& input, std::span<const double> times01,
                   const std::string& attribute, PrimLog& log) {
  const auto held = [&](const std::string& found) {
    log.warn(attribute, found + "; the frame's values are held");
    return false;
  };
  for (std::size_t i = 1; i < times01.size(); ++i) {
    if (!(times01[i] > times01[i - 1])) return held("found sample times that do not increase");
  }
  for (const PrimvarSample<T>& sample : input.samples) {
    if (!std::isfinite(sample.time01)) return held("found a sample time that is not finite");
    if (sample.values.size() != input.values.size()) {
      return held(message("found ", sample.values.size(), " values ", at_shutter_time(sample.time01),
                          "; expected ", input.values.size(), " as at the frame"));
    }
    if (std::ranges::any_of(sample.values, [](const T& value) { return !is_color(value); })) {
      return held(
          message("found a value ", at_shutter_time(sample.time01),
                  " that is not finite or too large; expected finite numbers of at most 65504 in size"));
    }
  }
  return true;
}

template <typename T>
bool is_still(const PrimvarInput<T>& input) {
  return std::ranges::all_of(input.samples, [&](const PrimvarSample<T>& sample) {
    return std::ranges::equal(sample.values, input.samples.front().values);
  });
}

template <typename T>
Keys keys_of(const PrimvarInput<T>& input) {
  for (std::size_t i = 1; i < input.samples.size(); ++i) {
    const PrimvarSample<T>&before = input.samples[i - 1], &after = input.samples[i];
    if (after.time01 - before.time01 > kJumpTime01) continue;
    if (!std::ranges::equal(before.values, after.values)) return Keys::kAveraged;
  }
  return Keys::kSampled;
}

// The largest value, and the largest change between any two samples.
template <typename T>
struct Range {
  double largest = 0.0, spread = 0.0;

  explicit Range(const PrimvarInput<T>& input) {
    const std::span<const T> first = input.samples.front().values;
    double from_first = 0.0;
    for (const PrimvarSample<T>& sample : input.samples) {
      for (std::size_t i = 0; i < first.size(); ++i) {
        const typename Wide<T>::Type value(sample.values[i]);
        largest = std::max(largest, magnitude(value));
        from_first = std::max(from_first, magnitude(value - typename Wide<T>::Type(first[i])));
      }
    }
    spread = 2.0 * from_first;
  }
};

// At every knot, since between them samples and track are linear.
template <typename T>
double largest_difference(const PrimvarInput<T>& input, std::span<const double> times01,
                          std::uint32_t segments, double limit) {
  const std::vector<Mix> keys = key_mixes(times01, segments, Keys::kSampled);
  double worst = 0.0;
  for (const double time01 : knots(times01, segments)) {
    const Mix difference = track_minus_samples(keys, times01, time01);
    if (difference.empty()) continue;
    for (std::size_t i = 0; i < input.values.size(); ++i) {
      worst = std::max(worst, magnitude(mixed(input, difference, i)));
    }
    if (worst > limit) break;
  }
  return worst;
}

// A bound on what comes too early or too late: the weights of the difference sum to 0, so that it is at most
// half their absolute sum times the spread. No pass over the values for every number of segments.
double largest_shift(double spread, std::span<const double> times01, std::uint32_t segments) {
  const std::vector<Mix> keys = key_mixes(times01, segments, Keys::kAveraged);
  std::vector<Deviation> shifts(times01.size(), Deviation(Keys::kAveraged));
  for (const double time01 : knots(times01, segments)) {
    std::vector<double> weights(times01.size(), 0.0);
    for (const Share& share : track_minus_samples(keys, times01, time01))
      weights[share.sample] = share.weight;
    for (std::size_t i = 0; i < weights.size(); ++i) shifts[i].add(time01, {weights[i], 0.0, 0.0});
  }
  double sum = 0.0;
  for (const Deviation& shift : shifts) sum += shift.largest();
  return 0.5 * sum * spread;
}

template <typename T>
PrimvarTrack<T> held(const PrimvarInput<T>& input) {
  return {0, {input.values.begin(), input.values.end()}};
}

}  // namespace

template <typename T>
PrimvarTrack<T> fit_primvar(const PrimvarInput<T>& input, std::uint32_t max_segments,
                            const std::string& attribute, PrimLog& log) {
  std::vector<double> times01;
  for (const PrimvarSample<T>& sample : input.samples) times01.push_back(sample.time01);
  if (times01.empty() || !check_samples(input, times01, attribute, log)) return held(input);
  if (is_still(input)) return {0, {input.samples[0].values.begin(), input.samples[0].values.end()}};

  const Keys keys = keys_of(input);
  const Range<T> range(input);
  const double tolerance = input.tolerance * std::max(1.0, range.largest);
  const Fit fit = fewest_segments({tolerance, max_segments}, [&](std::uint32_t segments, double limit) {
    return keys == Keys::kAveraged ? largest_shift(range.spread, times01, segments)
                                   : largest_difference(input, times01, segments, limit);
  });
  if (fit.error > tolerance) {
    log.warn(attribute, message("the values deviate by ", fit.error, " at ", fit.segments,
                                " segments; expected at most ", tolerance));
  }
  PrimvarTrack<T> track{fit.segments, {}};
  for (const Mix& mix : key_mixes(times01, fit.segments, keys)) {
    for (std::size_t i = 0; i < input.values.size(); ++i) track.values.push_back(T(mixed(input, mix, i)));
  }
  return track;
}

template PrimvarTrack<Vec3f> fit_primvar(const PrimvarInput<Vec3f>&, std::uint32_t, const std::string&,
                                         PrimLog&);
template PrimvarTrack<float> fit_primvar(const PrimvarInput<float>&, std::uint32_t, const std::string&,
                                         PrimLog&);

}  // namespace msbvh::translate
