// UsdUVTexture nodes: which image, how it is read, and where; what is said of the rest.
#include <array>
#include <cmath>
#include <doctest/doctest.h>
#include <limits>
#include <string>
#include <vector>

#include "delegate/translate/look/surface_texture.h"
#include "tests/translate/shading_network.h"

using namespace msbvh;
using namespace msbvh::testing;

namespace {

ShaderInput file(std::string name = "wood.png") {
  return constant("file", Asset{name, {"/tex/" + name}}, "@" + name + "@");
}
ShaderInput token(std::string name, std::string value) {
  return constant(std::move(name), value, "'" + value + "'");
}

// A surface whose diffuseColor a texture drives.
struct Textured : Network {
  explicit Textured(std::vector<ShaderInput> inputs) {
    add("Wood", "UsdUVTexture", std::move(inputs));
    surface().inputs = {connected("diffuseColor", "/Look/Wood", "rgb")};
  }
  ShaderNode& texture() { return *std::ranges::find(network.nodes, "/Look/Wood", &ShaderNode::path); }
  ImageTexture image() {
    const SurfaceLook look = *read();
    REQUIRE(look.textures.size() == 1);
    return look.textures.front();
  }
  TextureRead texture_read() {
    const SurfaceLook look = *read();
    REQUIRE(look.material.texture_reads.size() == 1);
    return look.material.texture_reads.front();
  }
};

std::array<float, 2> mapped(const TextureRead& read, float s, float t) {
  const auto& m = read.matrix;
  return {m[0] * s + m[1] * t + read.offset[0], m[2] * s + m[3] * t + read.offset[1]};
}

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

}  // namespace

TEST_CASE("a texture with a file alone has UsdUVTexture's defaults, and says nothing") {
  Textured look({file()});
  const ImageTexture image = look.image();
  CHECK(image.name == "wood.png");
  CHECK(image.tiles == std::vector<TextureTile>{{0, 0, {"/tex/wood.png"}}});
  CHECK_FALSE(image.udim);
  CHECK(image.wrap_s == TextureWrap::kMetadata);
  CHECK(image.wrap_t == TextureWrap::kMetadata);
  CHECK(image.color_space == "auto");
  CHECK(image.fallback == std::array{0.0f, 0.0f, 0.0f, 1.0f});
  const TextureRead read = look.texture_read();
  CHECK(read == TextureRead{});
  CHECK(look.said.empty());
}

TEST_CASE("outputs are channels: one of a number, one as grey or three of a colour") {
  Textured look({file()});
  look.surface().inputs = {connected("diffuseColor", "/Look/Wood", "rgb"),
                           connected("emissiveColor", "/Look/Wood", "g"),
                           connected("opacity", "/Look/Wood", "a"),
                           connected("metallic", "/Look/Wood", "b"),
                           connected("roughness", "/Look/Wood", "r"),
                           connected("clearcoat", "/Look/Wood", "g"),
                           connected("ior", "/Look/Wood", "a")};
  const Material material = look.material();
  const auto check = [&](SurfaceInput input, unsigned channel, bool grey) {
    const DrivenInput* found = driven(material, input);
    REQUIRE(found);
    CHECK(found->source == DrivenInput::Source::kTexture);
    CHECK(found->index == 0);
    CHECK(found->channel == channel);
    CHECK(found->grey == grey);
  };
  check(SurfaceInput::kDiffuseColor, 0, false);
  check(SurfaceInput::kEmissiveColor, 1, true);
  check(SurfaceInput::kOpacity, 3, false);
  check(SurfaceInput::kMetallic, 2, false);
  check(SurfaceInput::kRoughness, 0, false);
  check(SurfaceInput::kClearcoat, 1, false);
  check(SurfaceInput::kIor, 3, false);
  CHECK(material.texture_reads.size() == 1);  // a shared node is read once
  CHECK(look.warnings() == 0);

  look.surface().inputs = {connected("opacity", "/Look/Wood", "rgb"),
                           connected("metallic", "/Look/Wood", "rgb")};
  const Material all = look.material();
  CHECK(driven(all, SurfaceInput::kOpacity)->channel == 3);
  CHECK(driven(all, SurfaceInput::kMetallic)->channel == 0);
  CHECK(look.warnings("inputs:metallic: connected to all channels of a texture, expected one; its red one is "
                      "read") == 1);
  CHECK(look.warnings() == 1);
}

