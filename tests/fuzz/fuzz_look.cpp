// UsdPreviewSurface networks: nodes and inputs of right and wrong kinds, connected at random, in circles too;
// and the textures that displacement reads.
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "delegate/translate/look/displacement.h"
#include "delegate/translate/look/preview_surface.h"
#include "delegate/translate/look/scalar_texture.h"
#include "delegate/translate/material_table.h"
#include "tests/fuzz/fuzzed_data.h"
#include "tests/fuzz/outcome.h"

using namespace msbvh;
using namespace msbvh::fuzz;
using namespace msbvh::translate;

namespace {

ScalarImage fuzzed_image(FuzzedData& data) {
  ScalarImage image;
  image.width = 1 + data.below(7);
  image.height = 1 + data.below(7);
  image.values = data.reals(std::size_t(image.width) * image.height, -1.0f, 1.0f);
  for (float& value : image.values) {
    if (!std::isfinite(value)) value = 0.0f;  // as the reader does
  }
  image.wrap_s = data.word({"", "repeat", "mirror", "clamp", "black"});
  image.wrap_t = data.word({"", "repeat", "mirror", "clamp", "black"});
  return image;
}

class FuzzedTextures : public TextureSource {
 public:
  explicit FuzzedTextures(FuzzedData& data) : data_(data) {}
  std::optional<TextureFile> locate(const std::string& file) const override {
    if (data_.rarely()) return std::nullopt;
    return TextureFile{file, data_.below(3), data_.below(3)};
  }
  std::optional<ScalarImage> channel(const Asset&, std::string_view, std::size_t) const override {
    if (data_.rarely()) return std::nullopt;
    return fuzzed_image(data_);
  }

