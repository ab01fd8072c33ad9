// UsdPreviewSurface networks, built by hand: what their inputs are drawn as, and what is said of the rest.
#include <algorithm>
#include <array>
#include <doctest/doctest.h>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "delegate/translate/look/preview_surface.h"
#include "tests/translate/shading_network.h"

using namespace msbvh;
using namespace msbvh::translate;
using namespace msbvh::testing;

TEST_CASE("a surface without inputs has the specification's defaults, and says nothing") {
  Network look;
  const Material material = look.material();
  CHECK(material.name == "/Look");
  CHECK(material.diffuse_color == Vec3f{0.18f, 0.18f, 0.18f});
  CHECK(material.emissive_color == Vec3f{});
  CHECK(material.opacity == 1.0f);
  CHECK(material.opacity_threshold == 0.0f);
  CHECK(material.specular);
  CHECK_FALSE(material.specular_workflow);
  CHECK(material.metallic == 0.0f);
  CHECK(material.roughness == 0.5f);
  CHECK(material.ior == 1.5f);
  CHECK(material.clearcoat == 0.0f);
  CHECK(material.clearcoat_roughness == 0.01f);
  CHECK(material.transparent_reflects);
  CHECK(material.normal == Vec3f{0, 0, 1});
  CHECK(material.driven.empty());
  CHECK(look.said.empty());
}

