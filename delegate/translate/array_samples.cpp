#include "delegate/translate/array_samples.h"

#include <algorithm>

namespace msbvh::translate {
namespace {

bool check_values(const ArraySample& sample, std::size_t count, const std::string& attribute, PrimLog& log) {
  if (sample.values.size() != count) {
    return log.reject(attribute,
                      message("found ", sample.values.size(), " values ", at_shutter_time(sample.time01),
                              "; expected ", count, " as in the first sample (topology must not change)"));
  }
  const auto bad =
      std::find_if(sample.values.begin(), sample.values.end(), [](Vec3f v) { return !is_finite(v); });
  if (bad == sample.values.end()) return true;
  return log.reject(
      attribute, message("value ", bad - sample.values.begin(), " ", at_shutter_time(sample.time01), " is (",
                         bad->x, ", ", bad->y, ", ", bad->z, "); expected finite numbers"));
}

}  // namespace

ArrayTrack::ArrayTrack(const ArraySamples& input) : held_(input.held) {
  std::vector<double> times01;
  for (const ArraySample& sample : input.samples) times01.push_back(sample.time01);
  const SampleRange range = samples_of_shutter(times01, held_);
  for (std::size_t i = range.first; i <= range.last; ++i) {
    times01_.push_back(times01[i]);
    values_.push_back(input.samples[i].values);
  }
}

ArrayInstant ArrayTrack::at(double time01) const {
  const Bracket at = bracket(times01_, time01, held_);
  return {values_[at.first], values_[at.second], at.w};
}

bool ArrayTrack::is_still() const {
  return std::all_of(values_.begin() + 1, values_.end(), [&](std::span<const Vec3f> values) {
    return values.data() == values_.front().data() || std::ranges::equal(values, values_.front());
  });
}

bool check_array(const ArraySamples& input, const std::string& attribute, PrimLog& log) {
  std::vector<double> times01;
  for (const ArraySample& sample : input.samples) times01.push_back(sample.time01);
  if (!check_times(times01, attribute, log)) return false;
  return std::all_of(input.samples.begin(), input.samples.end(), [&](const ArraySample& sample) {
    return check_values(sample, input.samples.front().values.size(), attribute, log);
  });
}

}  // namespace msbvh::translate
