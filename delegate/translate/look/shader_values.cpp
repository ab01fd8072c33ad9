#include "delegate/translate/look/shader_values.h"

#include <cstdio>

namespace msbvh::translate {

std::string text(double value) {
  if (std::isnan(value)) return "nan";  // without a sign
  std::array<char, 32> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%g", value);
  return buffer.data();
}
std::string text(const Vec3d& value) {
  return "(" + text(value.x) + ", " + text(value.y) + ", " + text(value.z) + ")";
}

std::optional<double> as_kind_of(const ShaderValue& value, double) {
  const auto* number = std::get_if<double>(&value.data);
  return number ? std::optional(*number) : std::nullopt;
}
std::optional<Vec3d> as_kind_of(const ShaderValue& value, const Vec3d&) {
  const auto found = numbers<3>(value);
  return found ? std::optional(Vec3d{(*found)[0], (*found)[1], (*found)[2]}) : std::nullopt;
}

std::vector<double> numbers_of(const ShaderValue& value) {
  if (const auto* number = std::get_if<double>(&value.data)) return {*number};
  const auto* vector = std::get_if<std::vector<double>>(&value.data);
  return vector ? *vector : std::vector<double>{};
}

std::string text(std::span<const double> values) {
  if (values.size() == 1) return text(values[0]);
  std::string result;
  for (const double value : values) result += (result.empty() ? "(" : ", ") + text(value);
  return result + ")";
}

void warn_of_number(const ShaderValue& found, const ShaderNode& node, std::string_view name,
                    std::size_t expected_count, std::span<const double> instead, const PrimLog& log) {
  constexpr const char* kCounts[] = {"no", "a finite number", "two finite numbers", "three finite numbers",
                                     "four finite numbers"};
  const Origin origin = origin_of(node, *node.input(name));
  log.of_prim(origin.path)
      .warn(origin.attribute,
            "found " + found.text + ", expected " + kCounts[expected_count] + "; taken as " + text(instead));
}

double checked_number(double standard, const ShaderNode& node, std::string_view name, const PrimLog& log) {
  const ShaderValue* value = constant_of(node, name);
  if (!value) return standard;
  const std::optional<double> found = as_kind_of(*value, standard);
  if (found && std::isfinite(*found)) return *found;
  warn_of_number(*value, node, name, 1, {&standard, 1}, log);
  return standard;
}

const ShaderValue* constant_of(const ShaderNode& node, std::string_view name) {
  const ShaderInput* input = node.input(name);
  return input && input->connections.empty() && input->value ? &*input->value : nullptr;
}

std::string text_of(const ShaderNode& node, std::string_view name) {
  const ShaderValue* value = constant_of(node, name);
  const auto* found = value ? std::get_if<std::string>(&value->data) : nullptr;
  return found ? *found : std::string();
}

std::string full_name(std::string_view input) { return "inputs:" + std::string(input); }

Origin origin_of(const ShaderNode& node, const ShaderInput& input) {
  return input.origin.value_or(Origin{node.path, full_name(input.name)});
}

}  // namespace msbvh::translate