TEST_CASE("nodes that read alike are read once, one image in two ways twice") {
  Textured look({file()});
  look.add("Same", "UsdUVTexture", {file()});
  look.add("Darker", "UsdUVTexture", {file(), constant("scale", numbers({0.5, 0.5, 0.5, 1}))});
  look.surface().inputs = {connected("diffuseColor", "/Look/Wood", "rgb"),
                           connected("roughness", "/Look/Same", "r"),
                           connected("metallic", "/Look/Darker", "r")};
  const SurfaceLook found = *look.read();
  CHECK(found.textures.size() == 1);
  CHECK(found.material.texture_reads.size() == 2);
}

TEST_CASE("wrap modes, scale and bias are as authored; what is wrong is named and counts as the default") {
  Textured look({file(), token("wrapS", "repeat"), token("wrapT", "mirror"),
                 constant("scale", numbers({2, 2, 2, 1})), constant("bias", numbers({-1, -1, -1, 0}))});
  CHECK(look.image().wrap_s == TextureWrap::kRepeat);
  CHECK(look.image().wrap_t == TextureWrap::kMirror);
  CHECK(look.texture_read().scale == std::array{2.0f, 2.0f, 2.0f, 1.0f});
  CHECK(look.texture_read().bias == std::array{-1.0f, -1.0f, -1.0f, 0.0f});
  CHECK(look.warnings() == 0);
  look.texture().inputs = {file(), token("wrapS", "clamp"), token("wrapT", "black")};
  CHECK(look.image().wrap_s == TextureWrap::kClamp);
  CHECK(look.image().wrap_t == TextureWrap::kBlack);

  look.texture().inputs = {file(), token("wrapS", "periodic"),
                           constant("scale", numbers({kNan, 1, 1, 1}), "(nan)"), constant("bias", 1.0, "1")};
  CHECK(look.image().wrap_s == TextureWrap::kMetadata);
  CHECK(look.texture_read().scale == std::array{1.0f, 1.0f, 1.0f, 1.0f});
  CHECK(look.texture_read().bias == std::array{0.0f, 0.0f, 0.0f, 0.0f});
  CHECK(look.warnings("inputs:wrapS: found 'periodic', expected black") == 1);
  CHECK(look.warnings("inputs:scale: found (nan), expected four finite numbers; taken as (1, 1, 1, 1)") == 1);
  CHECK(look.warnings("inputs:bias: found 1, expected four finite numbers; taken as (0, 0, 0, 0)") == 1);
}

TEST_CASE("scale and bias make the authored fallback of the image's") {
  Textured look({file(), constant("fallback", numbers({0.5, 0.25, 1, 0.75})),
                 constant("scale", numbers({2, 4, 0, 1})), constant("bias", numbers({-1, 0.25, 0, 0}))});
  CHECK(look.image().fallback == std::array{0.75f, 0.0f, 1.0f, 0.75f});
}

TEST_CASE("a normal map without a fallback is flat where it cannot be read") {
  Textured look(
      {file(), constant("scale", numbers({2, 2, 2, 1})), constant("bias", numbers({-1, -1, -1, 0}))});
  look.surface().inputs = {connected("normal", "/Look/Wood", "rgb")};
  CHECK(look.image().fallback == std::array{0.5f, 0.5f, 1.0f, 1.0f});
  CHECK_FALSE(driven(look.material(), SurfaceInput::kNormal)->grey);
}

