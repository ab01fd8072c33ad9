// Points (or normals, positions, scales) over the shutter: interpolated between samples, each sample held
// until the next, or carried from one base sample by velocities and accelerations.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/base/lerp.h"
#include "core/base/vec.h"
#include "delegate/translate/diagnostics.h"
#include "delegate/translate/inputs.h"
#include "delegate/translate/time_layout.h"
#include "delegate/translate/time_samples.h"

namespace msbvh::translate {

// All values at one instant, computed on access: first + second * dt + third * dt^2 / 2 where rates carry
// them, else interpolated.
struct ArrayInstant {
  std::span<const Vec3f> first, second, third;
  double w = 0.0;  // of the second in interpolation; 0: both are the same
  double dt = 0.0;
  bool carried = false;

  std::size_t size() const { return first.size(); }
  Vec3d operator[](std::size_t i) const {
    if (!carried) return w == 0.0 ? Vec3d(first[i]) : lerp(Vec3d(first[i]), Vec3d(second[i]), w);
    if (second.empty()) return Vec3d(first[i]);  // held: only the orientations are carried
    Vec3d rate = Vec3d(second[i]) * scale;
    if (!third.empty()) rate += Vec3d(third[i]) * (0.5 * dt);
    return Vec3d(first[i]) + rate * dt;
  }
  double scale = 1.0;  // of the second
};

// Borrows the values.
class ArrayTrack {
 public:
  // Keeps what the shutter sees. `samples` must have passed check_array().
  explicit ArrayTrack(const ArraySamples& samples);
  // Carried from the base sample, `velocities` and `accelerations` (may be empty) being as many.
  ArrayTrack(const ArraySample& base, std::span<const Vec3f> velocities, std::span<const Vec3f> accelerations,
             const RateTimes& time_remap);

  // `within` is a time on the side of a jump that is meant, between the same two jumps as `time01`.
  ArrayInstant at(double time01, double within) const;
  ArrayInstant at(double time01) const { return at(time01, time01); }
  // Compares values: an array that does not change over many samples is still.
  bool is_still() const;
  bool held() const { return held_; }
  bool carried() const { return carried_; }
  std::size_t size() const { return values_.front().size(); }
  // The samples that are kept.
  const std::vector<double>& times01() const { return times01_; }
  std::span<const Vec3f> values(std::size_t sample) const { return values_[sample]; }
  // Where interpolation has breakpoints or, held, jumps.
  std::vector<Breakpoint> breakpoints() const;
  // 0, 1, and the samples between: what a hull of the values needs.
  std::vector<double> extreme_times01() const;

 private:
  std::vector<double> times01_;
  std::vector<std::span<const Vec3f>> values_;
  std::span<const Vec3f> velocities_, accelerations_;
  RateTimes time_remap_;
  bool held_ = false;
  bool carried_ = false;
};

// Increasing times; as many values in every sample; finite ones in those that the shutter sees.
bool check_array(const ArraySamples& samples, const std::string& attribute, PrimLog& log);
bool check_finite(const ArraySample& sample, const std::string& attribute, PrimLog& log);

// USD's choice among the samples of an array that `count` values are wanted of, in the order of the samples:
// the base sample at the frame and its neighbours as far as they have as many values. Beyond them the last
// one holds. One sample, where that is all that USD would take.
ArraySamples samples_of_size(const ArraySamples& samples, std::size_t base, std::size_t count);

}  // namespace msbvh::translate
