#include "delegate/translate/array_samples.h"

#include <algorithm>

#include "delegate/translate/rates.h"

namespace msbvh::translate {

ArrayTrack::ArrayTrack(const ArraySamples& input) : held_(input.held) {
  const std::vector<double> times01 = times_of(input).times01;
  const SampleRange range = samples_of_shutter(times01, held_);
  for (std::size_t i = range.first; i <= range.last; ++i) {
    times01_.push_back(times01[i]);
    values_.push_back(input.samples[i].values);
  }
}

ArrayTrack::ArrayTrack(const ArraySample& base, std::span<const Vec3f> velocities,
                       std::span<const Vec3f> accelerations, const RateTimes& time_remap)
    : times01_{base.time01},
      values_{base.values},
      velocities_(velocities),
      accelerations_(accelerations),
      time_remap_(time_remap),
      carried_(true) {}

ArrayInstant ArrayTrack::at(double time01, double within) const {
  if (carried_) {
    ArrayInstant instant{values_[0], velocities_, accelerations_};
    instant.dt = (time01 - times01_[0]) * time_remap_.seconds_per_shutter;
    instant.carried = true;
    instant.scale = time_remap_.velocity_scale;
    return instant;
  }
  const Bracket at = bracket(times01_, held_ ? within : time01, held_);
  return {values_[at.first], values_[at.second], {}, at.w};
}

bool ArrayTrack::is_still() const {
  const auto is_zero = [](const Vec3f& v) { return v == Vec3f{}; };
  if (carried_)
    return std::ranges::all_of(velocities_, is_zero) && std::ranges::all_of(accelerations_, is_zero);
  return std::all_of(values_.begin() + 1, values_.end(), [&](std::span<const Vec3f> values) {
    return values.data() == values_.front().data() || std::ranges::equal(values, values_.front());
  });
}

std::vector<Breakpoint> ArrayTrack::breakpoints() const {
  std::vector<Breakpoint> result;
  if (carried_ || is_still()) return result;
  for (const double time01 : times01_) result.push_back({time01, held_});
  return normalized_breakpoints(std::move(result));
}

std::vector<double> ArrayTrack::extreme_times01() const {
  std::vector<double> result{0.0, 1.0};
  if (carried_) result.push_back(0.5);
  for (const double time01 : times01_) {
    if (time01 > 0.0 && time01 < 1.0) result.push_back(time01);
  }
  std::ranges::sort(result);
  return result;
}

bool check_finite(const ArraySample& sample, const std::string& attribute, PrimLog& log) {
  const auto bad = std::ranges::find_if(sample.values, [](const Vec3f& v) { return !is_finite(v); });
  if (bad == sample.values.end()) return true;
  return log.reject(
      attribute, message("value ", bad - sample.values.begin(), " ", at_shutter_time(sample.time01), " is (",
                         bad->x, ", ", bad->y, ", ", bad->z, "); expected finite numbers"));
}

bool check_array(const ArraySamples& input, const std::string& attribute, PrimLog& log) {
  if (!check_times(times_of(input).times01, attribute, log)) return false;
  const std::size_t count = input.samples.front().values.size();
  const auto other = std::ranges::find_if(
      input.samples, [&](const ArraySample& sample) { return sample.values.size() != count; });
  if (other != input.samples.end()) {
    return log.reject(attribute,
                      message("found ", other->values.size(), " values ", at_shutter_time(other->time01),
                              "; expected ", count, " as in the first sample (topology must not change)"));
  }
  const SampleRange seen = samples_of_shutter(times_of(input).times01, input.held);
  return std::ranges::all_of(std::span(input.samples).subspan(seen.first, seen.count()),
                             [&](const ArraySample& sample) { return check_finite(sample, attribute, log); });
}

ArraySamples samples_of_size(const ArraySamples& input, std::size_t base, std::size_t count) {
  const auto fits = [&](std::size_t i) { return input.samples[i].values.size() == count; };
  std::size_t first = base, last = base;
  while (first > 0 && fits(first - 1)) --first;
  while (last + 1 < input.samples.size() && fits(last + 1)) ++last;
  ArraySamples result = input;
  result.samples.assign(input.samples.begin() + std::ptrdiff_t(first),
                        input.samples.begin() + std::ptrdiff_t(last) + 1);
  return result;
}

}  // namespace msbvh::translate
