#include "delegate/hydra/typed_values.h"

#include <optional>
#include <pxr/base/gf/quatf.h>
#include <pxr/base/gf/quath.h>
#include <pxr/base/gf/vec2d.h>
#include <pxr/base/gf/vec2f.h>
#include <pxr/base/gf/vec2h.h>
#include <pxr/base/gf/vec3d.h>
#include <pxr/base/gf/vec3h.h>

namespace msbvh::hydra {
namespace {

using translate::message;
using translate::Severity;

template <typename To, typename From, typename Convert>
std::optional<To> converted(const VtValue& value, const Convert& convert) {
  if (!value.IsHolding<VtArray<From>>()) return std::nullopt;
  To result;
  const VtArray<From>& from = value.UncheckedGet<VtArray<From>>();
  result.reserve(from.size());
  for (const From& each : from) result.push_back(convert(each));
  return result;
}

template <typename Array>
std::optional<Array> one_or_all(const VtValue& value) {
  using Element = typename Array::value_type;
  if (value.IsHolding<Array>()) return value.UncheckedGet<Array>();
  if (value.IsHolding<Element>()) return Array(1, value.UncheckedGet<Element>());
  return std::nullopt;
}

template <typename Array>
std::optional<Array> as(const VtValue& value);

template <>
std::optional<VtVec3fArray> as(const VtValue& value) {
  if (auto found = one_or_all<VtVec3fArray>(value)) return found;
  const auto three = [](const auto& v) { return GfVec3f(float(v[0]), float(v[1]), float(v[2])); };
  const auto two = [](const auto& v) { return GfVec3f(float(v[0]), float(v[1]), 0.0f); };
  const auto one = [](const auto& v) { return GfVec3f(float(v), 0.0f, 0.0f); };
  if (auto found = converted<VtVec3fArray, GfVec3d>(value, three)) return found;
  if (auto found = converted<VtVec3fArray, GfVec3h>(value, three)) return found;
  if (auto found = converted<VtVec3fArray, GfVec2f>(value, two)) return found;
  if (auto found = converted<VtVec3fArray, GfVec2d>(value, two)) return found;
  if (auto found = converted<VtVec3fArray, GfVec2h>(value, two)) return found;
  if (auto found = converted<VtVec3fArray, float>(value, one)) return found;
  if (auto found = converted<VtVec3fArray, double>(value, one)) return found;
  return converted<VtVec3fArray, int>(value, one);
}

template <>
std::optional<VtFloatArray> as(const VtValue& value) {
  if (auto found = one_or_all<VtFloatArray>(value)) return found;
  const auto number = [](const auto& v) { return float(v); };
  if (auto found = converted<VtFloatArray, double>(value, number)) return found;
  return converted<VtFloatArray, GfHalf>(value, number);
}

template <>
std::optional<VtQuatfArray> as(const VtValue& value) {
  if (auto found = one_or_all<VtQuatfArray>(value)) return found;
  return converted<VtQuatfArray, GfQuath>(value, [](const GfQuath& q) { return GfQuatf(q); });
}

template <typename Array>
const char* expected_name();
template <>
const char* expected_name<VtVec3fArray>() {
  return "up to three numbers each";
}
template <>
const char* expected_name<VtFloatArray>() {
  return "numbers";
}
template <>
const char* expected_name<VtQuatfArray>() {
  return "quaternions";
}

}  // namespace

template <typename Array>
TypedValues<Array> typed(const TimedValues& found, const Shutter& shutter, const std::string& path,
                         const std::string& attribute, Diagnostics& diagnostics) {
  TypedValues<Array> result;
  if (found.empty()) return result;
  const auto reject = [&](const VtValue& value) {
    diagnostics.push_back(
        {Severity::kWarning, path, attribute,
         message("found ", value.GetTypeName(), ", expected ", expected_name<Array>(), "; it is left out")});
    return TypedValues<Array>{};
  };
  const VtValue& frame = found.at_frame.IsEmpty() ? found.values.front() : found.at_frame;
  const std::optional<Array> at_frame = as<Array>(frame);
  if (!at_frame) return reject(frame);
  result.at_frame = *at_frame;
  result.indices = found.indices_at_frame;
  result.varies = found.varies;
  for (std::size_t i = 0; i < found.values.size(); ++i) {
    const std::optional<Array> array = as<Array>(found.values[i]);
    if (!array) return reject(found.values[i]);
    const double time01 = shutter.time01(double(found.offsets[i]));
    if (result.samples.empty() || time01 > result.samples.back().first)
      result.samples.emplace_back(time01, *array);
  }
  result.held = found.held;
  for (const auto& [offset, indices] : found.indices) {
    const double time01 = shutter.time01(double(offset));
    TimedInts& held = result.held_indices;
    if (held.empty() || (time01 > held.back().first && indices != held.back().second))
      held.emplace_back(time01, indices);
  }
  if (result.held_indices.size() < 2) result.held_indices.clear();
  return result;
}

template TypedValues<VtVec3fArray> typed(const TimedValues&, const Shutter&, const std::string&,
                                         const std::string&, Diagnostics&);
template TypedValues<VtFloatArray> typed(const TimedValues&, const Shutter&, const std::string&,
                                         const std::string&, Diagnostics&);
template TypedValues<VtQuatfArray> typed(const TimedValues&, const Shutter&, const std::string&,
                                         const std::string&, Diagnostics&);

translate::ArraySamples array_samples(const TypedValues<VtVec3fArray>& values) {
  translate::ArraySamples result;
  result.held = values.held;
  for (const auto& [time01, array] : values.samples) result.samples.push_back({time01, span_of(array)});
  return result;
}

translate::QuaternionSamples quaternion_samples(const TypedValues<VtQuatfArray>& values) {
  translate::QuaternionSamples result;
  result.held = values.held;
  for (const auto& [time01, array] : values.samples) result.samples.push_back({time01, span_of(array)});
  return result;
}

std::string interpolation_name(HdInterpolation interpolation) {
  switch (interpolation) {
    case HdInterpolationUniform:
      return "uniform";
    case HdInterpolationVarying:
      return "varying";
    case HdInterpolationVertex:
      return "vertex";
    case HdInterpolationFaceVarying:
      return "faceVarying";
    default:
      return "constant";
  }
}

}  // namespace msbvh::hydra