TEST_CASE("sourceColorSpace decides, then what the stage says of the file, then the file") {
  const auto space_of = [](const char* source, const char* metadata) {
    Textured look({constant("file", Asset{"wood.png", {"/wood.png"}, metadata})});
    if (source) look.texture().inputs.push_back(token("sourceColorSpace", source));
    const std::string found = look.image().color_space;
    CHECK(look.warnings() == 0);
    return found;
  };
  CHECK(space_of("raw", "") == "");
  CHECK(space_of("raw", "srgb_ap1_scene") == "");
  CHECK(space_of("sRGB", "lin_ap1_scene") == "srgb_rec709_scene");
  for (const char* left_open : {"auto", static_cast<const char*>(nullptr)}) {
    CHECK(space_of(left_open, "") == "auto");
    CHECK(space_of(left_open, "lin_ap1_scene") == "lin_ap1_scene");
    CHECK(space_of(left_open, "sRGB") == "srgb_rec709_scene");
    for (const char* data : {"raw", "data", "identity", "unknown"}) CHECK(space_of(left_open, data) == "");
  }
  Textured look({file(), token("sourceColorSpace", "linear")});
  CHECK(look.image().color_space == "auto");
  CHECK(look.warnings("inputs:sourceColorSpace: found 'linear', expected raw, sRGB or auto; took auto") == 1);
}

TEST_CASE("a UDIM texture has its tiles' places; one that lies in a package has its bytes' place") {
  struct Packed : TextureSource {
    std::optional<TextureFile> locate(const std::string& path) const override {
      if (path.find("bad") != std::string::npos) return std::nullopt;
      return TextureFile{"/a.usdz", 64, 100};
    }
  };
  Textured look(
      {constant("file", Asset{"w.<UDIM>.png", {"/w.1001.png", "/w.1002.png", "/w.1011.png", "/w.x.png"}})});
  const ImageTexture tiled = look.image();
  CHECK(tiled.udim);
  CHECK(tiled.tiles ==
        std::vector<TextureTile>{{0, 0, {"/w.1001.png"}}, {1, 0, {"/w.1002.png"}}, {0, 1, {"/w.1011.png"}}});
  look.texture().inputs = {constant("file", Asset{"w.png", {"/a.usdz[w.png]"}})};
  CHECK(look.read(Packed())->textures.front().tiles.front().file == TextureFile{"/a.usdz", 64, 100});
  look.texture().inputs = {constant("file", Asset{"w.png", {"/a.usdz[bad.png]"}})};
  CHECK(look.read(Packed())->textures.empty());
  CHECK(look.warnings("@w.png@ lies in a package in a way that it cannot be read, and it has no fallback") ==
        1);
}

TEST_CASE("files that are not there, and what is no file, leave the fallback as a constant") {
  Textured look({constant("file", Asset{"wood.png"}), constant("fallback", numbers({0.5, 0.6, 0.7, 0.8}))});
  look.surface().inputs.push_back(connected("roughness", "/Look/Wood", "g"));
  const Material material = look.material();
  CHECK(material.driven.empty());
  CHECK(material.texture_reads.empty());
  CHECK(material.diffuse_color == Vec3f{0.5f, 0.6f, 0.7f});
  CHECK(material.roughness == 0.6f);
  CHECK(look.warnings("@wood.png@ cannot be found, drawn as its fallback") == 2);
  look.texture().inputs = {constant("file", 1.0, "1")};
  CHECK(look.material().diffuse_color == Vec3f{0.18f, 0.18f, 0.18f});
  CHECK(look.warnings("its file is 1, which names none") == 2);
  look.texture().inputs = {constant("file", Asset{"w.<UDIM>.png"})};
  look.read();
  CHECK(look.warnings("@w.<UDIM>.png@ cannot be found") == 2);
}

