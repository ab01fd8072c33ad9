// USD's rule on velocities (UsdGeomPointBased::ComputePointsAtTimes, UsdGeomPointInstancer::
// ComputeInstanceTransformsAtTimes): they count only where their samples align with those of the array that
// they move; then all values come from one base sample, the one at or before the frame, and samples of the
// array are not interpolated.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "delegate/translate/diagnostics.h"
#include "delegate/translate/inputs.h"

namespace msbvh::translate {

// The samples around the frame: `base` is the one that a value at the frame starts from, and on a sample the
// interval after it counts.
struct FrameBracket {
  std::size_t base = 0;
  double lower01 = 0.0, upper01 = 0.0;
};

struct SampleTimes {
  std::vector<double> times01;
  bool timeless = false;
};
SampleTimes times_of(const ArraySamples& samples);
SampleTimes times_of(const QuaternionSamples& samples);

// Nothing for an array without time samples.
std::optional<FrameBracket> frame_bracket(const SampleTimes& times, double frame01);

// One attribute that may move another.
struct RateCheck {
  SampleTimes array, rate;
  std::string array_name, rate_name;
  // Sizes at a sample of the array and of the rate.
  std::size_t array_size = 0, rate_size = 0;
};

// Whether the rate counts, its base sample being that of the array. Says why not, where it is authored.
bool rate_applies(const RateCheck& check, double frame01, PrimLog& log);

// Of a whole set: the sample of `samples` at or before the frame; 0 for a timeless one.
std::size_t base_sample(const SampleTimes& times, double frame01);

}  // namespace msbvh::translate
