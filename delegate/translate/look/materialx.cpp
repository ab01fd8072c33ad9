#include "delegate/translate/look/materialx.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "delegate/translate/look/shader_values.h"

namespace msbvh::translate {
namespace {

constexpr std::string_view kStandard = "ND_standard_surface_surfaceshader";
constexpr std::string_view kOpenPbr = "ND_open_pbr_surface_surfaceshader";
constexpr std::string_view kPreview = "ND_UsdPreviewSurface_surfaceshader";
// Nodes one behind the other; a circle has no end.
constexpr int kMostNodes = 64;

// An input of a MaterialX surface, by which another may be multiplied, as one of UsdPreviewSurface, with the
// defaults of both.
struct Mapping {
  std::string_view from, weight, to;
  double standard, standard_weight;  // of all numbers of a vector
  int width;                         // 3 for a colour, 1 for a number, 0 for a normal
};
constexpr Mapping kOfStandard[] = {{"base_color", "base", "diffuseColor", 0.8, 1.0, 3},
                                   {"emission_color", "emission", "emissiveColor", 1.0, 0.0, 3},
                                   {"metalness", "", "metallic", 0.0, 1.0, 1},
                                   {"specular_roughness", "", "roughness", 0.2, 1.0, 1},
                                   {"specular_IOR", "", "ior", 1.5, 1.0, 1},
                                   {"coat", "", "clearcoat", 0.0, 1.0, 1},
                                   {"coat_roughness", "", "clearcoatRoughness", 0.1, 1.0, 1},
                                   {"opacity", "", "opacity", 1.0, 1.0, 1},
                                   {"normal", "", "normal", 0.0, 1.0, 0}};
constexpr Mapping kOfOpenPbr[] = {{"base_color", "base_weight", "diffuseColor", 0.8, 1.0, 3},
                                  {"emission_color", "emission_luminance", "emissiveColor", 1.0, 0.0, 3},
                                  {"base_metalness", "", "metallic", 0.0, 1.0, 1},
                                  {"specular_roughness", "", "roughness", 0.3, 1.0, 1},
                                  {"specular_ior", "", "ior", 1.5, 1.0, 1},
                                  {"coat_weight", "", "clearcoat", 0.0, 1.0, 1},
                                  {"coat_roughness", "", "clearcoatRoughness", 0.0, 1.0, 1},
                                  {"geometry_opacity", "", "opacity", 1.0, 1.0, 1},
                                  {"geometry_normal", "", "normal", 0.0, 1.0, 0}};
// What else of a surface shows unless it is neutral.
constexpr std::pair<std::string_view, double> kLost[] = {
    {"diffuse_roughness", 0.0},    {"specular", 1.0},           {"specular_weight", 1.0},
    {"specular_anisotropy", 0.0},  {"transmission", 0.0},       {"transmission_weight", 0.0},
    {"subsurface", 0.0},           {"subsurface_weight", 0.0},  {"sheen", 0.0},
    {"fuzz_weight", 0.0},          {"thin_film_thickness", 0.0}, {"thin_film_weight", 0.0},
    {"base_diffuse_roughness", 0.0}};

bool starts(std::string_view text, std::string_view with) { return text.starts_with(with); }

// What drives an input: a constant's numbers, or another node.
struct Drive {
  std::vector<double> numbers{};
  std::optional<ShaderConnection> from{};
};

ShaderInput constant(std::string name, ShaderData data) {
  return {std::move(name), ShaderValue{std::move(data), "a value", "MaterialX"}};
}
ShaderInput connected(std::string name, ShaderConnection from) {
  ShaderInput input{std::move(name)};
  input.connections = {std::move(from)};
  return input;
}

class Mapper {
 public:
  Mapper(const ShaderNetwork& network, const ShaderNode& surface) : from_(network), surface_(surface) {}

  ShaderNetwork mapped();
  // What is left out or approximated; empty: nothing.
  std::string lost() const;

 private:
  void map(const Mapping& mapping, ShaderNode& to);
  void copy_preview_surface(ShaderNode& to);
  double weight_of(const Mapping& mapping);
  std::optional<Drive> drive_of(const ShaderInput& input, double factor, int width, bool normal, int depth);
  std::optional<Drive> through(const ShaderNode& node, const std::string& output, double factor, int width,
                               bool normal, int depth);
  // A UsdUVTexture in the mapped network.
  Drive image(const ShaderNode& node, double factor, int width, bool normal);
  Drive reader(const ShaderNode& node, int width);
  ShaderInput coordinates(const ShaderNode& image);
  const ShaderNode* source_of(const ShaderNode& node, std::string_view name) const;
  std::string add(ShaderNode node, std::string_view suffix);