TEST_CASE("coordinates are a primvar's, scaled, then turned, then moved, through any number of transforms") {
  Textured look({file(), connected("st", "/Look/Outer", "result")});
  look.add("Outer", "UsdTransform2d",
           {connected("in", "/Look/Inner", "result"), constant("rotation", 90.0),
            constant("scale", numbers({2, 3})), constant("translation", numbers({0.5, 0.25}))});
  look.add("Inner", "UsdTransform2d",
           {connected("in", "/Look/St", "result"), constant("translation", numbers({1, 0}))});
  look.add("St", "UsdPrimvarReader_float2",
           {constant("varname", std::string("uv1")), constant("fallback", numbers({0.25, 0.75}))});
  const SurfaceLook found = *look.read();
  CHECK(found.primvars == std::vector<NeededPrimvar>{{"uv1", 2}});
  const TextureRead read = found.material.texture_reads.front();
  CHECK(read.coordinates == 0);
  CHECK(read.fallback_coordinates == std::array{0.25f, 0.75f});
  // (1, 2): moved to (2, 2), scaled to (4, 6), turned to (-6, 4), moved to (-5.5, 4.25).
  const auto at = mapped(read, 1, 2);
  CHECK(at[0] == doctest::Approx(-5.5f));
  CHECK(at[1] == doctest::Approx(4.25f));
  CHECK(look.warnings() == 0);
}

TEST_CASE("coordinates that are constant, or come from nowhere") {
  Textured look({file(), constant("st", numbers({0.5, 0.25}))});
  CHECK(look.texture_read().fallback_coordinates == std::array{0.5f, 0.25f});
  CHECK(look.texture_read().coordinates == kNoPrimvar);
  look.texture().inputs = {file(), connected("st", "/Look/Move", "result")};
  look.add("Move", "UsdTransform2d",
           {constant("in", numbers({0.5, 0.5})), constant("translation", numbers({1, 2}))});
  CHECK(mapped(look.texture_read(), 0.5f, 0.5f) == std::array{1.5f, 2.5f});
  CHECK(look.texture_read().fallback_coordinates == std::array{0.5f, 0.5f});
  CHECK(look.warnings() == 0);

  look.network.nodes.back() = {"/Look/Move", "UsdPrimvarReader_float3", {}};
  look.read();
  CHECK(look.warnings(
            "inputs:st: connected to a UsdPrimvarReader_float3, which is not evaluated yet; the texture is "
            "read at (0, 0) throughout") == 1);
  look.network.nodes.back() = {"/Look/Move", "UsdPrimvarReader_float2", {}};
  look.read();
  CHECK(look.warnings("inputs:varname: found no name of a primvar") == 1);
}

TEST_CASE("transforms in a circle, of NaN, and beyond all size end in one warning and (0, 0)") {
  Textured look({file(), connected("st", "/Look/Move", "result")});
  look.add("Move", "UsdTransform2d", {connected("in", "/Look/Move", "result")});
  CHECK(look.texture_read() == TextureRead{});
  CHECK(look.warnings("inputs:st: connected to a UsdTransform2d in a circle of them") == 1);
  look.network.nodes.back().inputs = {constant("rotation", kNan, "nan"), constant("scale", numbers({0, 0}))};
  CHECK(look.texture_read().matrix == std::array{0.0f, 0.0f, 0.0f, 0.0f});  // flat, but a map
  CHECK(look.warnings("inputs:rotation: found nan, expected a finite number; taken as 0") == 1);
  look.network.nodes.back().inputs = {constant("scale", numbers({1e30, 1}))};
  CHECK(look.texture_read() == TextureRead{});
  CHECK(look.warnings("inputs:st: UsdTransform2d maps it beyond 2^60") == 1);
}

TEST_CASE("inputs of a texture that another node computes are named, and count as their defaults") {
  Textured look(
      {file(), connected("scale", "/Look/Wood", "rgb"), connected("fallback", "/Look/Wood", "rgb")});
  CHECK(look.texture_read().scale == std::array{1.0f, 1.0f, 1.0f, 1.0f});
  CHECK(look.warnings("connected to another node, which is not evaluated here; its default counts") == 2);
}