 private:
  FuzzedData& data_;
};

ShaderData fuzzed_value(FuzzedData& data) {
  const auto vector = [&](std::size_t count) {
    std::vector<double> numbers;
    for (std::size_t i = 0; i < count; ++i) numbers.push_back(data.real());
    return numbers;
  };
  switch (data.below(9)) {
    case 0:
      return std::monostate{};
    case 1:
      return data.coin();
    case 2:
    case 3:
      return data.real();
    case 4:
      return vector(2 + data.below(3));
    case 5:
      return vector(data.below(6));
    case 6:
      return Asset{data.word({"a.png", "a.<UDIM>.png", "", "<UDIM>"}),
                   std::vector<std::string>(data.below(3), "/a.1001.png")};
    default:
      return data.word({"repeat", "mirror", "clamp", "black", "useMetadata", "raw", "sRGB", "auto", "st",
                        "displayColor", "displayOpacity", "transparent", "presence", ""});
  }
}

std::optional<ShaderValue> fuzzed_shader_value(FuzzedData& data) {
  if (data.rarely()) return std::nullopt;
  return ShaderValue{fuzzed_value(data), "text", "type"};
}

std::string node_path(FuzzedData& data, std::uint32_t nodes) {
  return data.wrong() ? "/nowhere" : "/Look/N" + std::to_string(data.below(nodes));
}

ShaderConnection fuzzed_connection(FuzzedData& data, std::uint32_t nodes) {
  return {node_path(data, nodes),
          data.word({"surface", "displacement", "result", "rgb", "r", "g", "b", "a", "out"})};
}

ShaderInput fuzzed_input(FuzzedData& data, std::uint32_t nodes) {
  ShaderInput input;
  input.name = data.word({"diffuseColor",
                          "emissiveColor",
                          "opacity",
                          "opacityThreshold",
                          "opacityMode",
                          "displacement",
                          "file",
                          "st",
                          "wrapS",
                          "wrapT",
                          "scale",
                          "bias",
                          "fallback",
                          "sourceColorSpace",
                          "varname",
                          "in",
                          "rotation",
                          "translation",
                          "useSpecularWorkflow",
                          "metallic",
                          "ior",
                          "roughness",
                          "clearcoat",
                          "specularColor",
                          "base_color",
                          "base",
                          "emission",
                          "opacity",
                          "specular_roughness",
                          "uvtiling",
                          "texcoord",
                          "index",
                          "value",
                          "normal"});
  input.value = fuzzed_shader_value(data);
  for (std::uint32_t n = data.rarely() ? data.below(4) : 0; n > 0; --n)
    input.in_shutter.push_back(fuzzed_shader_value(data));
  for (std::uint32_t n = data.coin() ? data.below(3) : 0; n > 0; --n)
    input.connections.push_back(fuzzed_connection(data, nodes));
  if (data.rarely()) input.origin = Origin{"/Look", "inputs:given"};
  return input;
}

std::string fuzzed_identifier(FuzzedData& data, bool surface, bool materialx) {
  if (!materialx && surface) return "UsdPreviewSurface";
  if (!materialx) {
    return data.word({"UsdUVTexture", "UsdPrimvarReader_float", "UsdPrimvarReader_float2",
                      "UsdPrimvarReader_float3", "UsdPrimvarReader_string", "UsdTransform2d",
                      "UsdPreviewSurface", ""});
  }
  if (surface) {
    return data.word({"ND_standard_surface_surfaceshader", "ND_open_pbr_surface_surfaceshader",
                      "ND_UsdPreviewSurface_surfaceshader"});
  }
  return data.word({"ND_image_color3", "ND_tiledimage_float", "ND_normalmap", "ND_extract_color3",
                    "ND_separate3_color3", "ND_constant_color3", "ND_dot_float", "ND_convert_float_color3",
                    "ND_geompropvalue_vector2", "ND_texcoord_vector2", "ND_UsdUVTexture_23",
                    "ND_UsdPrimvarReader_float", "ND_UsdTransform2d"});
}

ShaderNetwork fuzzed_network(FuzzedData& data) {
  ShaderNetwork network;
  network.path = "/Look";
  const std::uint32_t nodes = 1 + data.below(6);
  const bool materialx = data.rarely();
  for (std::uint32_t i = 0; i < nodes; ++i) {
    ShaderNode node{"/Look/N" + std::to_string(i), ""};
    node.identifier = fuzzed_identifier(data, i == 0, materialx);
    for (std::uint32_t n = data.below(7); n > 0; --n) node.inputs.push_back(fuzzed_input(data, nodes));
    network.nodes.push_back(std::move(node));
  }
  network.terminals["surface"] = {"/Look/N0", "surface"};
  if (data.coin()) network.terminals["displacement"] = {"/Look/N0", "displacement"};
  if (data.wrong()) network.terminals["surface"] = fuzzed_connection(data, nodes);
  if (data.rarely()) network.terminals["displacement"] = fuzzed_connection(data, nodes);
  return network;
}

void check_said(const std::vector<Diagnostic>& said) {
  for (const Diagnostic& d : said) {
    require(!d.path.empty() && !d.message.empty(), "a message that names no prim");
    require(d.message.find('\n') == std::string::npos, "a message of several lines");
  }
}

void check_displacement(const Displacement& displacement, FuzzedData& data) {
  require(std::isfinite(displacement.constant), "a displacement that is not finite");
  require(std::isfinite(displacement.scale) && std::isfinite(displacement.bias),
          "a scale or a bias that is not finite");
  if (!displacement.texture) return;
  for (int i = 0; i < 4; ++i) {
    const auto [s, t] = displacement.coordinates.mapped(data.real(), data.real());
    const double found = displacement.texture->at(s, t, std::abs(data.real()), std::abs(data.real()));
    require(!std::isfinite(s) || !std::isfinite(t) || std::isfinite(found), "a texel that is not finite");
  }
}

void read_texture(FuzzedData& data) {
  const auto wrap = [&] { return data.one_of({Wrap::kBlack, Wrap::kClamp, Wrap::kRepeat, Wrap::kMirror}); };
  const auto made = [&]() -> ScalarTexture {
    if (data.coin()) return ScalarTexture(fuzzed_image(data), wrap(), wrap());
    std::vector<ScalarTile> tiles;
    for (std::uint32_t n = 1 + data.below(3); n > 0; --n) {
      tiles.push_back({int(data.below(10)), int(data.below(10)), fuzzed_image(data)});
    }
    return ScalarTexture(std::move(tiles));
  };
  const ScalarTexture texture = made();
  const double slack = 1e-6;
  for (int i = 0; i < 16; ++i) {
    const double value = texture.at(data.real(), data.real(), std::abs(data.real()), std::abs(data.real()));
    require(!std::isnan(value), "a texel that is not a number");
    require(
        value >= std::min(0.0, texture.least()) - slack && value <= std::max(0.0, texture.largest()) + slack,
        "a mean outside of the texels");
  }
}

// A scene takes it as it is, but for numbers that are not finite.
void check_look(const SurfaceLook& look) {
  Scene scene;
  MaterialTable table;
  std::vector<Diagnostic> said;
  PrimLog log(said, "/Look");
  table.add(look, scene, log);
  table.add(look, scene, log);
  require(scene.textures.size() <= look.textures.size(), "a texture that is kept twice");
  require(scene.primvar_names.size() <= look.primvars.size(), "a name that is kept twice");
  scene.camera.world_from_camera = {Affine3f{}};
  scene.camera.window = {{-1.0f, 1.0f, -1.0f, 1.0f}};
  validate(scene);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  FuzzedData data(bytes, size);
  if (data.rarely()) {
    read_texture(data);
    return 0;
  }
  const ShaderNetwork network = fuzzed_network(data);
  const FuzzedTextures textures(data);
  std::vector<Diagnostic> said;
  const auto look = preview_surface(network, textures, said);
  const auto displacement = displacement_of(network, textures, said);
  check_said(said);
  if (look) check_look(*look);
  if (displacement) check_displacement(*displacement, data);
  return 0;
}
