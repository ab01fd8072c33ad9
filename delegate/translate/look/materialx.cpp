#include "delegate/translate/look/materialx.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "delegate/translate/look/materialx_nodes.h"
#include "delegate/translate/look/shader_values.h"

namespace msbvh::translate {
namespace {

constexpr std::string_view kStandard = "ND_standard_surface_surfaceshader";
constexpr std::string_view kOpenPbr = "ND_open_pbr_surface_surfaceshader";
constexpr std::string_view kPreview = "ND_UsdPreviewSurface_surfaceshader";

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
constexpr std::pair<std::string_view, double> kLost[] = {{"diffuse_roughness", 0.0},
                                                         {"specular", 1.0},
                                                         {"specular_weight", 1.0},
                                                         {"specular_anisotropy", 0.0},
                                                         {"transmission", 0.0},
                                                         {"transmission_weight", 0.0},
                                                         {"subsurface", 0.0},
                                                         {"subsurface_weight", 0.0},
                                                         {"sheen", 0.0},
                                                         {"fuzz_weight", 0.0},
                                                         {"thin_film_thickness", 0.0},
                                                         {"thin_film_weight", 0.0},
                                                         {"base_diffuse_roughness", 0.0}};

class Mapper {
 public:
  Mapper(const ShaderNetwork& network, const ShaderNode& surface)
      : from_(network), surface_(surface), nodes_(network, to_, lost_) {}

  ShaderNetwork mapped();
  // What is left out or approximated; empty: nothing.
  std::string lost() const;

 private:
  void map(const Mapping& mapping, ShaderNode& to);
  void copy_preview_surface(ShaderNode& to);
  double weight_of(const Mapping& mapping);
  const ShaderNetwork& from_;
  const ShaderNode& surface_;
  ShaderNetwork to_;
  std::vector<std::string> lost_;
  MaterialxNodes nodes_;
};

std::string Mapper::lost() const {
  std::string all;
  for (const std::string& each : lost_) all += (all.empty() ? "" : ", ") + each;
  return all;
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
  std::optional<Drive> drive = nodes_.drive_of(*input, {weight, width, normal});
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

void Mapper::copy_preview_surface(ShaderNode& to) {
  constexpr std::string_view kColors[] = {"diffuseColor", "emissiveColor", "specularColor"};
  for (const ShaderInput& input : surface_.inputs) {
    const bool color = std::ranges::find(kColors, input.name) != std::end(kColors),
               normal = input.name == "normal";
    if (input.connections.empty()) {
      to.inputs.push_back(input);
      if (input.name == "opacityMode" && input.value) {  // an integer there
        const std::optional<double> mode = as_kind_of(*input.value, 0.0);
        if (mode)
          to.inputs.back() = constant(input.name, std::string(*mode == 0.0 ? "transparent" : "presence"));
      }
    } else if (const auto drive = nodes_.drive_of(input, {1.0, color || normal ? 3 : 1, normal});
               drive && drive->from) {
      to.inputs.push_back(connected(input.name, *drive->from));
    } else if (drive && drive->numbers.size() == (color || normal ? 3u : 1u)) {
      to.inputs.push_back(
          constant(input.name, color || normal ? ShaderData(drive->numbers) : ShaderData(drive->numbers[0])));
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
    for (const Mapping& mapping : standard ? std::span<const Mapping>(kOfStandard) : kOfOpenPbr)
      map(mapping, to);
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
    for (const auto& mappings :
         {std::span<const Mapping>(kOfStandard), std::span<const Mapping>(kOfOpenPbr)}) {
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
      "file",     "default", "texcoord", "uaddressmode",     "vaddressmode", "uvtiling", "uvoffset", "st",
      "wrapS",    "wrapT",   "scale",    "sourceColorSpace", "bias",         "fallback", "varname",  "in",
      "geomprop", "index",   "value",    "rotation",         "translation"};
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
