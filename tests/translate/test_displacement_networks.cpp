// What networks displace, built by hand: which inputs count, and what is said of the rest.
#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "delegate/translate/look/displacement.h"

using namespace msbvh;
using namespace msbvh::translate;

namespace {

// A ramp of 4 x 2 texels, each channel brighter than the one before.
class Ramp : public TextureSource {
 public:
  std::optional<ScalarImage> channel(const Asset& asset, std::string_view space,
                                     std::size_t channel) const override {
    CHECK(space == "raw");
    if (asset.path != "ramp.exr") return std::nullopt;
    const auto base = float(channel);
    std::vector<float> row{base, base + 0.1f, base + 0.2f, base + 0.3f}, values = row;
    values.insert(values.end(), row.begin(), row.end());
    if (bad) values[5] = *bad;
    return ScalarImage{4, 2, values, "repeat", "mirror"};
  }
  std::optional<float> bad{};
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
      "/Look",
      {{"/Look/Surface", "UsdPreviewSurface"}},
      {{"surface", {"/Look/Surface", "surface"}}, {"displacement", {"/Look/Surface", "displacement"}}}};
  Ramp textures;
  std::vector<Diagnostic> said;

  ShaderNode& surface() { return network.nodes.front(); }
  ShaderNode& add(std::string name, std::string identifier, std::vector<ShaderInput> inputs) {
    return network.nodes.emplace_back(ShaderNode{"/Look/" + name, std::move(identifier), std::move(inputs)});
  }
  void texture(std::vector<ShaderInput> inputs, std::string output = "r") {
    inputs.push_back(constant("sourceColorSpace", std::string("raw")));
    add("Texture", "UsdUVTexture", std::move(inputs));
    surface().inputs = {connected("displacement", "/Look/Texture", std::move(output))};
  }
  std::optional<Displacement> read() {
    said.clear();
    return displacement_of(network, textures, said);
  }
  std::size_t messages(Severity severity, const std::string& text) const {
    return std::size_t(std::ranges::count_if(said, [&](const Diagnostic& d) {
      return d.severity == severity &&
             (d.path + "." + d.attribute + ": " + d.message).find(text) != std::string::npos;
    }));
  }
  bool is_silent() const { return said.empty(); }
};

const ShaderInput kFile = constant("file", Asset{"ramp.exr", {"/ramp.exr"}});

}  // namespace

TEST_CASE("a constant displaces where the material's displacement is connected, and only there") {
  Network look;
  look.surface().inputs = {constant("displacement", 0.25)};
  CHECK(look.read()->constant == 0.25);
  CHECK(look.is_silent());
  look.network.terminals.erase("displacement");
  CHECK_FALSE(look.read());
  CHECK(look.messages(Severity::kNote,
                      "/Look/Surface.inputs:displacement: the material's outputs:displacement is "
                      "not connected") == 1);
  look.surface().inputs = {constant("displacement", 0.0)};
  CHECK_FALSE(look.read());
  CHECK(look.is_silent());
}

TEST_CASE("nothing is displaced, without a word, by 0, by no value and without the input") {
  Network look;
  CHECK_FALSE(look.read());
  look.surface().inputs = {constant("displacement", 0.0)};
  CHECK_FALSE(look.read());
  look.surface().inputs = {ShaderInput{"displacement"}};
  CHECK_FALSE(look.read());
  CHECK(look.is_silent());
}

TEST_CASE("what is no distance is named, and the surface stays where it is") {
  Network look;
  const auto complaint = [&](ShaderData data, const std::string& found) {
    look.surface().inputs = {constant("displacement", std::move(data), "the value")};
    CHECK_FALSE(look.read());
    CHECK(look.said.size() == 1);
    return look.messages(Severity::kWarning, "/Look/Surface.inputs:displacement: found " + found +
                                                 ", expected a finite number of at most 2^40 in size");
  };
  CHECK(complaint(std::nan(""), "nan") == 1);
  CHECK(complaint(1e30, "1e+30") == 1);
  CHECK(complaint(-std::numeric_limits<double>::infinity(), "-inf") == 1);
  CHECK(complaint(std::string("high"), "the value") == 1);
}

TEST_CASE("a value that changes within the shutter is held") {
  Network look;
  ShaderInput moving = constant("displacement", 0.5);
  moving.in_shutter = {ShaderValue{0.5}, ShaderValue{1.0}};
  look.surface().inputs = {moving};
  CHECK(look.read()->constant == 0.5);
  CHECK(look.messages(Severity::kWarning, "changes within the shutter; held the frame's value") == 1);
}

TEST_CASE("a reader of numbers names its primvar, and falls back") {
  Network look;
  look.add("Reader", "UsdPrimvarReader_float",
           {constant("varname", std::string("height")), constant("fallback", 0.5)});
  look.surface().inputs = {connected("displacement", "/Look/Reader", "result")};
  const Displacement found = *look.read();
  CHECK(found.primvar == "height");
  CHECK(found.needed_primvar() == "height");
  CHECK(found.constant == 0.5);
  CHECK(look.is_silent());
}

TEST_CASE("other nodes are named, and so is a shader that is no preview surface") {
  Network look;
  look.add("Noise", "MyNoise", {});
  look.surface().inputs = {connected("displacement", "/Look/Noise", "out")};
  CHECK_FALSE(look.read());
  CHECK(look.messages(Severity::kWarning, "connected to a MyNoise, which is not evaluated yet") == 1);
  look.network.terminals["displacement"] = {"/Look/Noise", "out"};
  CHECK_FALSE(look.read());
  CHECK(look.messages(Severity::kWarning,
                      "/Look.outputs:displacement: found a displacement shader MyNoise") == 1);
}

