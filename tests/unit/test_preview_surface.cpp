// UsdPreviewSurface networks, built by hand: what their inputs are drawn as, and what is said of the rest.
#include <algorithm>
#include <array>
#include <doctest/doctest.h>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "delegate/translate/look/displacement.h"
#include "delegate/translate/look/preview_surface.h"

using namespace msbvh;
using namespace msbvh::translate;

namespace {

class NoTexture : public TextureSource {
 public:
  std::optional<Rgba> mean(const Asset&, std::string_view) const override { return std::nullopt; }
};
class OneTexture : public TextureSource {
 public:
  std::optional<Rgba> mean(const Asset& asset, std::string_view space) const override {
    CHECK(asset.path == "wood.png");
    CHECK(space == "raw");
    return Rgba{0.1, 0.2, 0.3, 0.4};
  }
};

ShaderInput constant(std::string name, ShaderData data, std::string text = "?") {
  return {std::move(name), ShaderValue{std::move(data), std::move(text), "type"}};
}
ShaderInput connected(std::string name, std::string node, std::string output) {
  ShaderInput input{std::move(name)};
  input.connections = {{std::move(node), std::move(output)}};
  return input;
}
std::vector<double> numbers(std::initializer_list<double> values) { return values; }

struct Network {
  ShaderNetwork network{
      "/Look", {{"/Look/Surface", "UsdPreviewSurface"}}, {{"surface", {"/Look/Surface", "surface"}}}};
  std::vector<Diagnostic> said;

  ShaderNode& surface() { return network.nodes.front(); }
  std::optional<Material> read(const TextureSource& textures = NoTexture()) {
    said.clear();
    return preview_surface(network, textures, said);
  }
  // How many warnings say so.
  std::size_t warnings(const std::string& text = "") const {
    return std::size_t(std::ranges::count_if(said, [&](const Diagnostic& d) {
      return d.severity == Severity::kWarning &&
             (d.attribute + ": " + d.message).find(text) != std::string::npos;
    }));
  }
};

}  // namespace

TEST_CASE("a surface without inputs has the specification's defaults, and one note") {
  Network look;
  const Material material = *look.read();
  CHECK(material.name == "/Look");
  CHECK(material.diffuse_color == Vec3f{0.18f, 0.18f, 0.18f});
  CHECK(material.emissive_color == Vec3f{});
  CHECK(material.opacity == 1.0f);
  CHECK(material.opacity_threshold == 0.0f);
  REQUIRE(look.said.size() == 1);
  CHECK(look.said.front().severity == Severity::kNote);
  CHECK(look.said.front().in_common);
}

TEST_CASE("constants are taken as they are; another kind is named and the default stands for it") {
  Network look;
  look.surface().inputs = {constant("diffuseColor", numbers({0.1, 0.2, 0.3})), constant("opacity", 0.5),
                           constant("opacityThreshold", 0.25)};
  const Material material = *look.read();
  CHECK(material.diffuse_color == Vec3f{0.1f, 0.2f, 0.3f});
  CHECK(material.opacity == 0.5f);
  CHECK(material.opacity_threshold == 0.25f);
  CHECK(look.warnings() == 0);

  look.surface().inputs = {
      constant("diffuseColor", 0.5, "0.5"), constant("opacity", std::string("half"), "'half'"),
      constant("emissiveColor", numbers({1.0, 2.0}), "(1, 2)"), constant("normal", true)};
  const Material spoiled = *look.read();
  CHECK(spoiled.diffuse_color == Vec3f{0.18f, 0.18f, 0.18f});
  CHECK(spoiled.opacity == 1.0f);
  CHECK(look.warnings(
            "inputs:diffuseColor: found 0.5, expected three numbers; drawn as (0.18, 0.18, 0.18)") == 1);
  CHECK(look.warnings("inputs:opacity: found 'half', expected a number; drawn as 1") == 1);
  CHECK(look.warnings("inputs:emissiveColor: found (1, 2), expected three numbers") == 1);
}