TEST_CASE("constants are taken as they are; another kind is named and the default stands for it") {
  Network look;
  look.surface().inputs = {constant("diffuseColor", numbers({0.1, 0.2, 0.3})), constant("opacity", 0.5),
                           constant("opacityThreshold", 0.25)};
  const Material material = look.material();
  CHECK(material.diffuse_color == Vec3f{0.1f, 0.2f, 0.3f});
  CHECK(material.opacity == 0.5f);
  CHECK(material.opacity_threshold == 0.25f);
  CHECK(look.warnings() == 0);

  look.surface().inputs = {
      constant("diffuseColor", 0.5, "0.5"), constant("opacity", std::string("half"), "'half'"),
      constant("emissiveColor", numbers({1.0, 2.0}), "(1, 2)"), constant("normal", true)};
  const Material spoiled = look.material();
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

TEST_CASE("readers of displayColor and displayOpacity drive what they may; of others, named primvars do") {
  Network look;
  look.add("Color", "UsdPrimvarReader_float3",
           {constant("varname", std::string("displayColor")), constant("fallback", numbers({1, 0, 0}))});
  look.add("Opacity", "UsdPrimvarReader_float", {constant("varname", std::string("displayOpacity"))});
  look.surface().inputs = {connected("diffuseColor", "/Look/Color", "result"),
                           connected("opacity", "/Look/Opacity", "result")};
  const SurfaceLook found = *look.read();
  CHECK(found.material.diffuse_from_display_color);
  CHECK(found.material.diffuse_color == Vec3f{1, 0, 0});
  CHECK(found.material.opacity_from_display_opacity);
  CHECK(found.material.driven.empty());
  CHECK(found.primvars.empty());
  CHECK(look.warnings() == 0);

  look.surface().inputs = {connected("opacity", "/Look/Color", "result"),
                           connected("diffuseColor", "/Look/Opacity", "result")};
  const SurfaceLook crossed = *look.read();
  CHECK_FALSE(crossed.material.opacity_from_display_opacity);
  CHECK_FALSE(crossed.material.diffuse_from_display_color);
  CHECK(crossed.primvars == std::vector<NeededPrimvar>{{"displayOpacity", 1}, {"displayColor", 3}});
  CHECK(driven(crossed.material, SurfaceInput::kDiffuseColor)->grey);
  CHECK(driven(crossed.material, SurfaceInput::kOpacity)->channel == 0);
  CHECK(
      look.warnings("inputs:opacity: connected to a UsdPrimvarReader_float3, expected one number; its first "
                    "is read") == 1);
}

TEST_CASE("readers of every type of numbers drive inputs; of others the fallback is drawn, with a warning") {
  for (const auto& [type, width] : {std::pair{"float", 1u},
                                    {"int", 1u},
                                    {"float2", 2u},
                                    {"float3", 3u},
                                    {"point", 3u},
                                    {"normal", 3u},
                                    {"vector", 3u},
                                    {"float4", 4u}}) {
    CAPTURE(type);
    Network look;
    look.add("Reader", std::string("UsdPrimvarReader_") + type, {constant("varname", std::string("wet"))});
    look.surface().inputs = {connected("specularColor", "/Look/Reader", "result"),
                             connected("roughness", "/Look/Reader", "result"),
                             constant("useSpecularWorkflow", 1.0)};
    const SurfaceLook found = *look.read();
    REQUIRE(found.primvars == std::vector<NeededPrimvar>{{"wet", width}});
    const DrivenInput color = *driven(found.material, SurfaceInput::kSpecularColor);
    CHECK(color.source == DrivenInput::Source::kPrimvar);
    CHECK(color.index == 0);
    CHECK(color.grey == (width == 1));
    CHECK(driven(found.material, SurfaceInput::kRoughness)->channel == 0);
    CHECK(look.warnings() == (width == 1 ? 0 : 1));
  }
  for (const char* type : {"string", "matrix", "half7"}) {
    Network look;
    look.add("Reader", std::string("UsdPrimvarReader_") + type,
             {constant("varname", std::string("wet")), constant("fallback", 0.25)});
    look.surface().inputs = {connected("roughness", "/Look/Reader", "result")};
    const SurfaceLook found = *look.read();
    CHECK(found.material.driven.empty());
    CHECK(found.material.roughness == 0.25f);
    CHECK(look.warnings(std::string("connected to a UsdPrimvarReader_") + type) == 1);
  }
}

TEST_CASE("a reader's fallback is the constant beside it, in the reader's own type") {
  Network look;
  look.add("Number", "UsdPrimvarReader_float",
           {constant("varname", std::string("a")), constant("fallback", 0.25)});
  look.add("Vector", "UsdPrimvarReader_float4",
           {constant("varname", std::string("b")), constant("fallback", numbers({0.1, 0.2, 0.3, 0.4}))});
  look.add("Wrong", "UsdPrimvarReader_float3",
           {constant("varname", std::string("c")), constant("fallback", std::string("no"), "'no'")});
  look.surface().inputs = {connected("diffuseColor", "/Look/Number", "result"),
                           connected("emissiveColor", "/Look/Vector", "result"),
                           connected("normal", "/Look/Wrong", "result")};
  const Material material = look.material();
  CHECK(material.diffuse_color == Vec3f{0.25f, 0.25f, 0.25f});
  CHECK(material.emissive_color == Vec3f{0.1f, 0.2f, 0.3f});
  CHECK(material.normal == Vec3f{0, 0, 1});
  CHECK(material.driven.size() == 3);
  CHECK(look.warnings("inputs:fallback: found 'no', expected three numbers") == 1);
}

TEST_CASE("numbers outside of their range are taken to its ends, with a warning") {
  Network look;
  look.surface().inputs = {constant("metallic", 1.5), constant("roughness", -0.5), constant("clearcoat", 2.0),
                           constant("clearcoatRoughness", -1.0), constant("ior", 0.0)};
  const Material material = look.material();
  CHECK(material.metallic == 1.0f);
  CHECK(material.roughness == 0.0f);
  CHECK(material.clearcoat == 1.0f);
  CHECK(material.clearcoat_roughness == 0.0f);
  CHECK(material.ior == 1.5f);
  CHECK(look.warnings() == 5);
  CHECK(look.warnings("inputs:metallic: found 1.5, expected 0 to 1; taken as 1") == 1);
  CHECK(look.warnings("inputs:ior: found 0, expected a number above 0; taken as 1.5") == 1);
}

TEST_CASE("the specular workflow reads specularColor, the other one metallic") {
  Network look;
  look.surface().inputs = {constant("specularColor", numbers({0.5, 0.25, 0})), constant("metallic", 1.0)};
  CHECK(look.material().metallic == 1.0f);
  CHECK(look.material().specular_color == Vec3f{});
  for (const ShaderData& flag : {ShaderData(1.0), ShaderData(true)}) {
    look.surface().inputs.resize(2);
    look.surface().inputs.push_back(constant("useSpecularWorkflow", flag));
    const Material material = look.material();
    CHECK(material.specular_workflow);
    CHECK(material.specular_color == Vec3f{0.5f, 0.25f, 0});
    CHECK(material.metallic == 0.0f);
    CHECK(look.warnings() == 0);
  }
  look.surface().inputs.back() = constant("useSpecularWorkflow", std::string("yes"), "'yes'");
  CHECK_FALSE(look.material().specular_workflow);
  CHECK(look.warnings("inputs:useSpecularWorkflow: found 'yes', expected a number") == 1);
}

TEST_CASE("what is transparent reflects, a presence does not, and a threshold makes one") {
  Network look;
  const auto with = [&](std::vector<ShaderInput> inputs) {
    look.surface().inputs = std::move(inputs);
    return look.material();
  };
  CHECK(with({constant("opacity", 0.0)}).specular);
  const auto mode = [](const char* name) { return constant("opacityMode", std::string(name), name); };
  CHECK(with({mode("transparent")}).transparent_reflects);
  CHECK_FALSE(with({mode("presence")}).transparent_reflects);
  CHECK_FALSE(with({constant("opacityThreshold", 0.25)}).transparent_reflects);
  CHECK(with({mode("presence"), constant("opacity", 0.5)}).specular);
  CHECK_FALSE(with({mode("presence"), constant("opacity", 0.0)}).specular);
  CHECK_FALSE(with({constant("opacityThreshold", 0.5), constant("opacity", 0.25)}).specular);
  CHECK(look.warnings() == 0);
  CHECK(with({mode("glass")}).transparent_reflects);
  CHECK(look.warnings("inputs:opacityMode: found glass, expected transparent or presence; took the first") ==
        1);
}

TEST_CASE("a texture that cannot be read is its fallback, then the input's default") {
  Network look;
  look.network.nodes.push_back(
      {"/Look/Wood",
       "UsdUVTexture",
       {constant("file", Asset{"wood.png"}), constant("fallback", numbers({0.5, 0.6, 0.7, 0.8}))}});
  look.surface().inputs = {connected("diffuseColor", "/Look/Wood", "rgb"),
                           connected("opacity", "/Look/Wood", "a")};
  const Material material = look.material();
  CHECK(material.diffuse_color == Vec3f{0.5f, 0.6f, 0.7f});
  CHECK(material.opacity == 0.8f);
  CHECK(look.warnings("@wood.png@ cannot be found, drawn as its fallback, (0.5, 0.6, 0.7)") == 1);
  look.network.nodes.back().inputs.clear();
  CHECK(look.material().diffuse_color == Vec3f{0.18f, 0.18f, 0.18f});
  CHECK(look.warnings("it names no file, and it has no fallback: drawn as (0.18, 0.18, 0.18)") == 1);
}

TEST_CASE("cycles, nodes that are not there and surfaces of another kind end in one warning each") {
  Network look;
  look.surface().inputs = {connected("diffuseColor", "/Look/Surface", "surface"),
                           connected("opacity", "/Nowhere", "out")};
  const Material material = look.material();
  CHECK(material.diffuse_color == Vec3f{0.18f, 0.18f, 0.18f});
  CHECK(look.warnings("inputs:diffuseColor: connected to a UsdPreviewSurface") == 1);
  CHECK(look.warnings("inputs:opacity: connected to a node of no known type") == 1);

  look.surface().identifier = "PxrSurface";
  CHECK_FALSE(look.read());
  CHECK(look.warnings("outputs:surface: found a surface shader PxrSurface, expected "
                      "UsdPreviewSurface") == 1);
  look.network.terminals.clear();
  CHECK_FALSE(look.read());
  CHECK(look.warnings("found no surface shader that can be read") == 1);
}

TEST_CASE("a constant normal is taken as it is, along st; the default needs none") {
  Network look;
  CHECK(look.material().normal_coordinates == kNoPrimvar);
  look.surface().inputs = {constant("normal", numbers({0, 0.5, 0.5}))};
  CHECK(look.material().normal == Vec3f{0, 0.5f, 0.5f});
  CHECK(look.material().normal_coordinates == 0);
  CHECK(look.warnings() == 0);
  look.surface().inputs = {constant("normal", false, "False")};
  CHECK(look.material().normal == Vec3f{0, 0, 1});
  CHECK(look.warnings("inputs:normal: found False, expected three numbers; drawn as (0, 0, 1)") == 1);
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
  CHECK(look.material().opacity == 0.5f);
  REQUIRE(look.warnings() == 1);
  CHECK(look.warnings("inputs:clear: changes within the shutter; held the frame's value, as Hydra does") ==
        1);
  CHECK(look.said.back().path == "/Look");
  CHECK(look.said.back().in_common);
}

TEST_CASE("a primvar's name of another type is ignored, and so the reader falls back") {
  Network look;
  look.network.nodes.push_back({"/Look/Reader", "UsdPrimvarReader_float", {constant("varname", 1.0)}});
  look.surface().inputs = {connected("opacity", "/Look/Reader", "result")};
  CHECK_FALSE(look.material().opacity_from_display_opacity);
  CHECK(look.warnings("inputs:varname: found type, expected token; ignored") == 1);
  CHECK(look.warnings("connected to a UsdPrimvarReader_float that names no primvar; drawn as 1") == 1);
}

TEST_CASE("a fallback of another kind is named at the node, and the input's default is drawn") {
  Network look;
  look.network.nodes.push_back(
      {"/Look/Wood", "UsdUVTexture", {constant("fallback", std::string("brown"), "'brown'")}});
  look.surface().inputs = {connected("opacity", "/Look/Wood", "a")};
  CHECK(look.material().opacity == 1.0f);
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
  CHECK(look.material().opacity == 1.0f);
  CHECK(look.warnings("it names no file, and it has no fallback: drawn as 1") == 1);
}

TEST_CASE("the first connection counts, and more than a value does") {
  Network look;
  look.network.nodes.push_back({"/Look/A", "Mix", {constant("fallback", 0.5)}});
  look.network.nodes.push_back({"/Look/B", "Mix", {constant("fallback", 0.75)}});
  ShaderInput opacity = constant("opacity", 0.25);
  opacity.connections = {{"/Look/B", "out"}, {"/Look/A", "out"}};
  look.surface().inputs = {opacity};
  CHECK(look.material().opacity == 0.75f);
  CHECK(look.warnings("connected to a Mix, which is not evaluated; drawn as 0.75") == 1);
}
