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
