// Values of the type that is expected, and how the translator sees them. What is of another type counts as
// none, with a warning that names the prim, the attribute, what was found and what is expected.
#pragma once

#include <pxr/base/vt/array.h>
#include <pxr/base/vt/types.h>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "delegate/hydra/timed_values.h"
#include "delegate/translate/diagnostics.h"
#include "delegate/translate/inputs.h"

namespace msbvh::hydra {

using Diagnostics = std::vector<translate::Diagnostic>;

static_assert(sizeof(GfVec3f) == sizeof(Vec3f) && sizeof(GfQuatf) == sizeof(translate::Quatf));

inline std::span<const int> span_of(const VtIntArray& values) { return {values.cdata(), values.size()}; }
inline std::span<const float> span_of(const VtFloatArray& values) { return {values.cdata(), values.size()}; }
inline std::span<const Vec3f> span_of(const VtVec3fArray& values) {
  return {reinterpret_cast<const Vec3f*>(values.cdata()), values.size()};
}
// Quaternions lie as imaginary part, then real one.
inline std::span<const translate::Quatf> span_of(const VtQuatfArray& values) {
  return {reinterpret_cast<const translate::Quatf*>(values.cdata()), values.size()};
}

// Samples of one type.
template <typename Array>
struct TypedValues {
  Array at_frame{};
  VtIntArray indices{};                             // at the frame; none where it is not indexed
  std::vector<std::pair<double, Array>> samples{};  // time01, increasing; one at least where authored
  TimedInts held_indices{};                         // none where the frame's hold throughout
  bool varies = false, held = false;                // held: each sample until the next

  bool authored() const { return !samples.empty(); }
};

// Where nothing draws a shape in parts for its sake: the frame's values in place of steps, with a warning.
template <typename Array>
void hold_frame(TypedValues<Array>& values, const std::string& path, const std::string& attribute,
                Diagnostics& diagnostics) {
  if (!values.held && values.held_indices.empty()) return;
  diagnostics.push_back({translate::Severity::kWarning, path, attribute,
                         "changes in steps within the shutter; held the frame's values"});
  values.samples.assign(1, {0.0, values.at_frame});
  values.held_indices.clear();
  values.varies = values.held = false;
}

// Texture coordinates and numbers padded to three, numbers in other precisions converted.
template <typename Array>
TypedValues<Array> typed(const TimedValues& found, const Shutter& shutter, const std::string& path,
                         const std::string& attribute, Diagnostics& diagnostics);

extern template TypedValues<VtVec3fArray> typed(const TimedValues&, const Shutter&, const std::string&,
                                                const std::string&, Diagnostics&);
extern template TypedValues<VtFloatArray> typed(const TimedValues&, const Shutter&, const std::string&,
                                                const std::string&, Diagnostics&);
extern template TypedValues<VtQuatfArray> typed(const TimedValues&, const Shutter&, const std::string&,
                                                const std::string&, Diagnostics&);

// The translator's forms; they borrow.
translate::ArraySamples array_samples(const TypedValues<VtVec3fArray>& values);
translate::QuaternionSamples quaternion_samples(const TypedValues<VtQuatfArray>& values);
template <typename T, typename Array>
translate::PrimvarInput<T> primvar_input(const TypedValues<Array>& values, std::string interpolation) {
  translate::PrimvarInput<T> result;
  result.interpolation = std::move(interpolation);
  if (!values.authored()) return result;
  result.values = span_of(values.at_frame);
  result.indices = span_of(values.indices);
  for (const auto& [time01, array] : values.samples) {
    if (values.varies) result.samples.push_back({time01, span_of(array)});
  }
  return result;
}

// USD's token.
std::string interpolation_name(HdInterpolation interpolation);

}  // namespace msbvh::hydra