TEST_CASE("a value from the material's interface is named where it stands") {
  Network look;
  look.surface().inputs = {constant("opacity", std::string("half"), "'half'")};
  look.surface().inputs.front().origin = {"/Look", "inputs:seeThrough"};
  look.read();
  const auto found = std::ranges::find(look.said, "inputs:seeThrough", &Diagnostic::attribute);
  REQUIRE(found != look.said.end());
  CHECK(found->path == "/Look");
}

TEST_CASE("readers of displayColor and displayOpacity drive what they may, others fall back") {
  Network look;
  look.network.nodes.push_back(
      {"/Look/Color",
       "UsdPrimvarReader_float3",
       {constant("varname", std::string("displayColor")), constant("fallback", numbers({1, 0, 0}))}});
  look.network.nodes.push_back(
      {"/Look/Opacity", "UsdPrimvarReader_float", {constant("varname", std::string("displayOpacity"))}});
  look.surface().inputs = {connected("diffuseColor", "/Look/Color", "result"),
                           connected("opacity", "/Look/Opacity", "result")};
  const Material material = *look.read();
  CHECK(material.diffuse_from_display_color);
  CHECK(material.diffuse_color == Vec3f{1, 0, 0});
  CHECK(material.opacity_from_display_opacity);
  CHECK(look.warnings() == 0);

  look.surface().inputs = {connected("opacity", "/Look/Color", "result"),
                           connected("diffuseColor", "/Look/Opacity", "result")};
  const Material crossed = *look.read();
  CHECK_FALSE(crossed.opacity_from_display_opacity);
  CHECK_FALSE(crossed.diffuse_from_display_color);
  CHECK(look.warnings("inputs:diffuseColor: connected to a UsdPrimvarReader_float of 'displayOpacity'") == 1);
}

TEST_CASE("a texture's mean, scaled, by the output that is connected; its cutout has no threshold") {
  Network look;
  look.network.nodes.push_back(
      {"/Look/Wood",
       "UsdUVTexture",
       {constant("file", Asset{"wood.png", {"/wood.png"}}), constant("sourceColorSpace", std::string("raw")),
        constant("scale", numbers({2, 2, 2, 2})), constant("bias", numbers({0, 0, 0, 0.1}))}});
  look.surface().inputs = {connected("diffuseColor", "/Look/Wood", "rgb"),
                           connected("emissiveColor", "/Look/Wood", "g"),
                           connected("opacity", "/Look/Wood", "a"), constant("opacityThreshold", 0.5)};
  const Material material = *look.read(OneTexture());
  CHECK(material.diffuse_color == Vec3f{0.2f, 0.4f, 0.6f});
  CHECK(material.emissive_color == Vec3f{0.4f, 0.4f, 0.4f});
  CHECK(material.opacity == 0.9f);
  CHECK(material.opacity_threshold == 0.0f);
  CHECK(look.warnings("drawn as the mean of its texture") == 3);

  look.network.nodes.back().inputs[2] =
      constant("scale", numbers({std::numeric_limits<double>::quiet_NaN(), 1, 1, 1}));
  CHECK(look.read(OneTexture())->diffuse_color ==
        Vec3f{0.1f, 0.2f, 0.3f});  // a scale that is NaN scales nothing
}

TEST_CASE("a texture that cannot be read is its fallback, then the input's default") {
  Network look;
  look.network.nodes.push_back(
      {"/Look/Wood",
       "UsdUVTexture",
       {constant("file", Asset{"wood.png"}), constant("fallback", numbers({0.5, 0.6, 0.7, 0.8}))}});
  look.surface().inputs = {connected("diffuseColor", "/Look/Wood", "rgb"),
                           connected("opacity", "/Look/Wood", "a")};
  const Material material = *look.read();
  CHECK(material.diffuse_color == Vec3f{0.5f, 0.6f, 0.7f});
  CHECK(material.opacity == 0.8f);
  CHECK(look.warnings("@wood.png@ cannot be read, drawn as its fallback, (0.5, 0.6, 0.7)") == 1);
  look.network.nodes.back().inputs.clear();
  CHECK(look.read()->diffuse_color == Vec3f{0.18f, 0.18f, 0.18f});
  CHECK(look.warnings("it names no file, and it has no fallback: drawn as (0.18, 0.18, 0.18)") == 1);
}

