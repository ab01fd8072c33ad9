// MaterialX's surfaces as UsdPreviewSurface: constants, images, primvars, and what is said of the rest.
#include <array>
#include <doctest/doctest.h>
#include <string>
#include <vector>

#include "delegate/translate/look/materialx.h"
#include "tests/translate/shading_network.h"

using namespace msbvh;
using namespace msbvh::testing;

namespace {

ShaderInput file(const char* space = "") { return constant("file", Asset{"wood.png", {"/wood.png"}, space}); }

Network of(const char* identifier, std::vector<ShaderInput> inputs = {}) {
  Network look;
  look.surface() = {"/Look/Surface", identifier, std::move(inputs)};
  return look;
}

}  // namespace

TEST_CASE("MaterialX's surfaces have their own defaults") {
  Network look = of("ND_standard_surface_surfaceshader");
  const Material standard = look.material();
  CHECK(standard.diffuse_color == Vec3f{0.8f, 0.8f, 0.8f});
  CHECK(standard.emissive_color == Vec3f{});
  CHECK(standard.roughness == 0.2f);
  CHECK(standard.specular);
  CHECK(look.warnings() == 0);
  REQUIRE(look.said.size() == 1);
  CHECK(look.said.front().message == "ND_standard_surface_surfaceshader is drawn as a UsdPreviewSurface");
  look = of("ND_open_pbr_surface_surfaceshader");
  CHECK(look.material().roughness == 0.3f);
  look = of("ND_UsdPreviewSurface_surfaceshader");
  CHECK(look.material().diffuse_color == Vec3f{0.18f, 0.18f, 0.18f});
  CHECK(look.said.empty());
}

TEST_CASE("constants of a standard_surface are mapped, weights multiplied in, the rest is named once") {
  Network look =
      of("ND_standard_surface_surfaceshader",
         {constant("base", 0.5), constant("base_color", numbers({1, 0.5, 0})), constant("metalness", 1.0),
          constant("emission", 2.0), constant("opacity", numbers({0.5, 0.5, 0.5})), constant("coat", 1.0),
          constant("transmission", 1.0), constant("sheen", 0.0)});
  const Material material = look.material();
  CHECK(material.diffuse_color == Vec3f{0.5f, 0.25f, 0});
  CHECK(material.metallic == 1.0f);
  CHECK(material.emissive_color == Vec3f{2, 2, 2});
  CHECK(material.opacity == 0.5f);
  CHECK(material.clearcoat == 1.0f);
  CHECK(material.clearcoat_roughness == 0.1f);
  CHECK(look.warnings() == 1);
  CHECK(look.warnings("is drawn as a UsdPreviewSurface; transmission is left out") == 1);
}

TEST_CASE("images of an open_pbr_surface: weight, wrap modes, colour space, tiling, normal map") {
  Network look = of("ND_open_pbr_surface_surfaceshader",
                    {constant("base_weight", 0.5), connected("base_color", "/Look/Color", "out"),
                     connected("specular_roughness", "/Look/Rough", "out"),
                     connected("geometry_normal", "/Look/Normal", "out")});
  look.add("Color", "ND_tiledimage_color3", {file("srgb_texture"), constant("uvtiling", numbers({2, 4}))});
  look.add("Rough", "ND_image_float",
           {file(), constant("uaddressmode", std::string("clamp")), connected("texcoord", "/Look/Uv", "out"),
            constant("default", 0.25)});
  look.add("Uv", "ND_geompropvalue_vector2", {constant("geomprop", std::string("map1"))});
  look.add("Normal", "ND_normalmap", {connected("in", "/Look/Bumps", "out")});
  look.add("Bumps", "ND_image_vector3", {file()});
  const SurfaceLook found = *look.read();
  CHECK(look.warnings() == 0);
  const Material& material = found.material;
  const auto read_of = [&](SurfaceInput input) {
    return material.texture_reads[driven(material, input)->index];
  };
  const TextureRead color = read_of(SurfaceInput::kDiffuseColor);
  CHECK(color.scale == std::array{0.5f, 0.5f, 0.5f, 1.0f});
  CHECK(color.matrix == std::array{2.0f, 0.0f, 0.0f, 4.0f});
  CHECK(found.primvars[color.coordinates].name == "st");
  CHECK(found.textures[color.texture].color_space == "srgb_texture");
  CHECK(found.textures[color.texture].wrap_s == TextureWrap::kRepeat);
  const TextureRead rough = read_of(SurfaceInput::kRoughness);
  CHECK(found.primvars[rough.coordinates].name == "map1");
  CHECK(found.textures[rough.texture].color_space == "");
  CHECK(found.textures[rough.texture].wrap_s == TextureWrap::kClamp);
  CHECK(found.textures[rough.texture].fallback[0] == 0.25f);
  CHECK(driven(material, SurfaceInput::kRoughness)->channel == 0);
  CHECK(read_of(SurfaceInput::kNormal).scale == std::array{2.0f, 2.0f, 2.0f, 1.0f});
  CHECK(read_of(SurfaceInput::kNormal).bias == std::array{-1.0f, -1.0f, -1.0f, 0.0f});
}

