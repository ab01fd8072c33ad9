#include "delegate/translate/look/materialx_nodes.h"

#include <array>
#include <utility>

#include "delegate/translate/look/shader_values.h"

namespace msbvh::translate {
namespace {

// Nodes one behind the other; a circle has no end.
constexpr int kMostNodes = 64;

bool starts(std::string_view text, std::string_view with) { return text.starts_with(with); }

void add_tiling(const ShaderNode& image, ShaderNode& transform) {
  if (const ShaderInput* tiling = image.input("uvtiling")) {
    transform.inputs.push_back(*tiling);
    transform.inputs.back().name = "scale";
  }
  const auto offset = finite_or<2>({}, constant_of(image, "uvoffset"));
  if (offset[0] != 0.0 || offset[1] != 0.0)
    transform.inputs.push_back(constant("translation", std::vector<double>{-offset[0], -offset[1]}));
}

// Where it is read, and what of its file.
void add_file(const ShaderNode& node, ShaderNode& texture) {
  const bool of_usd = starts(node.identifier, "ND_UsdUVTexture");
  const auto take = [&](const char* from, const char* to) {
    const ShaderInput* input = node.input(from);
    if (!input) return;
    texture.inputs.push_back(*input);
    texture.inputs.back().name = to;
  };
  const auto wrap = [&](const char* from, const char* to) {
    const std::string mode = text_of(node, from);
    std::string token = mode == "clamp"      ? "clamp"
                        : mode == "mirror"   ? "mirror"
                        : mode == "constant" ? "black"
                                             : "repeat";
    if (of_usd && !mode.empty() && mode != "periodic") token = mode;
    texture.inputs.push_back(constant(to, token));
  };
  take("file", "file");
  wrap(of_usd ? "wrapS" : "uaddressmode", "wrapS");
  wrap(of_usd ? "wrapT" : "vaddressmode", "wrapT");
  if (of_usd) {
    take("sourceColorSpace", "sourceColorSpace");
    return take("fallback", "fallback");
  }
  // A file of no colour space is taken as it is.
  const ShaderValue* file = constant_of(node, "file");
  const auto* asset = file ? std::get_if<Asset>(&file->data) : nullptr;
  if (asset && asset->color_space.empty())
    texture.inputs.push_back(constant("sourceColorSpace", std::string("raw")));
  const ShaderValue* standard = constant_of(node, "default");
  std::vector<double> fallback = standard ? numbers_of(*standard) : std::vector<double>{};
  if (fallback.size() == 1) fallback.resize(3, fallback[0]);
  if (fallback.size() == 3) fallback.push_back(1.0);
  if (fallback.size() == 4) texture.inputs.push_back(constant("fallback", fallback));
}

}  // namespace

ShaderInput constant(std::string name, ShaderData data) {
  return {std::move(name), ShaderValue{std::move(data), "a value", "MaterialX"}};
}
ShaderInput connected(std::string name, ShaderConnection from) {
  ShaderInput input{std::move(name)};
  input.connections = {std::move(from)};
  return input;
}

const ShaderNode* MaterialxNodes::source_of(const ShaderNode& node, std::string_view name) const {
  const ShaderInput* input = node.input(name);
  return input && !input->connections.empty() ? from_.node(input->connections.front().node) : nullptr;
}

// Once each, by what they are for.
std::string MaterialxNodes::add(ShaderNode node, std::string_view suffix) {
  node.path += suffix;
  if (!to_.node(node.path)) to_.nodes.push_back(node);
  return node.path;
}

std::optional<Drive> MaterialxNodes::drive_of(const ShaderInput& input, const Use& use, int depth) {
  if (!input.connections.empty()) {
    const ShaderNode* node = from_.node(input.connections.front().node);
    if (!node || depth >= kMostNodes) return std::nullopt;
    return through(*node, input.connections.front().output, use, depth + 1);
  }
  std::vector<double> numbers = input.value ? numbers_of(*input.value) : std::vector<double>{};
  if (numbers.empty()) return std::nullopt;
  for (double& number : numbers) number *= use.factor;
  return Drive{std::move(numbers)};
}

std::optional<Drive> MaterialxNodes::through(const ShaderNode& node, const std::string& output,
                                             const Use& use, int depth) {
  const std::string& id = node.identifier;
  const auto behind = [&](const char* name) -> std::optional<Drive> {
    const ShaderInput* input = node.input(name);
    return input ? drive_of(*input, use, depth) : std::nullopt;
  };
  if (starts(id, "ND_image_") || starts(id, "ND_tiledimage_") || starts(id, "ND_UsdUVTexture")) {
    Drive found = image(node, use);
    if (starts(id, "ND_UsdUVTexture") && output != "rgb" && output != "rgba" && output != "out")
      found.from->output = output;
    return found;
  }
  if (starts(id, "ND_geompropvalue_") || starts(id, "ND_UsdPrimvarReader_")) return reader(node, use.width);
  if (starts(id, "ND_constant_")) return behind("value");
  if (starts(id, "ND_normalmap")) return use.normal ? behind("in") : std::nullopt;
  if (starts(id, "ND_dot_") || starts(id, "ND_convert_")) return behind("in");
  if ((starts(id, "ND_extract_") || starts(id, "ND_separate")) && use.width == 1)
    return channel(node, output, behind("in"));
  return std::nullopt;
}

// Of what drives a node that gives one channel of it.
std::optional<Drive> MaterialxNodes::channel(const ShaderNode& node, const std::string& output,
                                             std::optional<Drive> found) {
  if (!found || !found->from) return std::nullopt;
  constexpr std::string_view kChannels[] = {"r", "g", "b", "a"};
  std::size_t channel = 0;
  if (starts(node.identifier, "ND_extract_")) {
    const ShaderValue* index = constant_of(node, "index");
    const double given = index ? as_kind_of(*index, 0.0).value_or(0.0) : 0.0;
    channel = given >= 0.0 && given <= 3.0 ? std::size_t(given) : 0;
  } else {
    for (std::size_t i = 0; i < 4; ++i) {
      if (output == "out" + std::string(kChannels[i]) || output == "out" + std::string(1, "xyzw"[i]))
        channel = i;
    }
  }
  found->from->output = kChannels[channel];
  return found;
}

// That a node of texture coordinates reads.
std::string MaterialxNodes::primvar_of(const ShaderNode* source) {
  std::string primvar = "st";
  if (source && starts(source->identifier, "ND_geompropvalue_")) {
    primvar = text_of(*source, "geomprop");
  } else if (source && starts(source->identifier, "ND_UsdPrimvarReader_")) {
    primvar = text_of(*source, "varname");
  } else if (source && starts(source->identifier, "ND_texcoord_")) {
    const ShaderValue* index = constant_of(*source, "index");
    const double set = index ? as_kind_of(*index, 0.0).value_or(0.0) : 0.0;
    if (set > 0.0) primvar += std::to_string(int(set));
  } else if (source) {
    lost_.push_back("texture coordinates by " + source->identifier + " are taken as st");
  }
  return primvar;
}

ShaderInput MaterialxNodes::coordinates(const ShaderNode& image) {
  const bool of_usd = starts(image.identifier, "ND_UsdUVTexture");
  const ShaderNode* source = source_of(image, of_usd ? "st" : "texcoord");
  ShaderNode transform{image.path, std::string(kTransform2d)};
  if (source && source->identifier == "ND_UsdTransform2d") {
    for (const char* name : {"rotation", "scale", "translation"}) {
      if (const ShaderInput* input = source->input(name)) transform.inputs.push_back(*input);
    }
    source = source_of(*source, "in");
  }
  const std::string primvar = primvar_of(source);
  ShaderNode reader{image.path, std::string(kPrimvarReader) + "_float2", {constant("varname", primvar)}};
  ShaderConnection from{add(std::move(reader), "/st"), "result"};
  if (starts(image.identifier, "ND_tiledimage_")) add_tiling(image, transform);
  if (!transform.inputs.empty()) {
    transform.inputs.push_back(connected("in", from));
    from = {add(std::move(transform), "/transform"), "result"};
  }
  return connected("st", from);
}

// A UsdUVTexture in the mapped network; one that several inputs read alike is one node.
Drive MaterialxNodes::image(const ShaderNode& node, const Use& use) {
  ShaderNode texture{node.path, std::string(kTexture)};
  add_file(node, texture);
  const double factor = use.factor;
  std::array<double, 4> scale{factor, factor, factor, 1.0}, bias{};
  if (starts(node.identifier, "ND_UsdUVTexture")) {
    const auto own = finite_or<4>({1.0, 1.0, 1.0, 1.0}, constant_of(node, "scale"));
    bias = finite_or<4>({}, constant_of(node, "bias"));
    for (std::size_t i = 0; i < 3; ++i) scale[i] *= own[i], bias[i] *= factor;
    scale[3] = own[3];
  } else if (use.normal) {
    scale = {2.0, 2.0, 2.0, 1.0}, bias = {-1.0, -1.0, -1.0, 0.0};
  }
  texture.inputs.push_back(constant("scale", std::vector<double>(scale.begin(), scale.end())));
  texture.inputs.push_back(constant("bias", std::vector<double>(bias.begin(), bias.end())));
  texture.inputs.push_back(coordinates(node));
  const std::string suffix = "/image/" + (use.normal ? std::string("normal") : text(factor));
  return {{}, ShaderConnection{add(std::move(texture), suffix), use.width == 1 ? "r" : "rgb"}};
}

Drive MaterialxNodes::reader(const ShaderNode& node, int width) {
  const std::string& id = node.identifier;
  const bool of_usd = starts(id, "ND_UsdPrimvarReader_");
  const std::string type = id.substr(id.rfind('_'));
  const bool scalar = type == "_float" || type == "_integer";
  ShaderNode reader{node.path, std::string(kPrimvarReader) + (scalar || width == 1 ? "_float" : "_float3")};
  reader.inputs.push_back(constant("varname", text_of(node, of_usd ? "varname" : "geomprop")));
  if (const ShaderInput* standard = node.input(of_usd ? "fallback" : "default")) {
    reader.inputs.push_back(*standard);
    reader.inputs.back().name = "fallback";
  }
  return {{}, ShaderConnection{add(std::move(reader), width == 1 ? "/number" : "/colour"), "result"}};
}

}  // namespace msbvh::translate