TEST_CASE("cycles, nodes that are not there and surfaces of another kind end in one warning each") {
  Network look;
  look.surface().inputs = {connected("diffuseColor", "/Look/Surface", "surface"),
                           connected("opacity", "/Nowhere", "out")};
  const Material material = *look.read();
  CHECK(material.diffuse_color == Vec3f{0.18f, 0.18f, 0.18f});
  CHECK(look.warnings("inputs:diffuseColor: connected to a UsdPreviewSurface") == 1);
  CHECK(look.warnings("inputs:opacity: connected to a node of no known type") == 1);

  look.surface().identifier = "ND_standard_surface_surfaceshader";
  CHECK_FALSE(look.read());
  CHECK(look.warnings("outputs:surface: found a surface shader ND_standard_surface_surfaceshader, expected "
                      "UsdPreviewSurface") == 1);
  look.network.terminals.clear();
  CHECK_FALSE(look.read());
  CHECK(look.warnings("found no surface shader that can be read") == 1);
}

TEST_CASE("inputs that a diffuse surface does not show are reported unless they have no effect") {
  Network look;
  look.surface().inputs = {constant("normal", numbers({0, 0, 1}))};
  look.read();
  CHECK(look.warnings() == 0);
  look.surface().inputs = {constant("normal", numbers({0, 1, 0}))};
  look.read();
  CHECK(look.warnings("inputs:normal: not supported yet") == 1);
  look.surface().inputs = {constant("normal", numbers({0, 0, 1}))};
  look.surface().inputs[0].in_shutter = {ShaderValue{numbers({0, 0, 1})}, ShaderValue{numbers({1, 0, 0})}};
  look.read();
  CHECK(look.warnings("inputs:normal: not supported yet") == 1);
}

TEST_CASE("a value that changes within the shutter is held, which is said where it was authored") {
  Network look;
  ShaderInput opacity = constant("opacity", 0.5);
  opacity.in_shutter = {ShaderValue{0.5}};
  look.surface().inputs = {opacity};
  look.read();
  CHECK(look.warnings() == 0);
  opacity.in_shutter.push_back(std::nullopt);  // blocked from then on
  opacity.origin = {"/Look", "inputs:clear"};
  look.surface().inputs = {opacity};
  CHECK(look.read()->opacity == 0.5f);
  REQUIRE(look.warnings() == 1);
  CHECK(look.warnings("inputs:clear: changes within the shutter; held the frame's value, as Hydra does") ==
        1);
  CHECK(look.said.back().path == "/Look");
  CHECK(look.said.back().in_common);
}

TEST_CASE("no value, and what the frame alone has, is no normal map; other kinds than vectors are one") {
  Network look;
  const auto warnings_of = [&](const ShaderInput& normal) {
    look.surface().inputs = {normal};
    look.read();
    return look.warnings("inputs:normal: not supported yet; drawn without it");
  };
  CHECK(warnings_of({"normal"}) == 0);
  ShaderInput moving = constant("normal", numbers({1, 0, 0}));
  moving.in_shutter = {ShaderValue{numbers({0, 0, 1})}, std::nullopt};
  CHECK(warnings_of(moving) == 0);
  CHECK(warnings_of(constant("normal", false)) == 1);
  CHECK(warnings_of(connected("normal", "/Nowhere", "out")) == 1);
}

TEST_CASE("a primvar's name of another type is ignored, and so the reader falls back") {
  Network look;
  look.network.nodes.push_back({"/Look/Reader", "UsdPrimvarReader_float", {constant("varname", 1.0)}});
  look.surface().inputs = {connected("opacity", "/Look/Reader", "result")};
  CHECK_FALSE(look.read()->opacity_from_display_opacity);
  CHECK(look.warnings("inputs:varname: found type, expected token; ignored") == 1);
  CHECK(look.warnings(
            "connected to a UsdPrimvarReader_float of '', which is not evaluated yet; drawn as 1") == 1);
}

