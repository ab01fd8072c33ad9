// Points (or normals) over the shutter as authored: linear between samples, or each sample held until the
// next.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/base/lerp.h"
#include "core/base/vec.h"
#include "delegate/translate/diagnostics.h"
#include "delegate/translate/inputs.h"
#include "delegate/translate/time_samples.h"

namespace msbvh::translate {

// All values at one instant, interpolated on access.
struct ArrayInstant {
  std::span<const Vec3f> first, second;
  double w;  // on the second; 0: both are the same

  std::size_t size() const { return first.size(); }
  Vec3d operator[](std::size_t i) const {
    return w == 0.0 ? Vec3d(first[i]) : lerp(Vec3d(first[i]), Vec3d(second[i]), w);
  }
};

// Borrows the values.
class ArrayTrack {
 public:
  // Keeps what the shutter sees. `samples` must have passed check_array().
  explicit ArrayTrack(const ArraySamples& samples);

  ArrayInstant at(double time01) const;
  // Compares values: an array that does not change over many samples is still.
  bool is_still() const;
  // Whether values jump inside the shutter, which no track with finitely many keys follows.
  bool jumps() const { return held_ && !is_still(); }
  bool held() const { return held_; }
  const std::vector<double>& times01() const { return times01_; }

 private:
  std::vector<double> times01_;
  std::vector<std::span<const Vec3f>> values_;
  bool held_;
};

// Increasing times; as many values in every sample; all of them finite.
bool check_array(const ArraySamples& samples, const std::string& attribute, PrimLog& log);

}  // namespace msbvh::translate
