// Which inputs of a node make a difference: those that front-ends read.
#include <algorithm>
#include <array>
#include <doctest/doctest.h>
#include <optional>
#include <string>
#include <vector>

#include "delegate/translate/look/displacement.h"
#include "delegate/translate/look/preview_surface.h"
#include "tests/translate/shading_network.h"

using namespace msbvh;
using namespace msbvh::translate;
using namespace msbvh::testing;

namespace {

struct SomeTexture : TextureSource {
  std::optional<ScalarImage> channel(const Asset&, std::string_view, std::size_t) const override {
    return ScalarImage{2, 2, {0.125f, 0.25f, 0.5f, 1.0f}};
  }
};

// All that differs in the tests below.
std::string described(const SurfaceLook& look) {
  const Material& m = look.material;
  std::string all = message(m.specular, m.specular_workflow, m.transparent_reflects);
  for (const Vec3f& color : {m.diffuse_color, m.emissive_color, m.specular_color, m.normal})
    all += message(" ", color.x, " ", color.y, " ", color.z);
  for (const float number :
       {m.metallic, m.roughness, m.ior, m.clearcoat, m.clearcoat_roughness, m.opacity, m.opacity_threshold})
    all += message(" ", number);
  for (const ImageTexture& image : look.textures) {
    all +=
        message("; ", image.name, int(image.wrap_s), int(image.wrap_t), image.color_space, image.fallback[0]);
  }
  for (const TextureRead& read : m.texture_reads)
    all += message("; ", read.scale[0], " ", read.bias[0], " ", read.offset[0], " ",
                   read.fallback_coordinates[0], " ", read.matrix[0], " ", read.matrix[1]);
  for (const NeededPrimvar& primvar : look.primvars) all += "; " + primvar.name;
  return all;
}

// All that a node makes of a surface and of its displacement, and what is said.
std::string outcome(const ShaderNode& node) {
  Network look;
  look.network.terminals["displacement"] = {"/Look/Surface", "displacement"};
  look.surface().inputs = {connected("emissiveColor", "/Look/Node", "rgb"),
                           connected("displacement", "/Look/Node", "r")};
  if (node.identifier == "UsdPreviewSurface") {
    for (auto& [name, terminal] : look.network.terminals) terminal.node = node.path;
  }
  if (node.identifier == "UsdTransform2d") {
    look.surface().inputs.back() = connected("displacement", "/Look/Image", "r");
    look.network.nodes.push_back(
        {"/Look/Image",
         "UsdUVTexture",
         {constant("file", Asset{"wood.png", {"/wood.png"}}), connected("st", "/Look/Node", "result")}});
  }
  look.network.nodes.push_back(node);
  const SomeTexture textures;
  const SurfaceLook surface = *look.read(textures);
  const Material& material = surface.material;
  const Displacement displaced = displacement_of(look.network, textures, look.said).value_or(Displacement{});
  std::string all = message(material.emissive_color.x, " ", material.diffuse_color.x, " ", displaced.constant,
                            " ", displaced.primvar, " ", displaced.scale, " ", displaced.bias);
  for (const auto& [s, t] : {displaced.coordinates.fallback, std::array{1.3, -0.6}}) {
    const auto st = displaced.coordinates.mapped(s, t);
    all += message(" ", st[0], " ", st[1]);
    if (displaced.texture) all += message(" ", displaced.texture->at(st[0], st[1], 0.0, 0.0));
  }
  all += described(surface);
  for (const Diagnostic& d : look.said) all += "; " + d.attribute + ": " + d.message;
  return all;
}

ShaderData unusual_data(const std::string& identifier, const std::string& name) {
  if (name == "file") return Asset{"wood.png", {"/wood.png"}};
  if (name == "varname" || name == "sourceColorSpace") return std::string("raw");
  if (name == "wrapS" || name == "wrapT") return std::string("repeat");
  if (name == "opacityMode") return std::string("presence");
  if (name == "rotation" || name == "displacement") return 0.5;
  constexpr std::string_view kNumbers[] = {"metallic",         "roughness",          "ior",
                                           "clearcoat",        "clearcoatRoughness", "opacity",
                                           "opacityThreshold", "useSpecularWorkflow"};
  if (std::ranges::find(kNumbers, name) != std::end(kNumbers)) return 0.75;
  const bool pair = name == "st" || (identifier == "UsdTransform2d" && name != "fallback");
  return pair ? numbers({0.5, 0.75}) : numbers({0.5, 0.5, 0.5, 0.5});
}

bool differs(const std::string& identifier, const std::string& name) {
  ShaderNode node{"/Look/Node", identifier};
  if (identifier == "UsdUVTexture" && name != "file" && name != "fallback") {
    node.inputs = {constant("file", Asset{"wood.png", {"/wood.png"}})};
  }
  if (name == "specularColor") node.inputs = {constant("useSpecularWorkflow", 1.0)};
  // What is outside in one direction is black, however it wraps in the other.
  if (name == "wrapS") node.inputs.push_back(constant("wrapT", std::string("repeat")));
  if (name == "wrapT") node.inputs.push_back(constant("wrapS", std::string("repeat")));
  const std::string bare = outcome(node);
  node.inputs.push_back(constant(name, unusual_data(identifier, name)));
  return outcome(node) != bare;
}

}  // namespace

// A front-end that reads the listed inputs alone must get what one that reads all gets.
TEST_CASE("of a node's inputs, those that are listed make a difference and others do not") {
  for (const std::string identifier : {"UsdPreviewSurface", "UsdUVTexture", "UsdTransform2d",
                                       "UsdPrimvarReader_float", "UsdPrimvarReader_float3", "Mix"}) {
    CAPTURE(identifier);
    const auto listed = evaluated_inputs(identifier);
    for (const std::string_view name : listed) {
      CAPTURE(std::string(name));
      const bool of_the_surface_itself = identifier == "UsdPreviewSurface" && name == "fallback";
      CHECK(differs(identifier, std::string(name)) != of_the_surface_itself);
    }
    for (const char* other : {"roughness", "st", "wrapS", "in"}) {
      if (std::ranges::count(listed, other) == 0) CHECK_FALSE(differs(identifier, other));
    }
  }
}