TEST_CASE("a fallback of another kind is named at the node, and the input's default is drawn") {
  Network look;
  look.network.nodes.push_back(
      {"/Look/Wood", "UsdUVTexture", {constant("fallback", std::string("brown"), "'brown'")}});
  look.surface().inputs = {connected("opacity", "/Look/Wood", "a")};
  CHECK(look.read()->opacity == 1.0f);
  REQUIRE(look.warnings("inputs:fallback: found 'brown', expected a number; drawn as 1") == 1);
  CHECK(std::ranges::count(look.said, "/Look/Wood", &Diagnostic::path) == 1);
}

TEST_CASE("a texture whose inputs are all connected to itself has no file") {
  Network look;
  ShaderNode wood{"/Look/Wood", "UsdUVTexture"};
  for (const std::string_view name : evaluated_inputs(wood.identifier)) {
    wood.inputs.push_back(connected(std::string(name), wood.path, "rgb"));
  }
  look.network.nodes.push_back(wood);
  look.surface().inputs = {connected("opacity", "/Look/Wood", "a")};
  CHECK(look.read(OneTexture())->opacity == 1.0f);
  CHECK(look.warnings("it names no file, and it has no fallback: drawn as 1") == 1);
}

TEST_CASE("the first connection counts, and more than a value does") {
  Network look;
  look.network.nodes.push_back({"/Look/A", "Mix", {constant("fallback", 0.5)}});
  look.network.nodes.push_back({"/Look/B", "Mix", {constant("fallback", 0.75)}});
  ShaderInput opacity = constant("opacity", 0.25);
  opacity.connections = {{"/Look/B", "out"}, {"/Look/A", "out"}};
  look.surface().inputs = {opacity};
  CHECK(look.read()->opacity == 0.75f);
  CHECK(look.warnings("connected to a Mix, which is not evaluated yet; drawn as 0.75") == 1);
}

namespace {

// Reads raw textures otherwise than others.
struct SomeTexture : TextureSource {
  std::optional<Rgba> mean(const Asset&, std::string_view space) const override {
    return space == "raw" ? Rgba{0.1, 0.2, 0.3, 0.4} : Rgba{0.5, 0.6, 0.7, 0.8};
  }
  std::optional<ScalarImage> channel(const Asset&, std::string_view, std::size_t) const override {
    return ScalarImage{2, 2, {0.125f, 0.25f, 0.5f, 1.0f}};
  }
};

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
         {constant("file", Asset{"wood.png"}), connected("st", "/Look/Node", "result")}});
  }
  look.network.nodes.push_back(node);
  const SomeTexture textures;
  const Material material = *look.read(textures);
  const Displacement displaced = displacement_of(look.network, textures, look.said).value_or(Displacement{});
  std::string all = message(material.emissive_color.x, " ", material.diffuse_color.x, " ", displaced.constant,
                            " ", displaced.primvar, " ", displaced.scale, " ", displaced.bias);
  for (const auto& [s, t] : {displaced.coordinates.fallback, std::array{1.3, -0.6}}) {
    const auto st = displaced.coordinates.mapped(s, t);
    all += message(" ", st[0], " ", st[1]);
    if (displaced.texture) all += message(" ", displaced.texture->at(st[0], st[1], 0.0, 0.0));
  }
  for (const Diagnostic& d : look.said) all += "; " + d.attribute + ": " + d.message;
  return all;
}

ShaderData unusual_data(const std::string& identifier, const std::string& name) {
  if (name == "file") return Asset{"wood.png"};
  if (name == "varname" || name == "sourceColorSpace") return std::string("raw");
  if (name == "wrapS" || name == "wrapT") return std::string("repeat");
  if (name == "rotation" || name == "displacement") return 0.5;
  const bool pair = name == "st" || (identifier == "UsdTransform2d" && name != "fallback");
  return pair ? numbers({0.5, 0.75}) : numbers({0.5, 0.5, 0.5, 0.5});
}

bool differs(const std::string& identifier, const std::string& name) {
  ShaderNode node{"/Look/Node", identifier};
  if (identifier == "UsdUVTexture" && name != "file" && name != "fallback") {
    node.inputs = {constant("file", Asset{"wood.png"})};
  }
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