TEST_CASE("MaterialX's UsdPreviewSurface nodes mean what USD's do") {
  Network look = of("ND_UsdPreviewSurface_surfaceshader",
                    {constant("roughness", 0.25), connected("diffuseColor", "/Look/Texture", "rgb"),
                     connected("opacity", "/Look/Texture", "a"), connected("metallic", "/Look/Wet", "out"),
                     constant("opacityMode", 1.0)});
  look.add("Texture", "ND_UsdUVTexture_23",
           {file(), constant("sourceColorSpace", std::string("sRGB")), connected("st", "/Look/Turn", "out")});
  look.add("Turn", "ND_UsdTransform2d",
           {constant("scale", numbers({3, 3})), connected("in", "/Look/Uv", "out")});
  look.add("Uv", "ND_UsdPrimvarReader_vector2", {constant("varname", std::string("uv"))});
  look.add("Wet", "ND_UsdPrimvarReader_float", {constant("varname", std::string("wet"))});
  const SurfaceLook found = *look.read();
  CHECK(look.said.empty());
  CHECK(found.material.roughness == 0.25f);
  CHECK_FALSE(found.material.transparent_reflects);
  CHECK(driven(found.material, SurfaceInput::kOpacity)->channel == 3);
  CHECK(found.material.texture_reads.front().matrix == std::array{3.0f, 0.0f, 0.0f, 3.0f});
  CHECK(found.textures.front().color_space == "srgb_rec709_scene");
  CHECK(driven(found.material, SurfaceInput::kMetallic)->source == DrivenInput::Source::kPrimvar);
}

TEST_CASE(
    "channels, constants and nodes that pass a value on are looked through; others are named; circles end") {
  Network look =
      of("ND_standard_surface_surfaceshader",
         {connected("metalness", "/Look/Blue", "out"), connected("base_color", "/Look/Dot", "out"),
          connected("specular_roughness", "/Look/Noise", "out"), connected("coat", "/Look/A", "out")});
  look.add("Blue", "ND_extract_color3", {constant("index", 2.0), connected("in", "/Look/Image", "out")});
  look.add("Image", "ND_image_color3", {file()});
  look.add("Dot", "ND_dot_color3", {connected("in", "/Look/Red", "out")});
  look.add("Red", "ND_constant_color3", {constant("value", numbers({1, 0, 0}))});
  look.add("Noise", "ND_noise2d_float");
  look.add("A", "ND_dot_float", {connected("in", "/Look/B", "out")});
  look.add("B", "ND_dot_float", {connected("in", "/Look/A", "out")});
  const Material material = look.material();
  CHECK(driven(material, SurfaceInput::kMetallic)->channel == 2);
  CHECK(material.diffuse_color == Vec3f{1, 0, 0});
  CHECK(material.roughness == 0.2f);
  CHECK(material.clearcoat == 0.0f);
  CHECK(look.warnings("specular_roughness is not evaluated, coat is not evaluated") == 1);
  CHECK(look.warnings() == 1);
}

TEST_CASE(
    "of a material's surfaces, what is read as it is comes before what is mapped, and that before others") {
  CHECK(surface_rank("UsdPreviewSurface") < surface_rank("ND_standard_surface_surfaceshader"));
  CHECK(surface_rank("ND_open_pbr_surface_surfaceshader") < surface_rank("PxrSurface"));
  CHECK_FALSE(is_materialx_surface("ND_mix_surfaceshader"));
}
