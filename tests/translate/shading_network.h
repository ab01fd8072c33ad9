// UsdPreviewSurface networks built by hand, for tests of what they mean.
#pragma once

#include <algorithm>
#include <initializer_list>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "delegate/translate/look/preview_surface.h"

namespace msbvh::testing {

using namespace msbvh::translate;

inline ShaderInput constant(std::string name, ShaderData data, std::string text = "?") {
  return {std::move(name), ShaderValue{std::move(data), std::move(text), "type"}};
}
inline ShaderInput connected(std::string name, std::string node, std::string output) {
  ShaderInput input{std::move(name)};
  input.connections = {{std::move(node), std::move(output)}};
  return input;
}
inline std::vector<double> numbers(std::initializer_list<double> values) { return values; }

struct Network {
  ShaderNetwork network{
      "/Look", {{"/Look/Surface", "UsdPreviewSurface"}}, {{"surface", {"/Look/Surface", "surface"}}}};
  std::vector<Diagnostic> said;

  ShaderNode& surface() { return network.nodes.front(); }
  ShaderNode& add(std::string name, std::string identifier, std::vector<ShaderInput> inputs = {}) {
    network.nodes.push_back({"/Look/" + std::move(name), std::move(identifier), std::move(inputs)});
    return network.nodes.back();
  }
  std::optional<SurfaceLook> read(const TextureSource& textures = {}) {
    said.clear();
    return preview_surface(network, textures, said);
  }
  Material material() { return read()->material; }
  // How many warnings say so.
  std::size_t warnings(const std::string& text = "") const {
    return std::size_t(std::ranges::count_if(said, [&](const Diagnostic& d) {
      return d.severity == Severity::kWarning &&
             (d.attribute + ": " + d.message).find(text) != std::string::npos;
    }));
  }
};

// Null: it is constant.
inline const DrivenInput* driven(const Material& material, SurfaceInput input) {
  const auto found = std::ranges::find(material.driven, input, &DrivenInput::input);
  return found == material.driven.end() ? nullptr : &*found;
}

}  // namespace msbvh::testing