TEST_CASE("a texture's channel is scaled and biased, and wraps as node and file say") {
  Network look;
  look.texture({kFile, constant("scale", numbers({1, 2, 3, 4})), constant("bias", numbers({5, 6, 7, 8})),
                constant("wrapT", std::string("clamp"))},
               "g");
  const Displacement found = *look.read();
  CHECK(look.is_silent());
  CHECK(found.scale == 2.0);
  CHECK(found.bias == 6.0);
  const ScalarTexture& texture = *found.texture;
  CHECK(texture.at(0.125, 0.5, 0, 0) == doctest::Approx(1.0));
  CHECK(texture.at(0.875, 0.5, 0, 0) == doctest::Approx(1.3));
  CHECK(texture.at(1.125, 0.5, 0, 0) == doctest::Approx(1.0));  // the file says repeat
  CHECK(texture.at(0.125, 7.0, 0, 0) == doctest::Approx(1.0));  // the node says clamp
}

TEST_CASE("texture coordinates go through transforms, the innermost first") {
  Network look;
  look.add("Reader", "UsdPrimvarReader_float2",
           {constant("varname", std::string("st")), constant("fallback", numbers({0.5, 0.25}))});
  look.add("Inner", "UsdTransform2d",
           {connected("in", "/Look/Reader", "result"), constant("scale", numbers({2, 3})),
            constant("translation", numbers({1, 0}))});
  look.add("Outer", "UsdTransform2d",
           {connected("in", "/Look/Inner", "result"), constant("rotation", 90.0),
            constant("translation", numbers({0, 10}))});
  look.texture({kFile, connected("st", "/Look/Outer", "result")});
  const TextureCoordinates st = look.read()->coordinates;
  CHECK(look.is_silent());
  CHECK(st.primvar == "st");
  CHECK(st.fallback == std::array{0.5, 0.25});
  // (0.5, 0.25) -> (1, 0.75) + (1, 0) -> turned by 90 degrees (-0.75, 2) + (0, 10)
  const auto mapped = st.mapped(0.5, 0.25);
  CHECK(mapped[0] == doctest::Approx(-0.75));
  CHECK(mapped[1] == doctest::Approx(12.0));
}

TEST_CASE("transforms in a circle end") {
  Network look;
  look.add("A", "UsdTransform2d", {connected("in", "/Look/B", "result")});
  look.add("B", "UsdTransform2d", {connected("in", "/Look/A", "result")});
  look.texture({kFile, connected("st", "/Look/A", "result")});
  CHECK(look.read()->coordinates.primvar.empty());
  CHECK(look.messages(Severity::kWarning, "inputs:st: connected to a UsdTransform2d") == 1);
}

TEST_CASE("a texture that cannot be read is its fallback, without scale and bias") {
  Network look;
  look.texture({constant("file", Asset{"missing.exr", {}}), constant("fallback", numbers({0.125, 0, 0, 1})),
                constant("scale", numbers({9, 9, 9, 9}))});
  CHECK(look.read()->constant == 0.125);
  CHECK(look.messages(Severity::kWarning, "@missing.exr@ cannot be read: displaced by its fallback, 0.125") ==
        1);
  look.network.nodes.pop_back();
  look.texture({}, "a");
  CHECK(look.read()->constant == 1.0);
  CHECK(look.messages(Severity::kWarning, "it names no file: displaced by its fallback, 1") == 1);
}

TEST_CASE("texels that are no numbers and distances beyond all scenes displace nothing, with one message") {
  Network look;
  look.textures.bad = std::numeric_limits<float>::quiet_NaN();
  look.texture({kFile});
  CHECK_FALSE(look.read());
  CHECK(look.messages(Severity::kWarning, "@ramp.exr@ has a texel of nan") == 1);
  CHECK(look.said.size() == 1);
  look.textures.bad = 1e30f;
  CHECK_FALSE(look.read());
  CHECK(look.messages(Severity::kWarning, "found up to 1e+30, expected a finite number") == 1);
  CHECK(look.said.size() == 1);
}

TEST_CASE("tiles lie where their numbers say; what is no tile is left out") {
  struct Tiles : TextureSource {
    std::optional<ScalarImage> channel(const Asset& asset, std::string_view, std::size_t) const override {
      if (asset.files.front().find("1002") != std::string::npos) return ScalarImage{1, 1, {2.0f}};
      return asset.files.front().find("1011") != std::string::npos ? std::optional(ScalarImage{1, 1, {3.0f}})
                                                                   : std::nullopt;
    }
  } tiles;
  Network look;
  look.texture({constant("file", Asset{"a/rough.<UDIM>.exr",
                                       {"/a/rough.1001.exr", "/a/rough.1002.exr", "/p.usdz[a/rough.1011.exr]",
                                        "/a/rough.0002.exr", "/a/rough.exr"}})});
  const Displacement found = *displacement_of(look.network, tiles, look.said);
  CHECK(look.is_silent());
  const ScalarTexture& texture = *found.texture;
  CHECK(texture.at(1.5, 0.5, 0, 0) == 2.0);
  CHECK(texture.at(0.5, 1.5, 0, 0) == 3.0);
  CHECK(texture.at(0.5, 0.5, 0, 0) == 0.0);  // cannot be read
  CHECK(texture.at(2.0, 1.0, 0, 0) == 2.0);  // an edge belongs to its tile
  CHECK(texture.at(2.1, 0.5, 0, 0) == 0.0);
  CHECK(texture.at(1e30, -1e30, 0, 0) == 0.0);
  CHECK(texture.least() == 0.0);
  CHECK(texture.largest() == 3.0);
}