  const ShaderNetwork& from_;
  const ShaderNode& surface_;
  ShaderNetwork to_;
  std::vector<std::string> lost_;
};

std::string Mapper::lost() const {
  std::string all;
  for (const std::string& each : lost_) all += (all.empty() ? "" : ", ") + each;
  return all;
}

const ShaderNode* Mapper::source_of(const ShaderNode& node, std::string_view name) const {
  const ShaderInput* input = node.input(name);
  return input && !input->connections.empty() ? from_.node(input->connections.front().node) : nullptr;
}

// Once each, by what they are for.
std::string Mapper::add(ShaderNode node, std::string_view suffix) {
  node.path += suffix;
  if (!to_.node(node.path)) to_.nodes.push_back(node);
  return node.path;
}

double Mapper::weight_of(const Mapping& mapping) {
  if (mapping.weight.empty()) return 1.0;
  const ShaderInput* input = surface_.input(mapping.weight);
  if (!input) return mapping.standard_weight;
  const std::optional<double> found =
      input->connections.empty() && input->value ? as_kind_of(*input->value, 0.0) : std::nullopt;
  if (found) return *found;
  lost_.push_back(std::string(mapping.weight) + " taken as 1");
  return 1.0;
}

void Mapper::map(const Mapping& mapping, ShaderNode& to) {
  const double weight = weight_of(mapping);
  const ShaderInput* input = surface_.input(mapping.from);
  const std::string name(mapping.to);
  const bool normal = mapping.width == 0;
  if (!input) {
    if (normal) return;
    const std::vector<double> standard(std::size_t(mapping.width), mapping.standard * weight);
    to.inputs.push_back(constant(name, mapping.width == 1 ? ShaderData(standard[0]) : ShaderData(standard)));
    return;
  }
  const int width = normal ? 3 : mapping.width;
  std::optional<Drive> drive = drive_of(*input, weight, width, normal, 0);
  if (!drive) {
    lost_.push_back(std::string(mapping.from) + " is not evaluated");
    if (normal) return;
    drive = Drive{std::vector<double>(std::size_t(width), mapping.standard * weight)};
  }
  if (drive->from) {
    to.inputs.push_back(connected(name, *drive->from));
    return;
  }
  std::vector<double>& numbers = drive->numbers;
  if (width == 1) {  // of a colour, its mean
    double sum = 0.0;
    for (const double number : numbers) sum += number;
    to.inputs.push_back(constant(name, sum / double(numbers.size())));
  } else {
    if (numbers.size() == 1) numbers.resize(3, numbers[0]);
    numbers.resize(3, 0.0);
    to.inputs.push_back(constant(name, numbers));
  }
}

std::optional<Drive> Mapper::drive_of(const ShaderInput& input, double factor, int width, bool normal,
                                      int depth) {
  if (!input.connections.empty()) {
    const ShaderNode* node = from_.node(input.connections.front().node);
    if (!node || depth >= kMostNodes) return std::nullopt;
    return through(*node, input.connections.front().output, factor, width, normal, depth + 1);
  }
  std::vector<double> numbers = input.value ? numbers_of(*input.value) : std::vector<double>{};
  if (numbers.empty()) return std::nullopt;
  for (double& number : numbers) number *= factor;
  return Drive{std::move(numbers)};
}

std::optional<Drive> Mapper::through(const ShaderNode& node, const std::string& output, double factor,
                                     int width, bool normal, int depth) {
  const std::string& id = node.identifier;
  const auto behind = [&](const char* name) -> std::optional<Drive> {
    const ShaderInput* input = node.input(name);
    return input ? drive_of(*input, factor, width, normal, depth) : std::nullopt;
  };
  if (starts(id, "ND_image_") || starts(id, "ND_tiledimage_") || starts(id, "ND_UsdUVTexture")) {
    Drive found = image(node, factor, width, normal);
    if (starts(id, "ND_UsdUVTexture") && output != "rgb" && output != "rgba" && output != "out")
      found.from->output = output;
    return found;
  }
  if (starts(id, "ND_geompropvalue_") || starts(id, "ND_UsdPrimvarReader_")) return reader(node, width);
  if (starts(id, "ND_constant_")) return behind("value");
  if (starts(id, "ND_normalmap")) return normal ? behind("in") : std::nullopt;
  if (starts(id, "ND_dot_") || starts(id, "ND_convert_")) return behind("in");
  const bool extract = starts(id, "ND_extract_"), separate = starts(id, "ND_separate");
  if ((extract || separate) && width == 1) {
    std::optional<Drive> found = behind("in");
    if (!found || !found->from) return std::nullopt;
    constexpr std::string_view kChannels[] = {"r", "g", "b", "a"};
    std::size_t channel = 0;
    if (extract) channel = std::size_t(std::clamp(constant_of(node, "index")
                                                      ? as_kind_of(*constant_of(node, "index"), 0.0).value_or(0.0)
                                                      : 0.0,
                                                  0.0, 3.0));
    for (std::size_t i = 0; separate && i < 4; ++i) {
      if (output == "out" + std::string(kChannels[i]) || output == "out" + std::string(1, "xyzw"[i])) channel = i;
    }
    found->from->output = kChannels[channel];
    return found;
  }
  return std::nullopt;
}

ShaderInput Mapper::coordinates(const ShaderNode& image) {
  const bool of_usd = starts(image.identifier, "ND_UsdUVTexture");
  const ShaderNode* source = source_of(image, of_usd ? "st" : "texcoord");
  std::string primvar = "st";
  ShaderNode transform{image.path, std::string(kTransform2d)};
  if (source && source->identifier == "ND_UsdTransform2d") {
    for (const char* name : {"rotation", "scale", "translation"}) {
      if (const ShaderInput* input = source->input(name)) transform.inputs.push_back(*input);
    }
    source = source_of(*source, "in");
  }
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
  ShaderNode reader{image.path, std::string(kPrimvarReader) + "_float2", {constant("varname", primvar)}};
  ShaderConnection from{add(std::move(reader), "/st"), "result"};
  if (starts(image.identifier, "ND_tiledimage_")) {
    if (const ShaderInput* tiling = image.input("uvtiling")) {
      transform.inputs.push_back(*tiling);
      transform.inputs.back().name = "scale";
    }
    const auto offset = finite_or<2>({}, constant_of(image, "uvoffset"));
    if (offset[0] != 0.0 || offset[1] != 0.0)
      transform.inputs.push_back(constant("translation", std::vector<double>{-offset[0], -offset[1]}));
  }
  if (!transform.inputs.empty()) {
    transform.inputs.push_back(connected("in", from));
    from = {add(std::move(transform), "/transform"), "result"};
  }
  return connected("st", from);
}

Drive Mapper::image(const ShaderNode& node, double factor, int width, bool normal) {
  const bool of_usd = starts(node.identifier, "ND_UsdUVTexture");
  ShaderNode texture{node.path, std::string(kTexture)};
  const auto take = [&](const char* from, const char* to) {
    const ShaderInput* input = node.input(from);
    if (!input) return;
    texture.inputs.push_back(*input);
    texture.inputs.back().name = to;
  };
  const auto wrap = [&](const char* from, const char* to) {
    const std::string mode = text_of(node, from);
    const char* token = mode == "clamp"      ? "clamp"
                        : mode == "mirror"   ? "mirror"
                        : mode == "constant" ? "black"
                                             : "repeat";
    if (of_usd && !mode.empty() && mode != "periodic") {
      texture.inputs.push_back(constant(to, mode));
    } else {
      texture.inputs.push_back(constant(to, std::string(token)));
    }
  };
  take("file", "file");
  wrap(of_usd ? "wrapS" : "uaddressmode", "wrapS");
  wrap(of_usd ? "wrapT" : "vaddressmode", "wrapT");
  const ShaderValue* file = constant_of(node, "file");
  const auto* asset = file ? std::get_if<Asset>(&file->data) : nullptr;
  // A file of no colour space is taken as it is, except of UsdUVTexture.
  if (of_usd) {
    take("sourceColorSpace", "sourceColorSpace");
    take("fallback", "fallback");
  } else if (asset && asset->color_space.empty()) {
    texture.inputs.push_back(constant("sourceColorSpace", std::string("raw")));
  }
  if (const ShaderValue* standard = of_usd ? nullptr : constant_of(node, "default")) {
    std::vector<double> fallback = numbers_of(*standard);
    if (fallback.size() == 1) fallback.resize(3, fallback[0]);
    if (fallback.size() == 3) fallback.push_back(1.0);
    if (fallback.size() == 4) texture.inputs.push_back(constant("fallback", fallback));
  }
  std::array<double, 4> scale{factor, factor, factor, 1.0}, bias{};
  if (of_usd) {
    const auto own = finite_or<4>({1.0, 1.0, 1.0, 1.0}, constant_of(node, "scale"));
    bias = finite_or<4>({}, constant_of(node, "bias"));
    for (std::size_t i = 0; i < 3; ++i) scale[i] *= own[i], bias[i] *= factor;
    scale[3] = own[3];
  } else if (normal) {
    scale = {2.0, 2.0, 2.0, 1.0}, bias = {-1.0, -1.0, -1.0, 0.0};
  }
  texture.inputs.push_back(constant("scale", std::vector<double>(scale.begin(), scale.end())));
  texture.inputs.push_back(constant("bias", std::vector<double>(bias.begin(), bias.end())));
  texture.inputs.push_back(coordinates(node));
  // One that several inputs read alike is one node.
  const std::string suffix = "/image" + (normal ? std::string("/normal") : "/" + text(factor));
  return {{}, ShaderConnection{add(std::move(texture), suffix), width == 1 ? "r" : "rgb"}};
}

Drive Mapper::reader(const ShaderNode& node, int width) {
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

void Mapper::copy_preview_surface(ShaderNode& to) {
  constexpr std::string_view kColors[] = {"diffuseColor", "emissiveColor", "specularColor"};
  for (const ShaderInput& input : surface_.inputs) {
    const bool color = std::ranges::find(kColors, input.name) != std::end(kColors), normal = input.name == "normal";
    if (input.connections.empty()) {
      to.inputs.push_back(input);
      if (input.name == "opacityMode" && input.value) {  // an integer there
        const std::optional<double> mode = as_kind_of(*input.value, 0.0);
        if (mode) to.inputs.back() = constant(input.name, std::string(*mode == 0.0 ? "transparent" : "presence"));
      }
    } else if (const auto drive = drive_of(input, 1.0, color || normal ? 3 : 1, normal, 0); drive && drive->from) {
      to.inputs.push_back(connected(input.name, *drive->from));
    } else if (drive && drive->numbers.size() == (color || normal ? 3u : 1u)) {
      to.inputs.push_back(constant(input.name, color || normal ? ShaderData(drive->numbers) : ShaderData(drive->numbers[0])));
    } else {
      lost_.push_back(input.name + " is not evaluated");
    }
  }
}

ShaderNetwork Mapper::mapped() {
  to_.path = from_.path;
  to_.terminals = from_.terminals;
  ShaderNode to{surface_.path, std::string(kPreviewSurface)};
  if (surface_.identifier == kPreview) {
    copy_preview_surface(to);
  } else {
    const bool standard = surface_.identifier == kStandard;
    for (const Mapping& mapping : standard ? std::span<const Mapping>(kOfStandard) : kOfOpenPbr) map(mapping, to);
    for (const auto& [name, neutral] : kLost) {
      const ShaderInput* input = surface_.input(name);
      if (input && has_effect(*input, neutral)) lost_.push_back(std::string(name) + " is left out");
    }
  }
  to_.nodes.push_back(std::move(to));
  return std::move(to_);
}

}  // namespace

bool is_materialx_surface(std::string_view identifier) {
  return identifier == kStandard || identifier == kOpenPbr || identifier == kPreview;
}

std::span<const std::string_view> materialx_inputs(std::string_view identifier) {
  static const std::vector<std::string_view> kOfSurfaces = [] {
    std::vector<std::string_view> names;
    for (const auto& mappings : {std::span<const Mapping>(kOfStandard), std::span<const Mapping>(kOfOpenPbr)}) {
      for (const Mapping& mapping : mappings) {
        names.push_back(mapping.from);
        if (!mapping.weight.empty()) names.push_back(mapping.weight);
      }
    }
    for (const auto& [name, neutral] : kLost) names.push_back(name);
    std::ranges::sort(names);
    names.erase(std::unique(names.begin(), names.end()), names.end());
    return names;
  }();
  static constexpr std::string_view kOfNodes[] = {
      "file",    "default", "texcoord", "uaddressmode", "vaddressmode",     "uvtiling", "uvoffset",
      "st",      "wrapS",   "wrapT",    "scale",        "sourceColorSpace", "bias",     "fallback",
      "varname", "in",      "geomprop", "index",        "value",            "rotation", "translation"};
  if (identifier == kStandard || identifier == kOpenPbr) return kOfSurfaces;
  return identifier.starts_with("ND_") ? std::span<const std::string_view>(kOfNodes)
                                       : std::span<const std::string_view>();
}

ShaderNetwork as_preview_network(const ShaderNetwork& network, std::vector<Diagnostic>& diagnostics) {
  const ShaderNode* surface = network.node(network.terminals.at("surface").node);
  Mapper mapper(network, *surface);
  ShaderNetwork mapped = mapper.mapped();
  const std::string lost = mapper.lost();
  PrimLog log(diagnostics, surface->path);
  const std::string what = surface->identifier + " is drawn as a UsdPreviewSurface";
  if (!lost.empty()) {
    log.warn_in_common("", what + "; " + lost);
  } else if (surface->identifier != kPreview) {
    log.note_in_common("", what);
  }
  return mapped;
}

}  // namespace msbvh::translate
