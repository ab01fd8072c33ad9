// What the inputs of shading nodes hold, read as one kind or another; and how messages print it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/vec.h"
#include "delegate/translate/diagnostics.h"
#include "delegate/translate/look/shader_network.h"

namespace msbvh::translate {

inline constexpr std::string_view kPreviewSurface = "UsdPreviewSurface";
inline constexpr std::string_view kTexture = "UsdUVTexture";
inline constexpr std::string_view kTransform2d = "UsdTransform2d";
inline constexpr std::string_view kPrimvarReader = "UsdPrimvarReader";  // and _ and the type that it reads

// As printf's %g.
std::string text(double value);
std::string text(const Vec3d& value);

// The numbers of a vector that has kSize of them.
template <std::size_t kSize>
std::optional<std::array<double, kSize>> numbers(const ShaderValue& value) {
  const auto* found = std::get_if<std::vector<double>>(&value.data);
  if (!found || found->size() != kSize) return std::nullopt;
  std::array<double, kSize> result{};
  std::ranges::copy(*found, result.begin());
  return result;
}

// A value as the kind of the second argument; none: it is of another kind.
std::optional<double> as_kind_of(const ShaderValue& value, double);
std::optional<Vec3d> as_kind_of(const ShaderValue& value, const Vec3d&);

// Null where the input is not authored, holds none, or is connected.
const ShaderValue* constant_of(const ShaderNode& node, std::string_view name);
// Empty where it is no text.
std::string text_of(const ShaderNode& node, std::string_view name);

// What is not so many finite numbers counts as the standard.
template <std::size_t kSize>
std::array<double, kSize> finite_or(const std::array<double, kSize>& standard, const ShaderValue* value) {
  const auto found = value ? numbers<kSize>(*value) : std::nullopt;
  const bool finite =
      found && std::ranges::all_of(*found, [](double number) { return std::isfinite(number); });
  return finite ? *found : standard;
}

void warn_of_number(const ShaderValue& found, const ShaderNode& node, std::string_view name,
                    std::size_t expected_count, std::span<const double> instead, const PrimLog& log);

// All numbers of a value: one, or a vector's. Empty: it has none.
std::vector<double> numbers_of(const ShaderValue& value);

std::string text(std::span<const double> values);  // "(0, 1)", of one "0"

// An authored number; the standard where there is none or, with a warning, where it is no finite one.
double checked_number(double standard, const ShaderNode& node, std::string_view name, const PrimLog& log);

// Likewise of so many.
template <std::size_t kSize>
std::array<double, kSize> checked_numbers(const std::array<double, kSize>& standard, const ShaderNode& node,
                                          std::string_view name, const PrimLog& log) {
  const ShaderValue* value = constant_of(node, name);
  if (!value) return standard;
  const auto found = numbers<kSize>(*value);
  if (found && std::ranges::all_of(*found, [](double number) { return std::isfinite(number); }))
    return *found;
  warn_of_number(*value, node, name, kSize, standard, log);
  return standard;
}

// Whether the input is connected or, at any time of the shutter, not neutral.
template <typename Kind>
bool has_effect(const ShaderInput& input, const Kind& neutral) {
  if (!input.connections.empty()) return true;
  const auto differs = [&](const std::optional<ShaderValue>& value) {
    return value && as_kind_of(*value, neutral) != neutral;
  };
  return input.in_shutter.empty() ? differs(input.value) : std::ranges::any_of(input.in_shutter, differs);
}

std::string full_name(std::string_view input);  // with inputs:
Origin origin_of(const ShaderNode& node, const ShaderInput& input);

}  // namespace msbvh::translate
