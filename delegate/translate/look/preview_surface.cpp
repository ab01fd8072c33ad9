#include "delegate/translate/look/preview_surface.h"

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <utility>

#include "delegate/translate/look/constant_textures.h"
#include "delegate/translate/look/materialx.h"
#include "delegate/translate/look/shader_values.h"
#include "delegate/translate/look/surface_texture.h"

namespace msbvh::translate {
namespace {

// UsdPreviewSurface's defaults, and UsdUVTexture's.
constexpr Vec3d kDiffuseColor{0.18, 0.18, 0.18}, kBlack{}, kNormal{0.0, 0.0, 1.0};
constexpr double kMetallic = 0.0, kRoughness = 0.5, kIor = 1.5, kClearcoat = 0.0, kClearcoatRoughness = 0.01;
constexpr double kOpacity = 1.0, kOpacityThreshold = 0.0;
constexpr Rgba kFallback{0.0, 0.0, 0.0, 1.0}, kNormalFallback{0.0, 0.0, 1.0, 1.0};
constexpr std::size_t kAlpha = 3;
constexpr std::string_view kStandardCoordinates = "st";

const char* expected(double) { return "a number"; }
const char* expected(const Vec3d&) { return "three numbers"; }

// A number's first, a colour's first three, the rest 0; of one number it is grey.
double kind_of(std::span<const double> values, double) { return values[0]; }
Vec3d kind_of(std::span<const double> values, const Vec3d&) {
  if (values.size() == 1) return {values[0], values[0], values[0]};
  return {values[0], values[1], values.size() > 2 ? values[2] : 0.0};
}

// How many numbers a UsdPrimvarReader reads; 0: something else.
std::uint32_t width_of(std::string_view reader) {
  constexpr std::pair<std::string_view, std::uint32_t> kTypes[] = {
      {"_float", 1}, {"_int", 1},    {"_float2", 2}, {"_float3", 3},
      {"_point", 3}, {"_normal", 3}, {"_vector", 3}, {"_float4", 4}};
  reader.remove_prefix(kPrimvarReader.size());
  for (const auto& [type, width] : kTypes) {
    if (reader == type) return width;
  }
  return 0;
}

template <typename Kind>
constexpr bool kIsColor = std::is_same_v<Kind, Vec3d>;

class SurfaceReader {
 public:
  SurfaceReader(const ShaderNetwork& network, const ShaderNode& surface, const TextureSource& textures,
                PrimLog log)
      : network_(network), surface_(surface), textures_(textures), log_(std::move(log)) {}

  SurfaceLook look();

 private:
  void read_specular();
  void read_opacity();
  void read_normal();
  // The surface's input of that name: its constant, or what stands where what drives it says nothing.
  template <typename Kind>
  Kind input(std::string_view name, SurfaceInput which, const Kind& standard);
  template <typename Kind>
  Kind connected(const ShaderInput& input, SurfaceInput which, const Kind& standard);
  template <typename Kind>
  Kind textured(const ShaderInput& input, SurfaceInput which, const ShaderNode& texture,
                const Kind& standard);
  template <typename Kind>
  Kind by_primvar(const ShaderInput& input, SurfaceInput which, const ShaderNode& reader,
                  const Kind& standard);
  // From 0 to 1.
  double share(std::string_view name, SurfaceInput which, double standard);
  double refractive_index();
  // Of what nothing may drive.
  double constant(std::string_view name, double standard);
  std::string option(std::string_view name, std::span<const std::string_view> choices);
  bool uses_specular_workflow();

  // Whether the appearance's own displayColor or displayOpacity drives it.
  bool is_by_display(SurfaceInput which, const std::string& primvar, std::uint32_t width);
  // Its number in the material; none: it has no file.
  std::optional<std::uint32_t> texture_read(const ShaderNode& texture, SurfaceInput which, NoFile& no_file);
  PrimvarName primvar(const std::string& name, std::uint32_t width);
  // What a node says is drawn in its place; none: nothing.
  template <typename Kind>
  std::optional<Kind> fallback_of(const ShaderNode& node, const Kind& standard, std::uint32_t width);
  std::string primvar_of(const ShaderNode& reader);
  // `standard`, with a warning, where the value is of another kind.
  template <typename Kind>
  Kind number_or(const Kind& standard, const ShaderValue& value, const Origin& origin);
  void warn_of_change(const ShaderInput& input);
  PrimLog log_at(const std::string& path) const { return log_.of_prim(path); }

  const ShaderNetwork& network_;
  const ShaderNode& surface_;
  const TextureSource& textures_;
  PrimLog log_;  // of the surface
  SurfaceLook look_;
  std::map<std::pair<std::string, bool>, std::optional<std::uint32_t>> reads_;  // by texture, and if a normal
  std::map<std::string, NoFile> no_files_;
};

SurfaceLook SurfaceReader::look() {
  Material& material = look_.material;
  material.name = network_.path;
  material.diffuse_color = Vec3f(input("diffuseColor", SurfaceInput::kDiffuseColor, kDiffuseColor));
  material.emissive_color = Vec3f(input("emissiveColor", SurfaceInput::kEmissiveColor, kBlack));
  read_opacity();
  read_specular();
  read_normal();
  return std::move(look_);
}

void SurfaceReader::read_specular() {
  Material& material = look_.material;
  material.specular_workflow = uses_specular_workflow();
  if (material.specular_workflow) {
    material.specular_color = Vec3f(input("specularColor", SurfaceInput::kSpecularColor, kBlack));
  } else {
    material.metallic = float(share("metallic", SurfaceInput::kMetallic, kMetallic));
  }
  material.roughness = float(share("roughness", SurfaceInput::kRoughness, kRoughness));
  material.ior = float(refractive_index());
  material.clearcoat = float(share("clearcoat", SurfaceInput::kClearcoat, kClearcoat));
  material.clearcoat_roughness =
      float(share("clearcoatRoughness", SurfaceInput::kClearcoatRoughness, kClearcoatRoughness));
  material.specular = reflects(material);
}

// A threshold makes of opacity a presence, whatever the mode says.
void SurfaceReader::read_opacity() {
  constexpr std::string_view kModes[] = {"transparent", "presence"};
  Material& material = look_.material;
  material.opacity = float(input("opacity", SurfaceInput::kOpacity, kOpacity));
  material.opacity_threshold = float(constant("opacityThreshold", kOpacityThreshold));
  const bool presence = option("opacityMode", kModes) == "presence";
  material.transparent_reflects = !presence && !(material.opacity_threshold > 0.0f);
}

// A texture has coordinates of its own; what else bends normals goes along those that USD takes for granted.
void SurfaceReader::read_normal() {
  Material& material = look_.material;
  material.normal = Vec3f(input("normal", SurfaceInput::kNormal, kNormal));
  const auto driven = std::ranges::find(material.driven, SurfaceInput::kNormal, &DrivenInput::input);
  const bool is_driven = driven != material.driven.end();
  if (is_driven ? driven->source == DrivenInput::Source::kPrimvar : Vec3d(material.normal) != kNormal)
    material.normal_coordinates = primvar(std::string(kStandardCoordinates), 2);
}

template <typename Kind>
Kind SurfaceReader::input(std::string_view name, SurfaceInput which, const Kind& standard) {
  const ShaderInput* found = surface_.input(name);
  if (!found) return standard;
  if (!found->connections.empty()) return connected(*found, which, standard);
  warn_of_change(*found);
  return found->value ? number_or(standard, *found->value, origin_of(surface_, *found)) : standard;
}

void SurfaceReader::warn_of_change(const ShaderInput& input) {
  if (input.in_shutter.size() <= 1) return;
  const Origin origin = origin_of(surface_, input);
  log_at(origin.path)
      .warn_in_common(origin.attribute, "changes within the shutter; held the frame's value, as Hydra does");
}

double SurfaceReader::constant(std::string_view name, double standard) {
  const ShaderInput* found = surface_.input(name);
  if (!found) return standard;
  if (!found->connections.empty()) {
    log_.warn_in_common(full_name(name),
                        "connected to another node, which is not evaluated here; taken as " + text(standard));
    return standard;
  }
  warn_of_change(*found);
  return found->value ? number_or(standard, *found->value, origin_of(surface_, *found)) : standard;
}

double SurfaceReader::share(std::string_view name, SurfaceInput which, double standard) {
  const double found = input(name, which, standard);
  const double share = std::clamp(found, 0.0, 1.0);  // NaN stays
  if (found < 0.0 || found > 1.0) {
    const Origin origin = origin_of(surface_, *surface_.input(name));
    log_at(origin.path)
        .warn(origin.attribute, "found " + text(found) + ", expected 0 to 1; taken as " + text(share));
  }
  return share;
}

double SurfaceReader::refractive_index() {
  const double found = input("ior", SurfaceInput::kIor, kIor);
  if (!(found <= 0.0)) return found;
  const Origin origin = origin_of(surface_, *surface_.input("ior"));
  log_at(origin.path)
      .warn(origin.attribute, "found " + text(found) + ", expected a number above 0; taken as " + text(kIor));
  return kIor;
}

// The first choice where none is authored.
std::string SurfaceReader::option(std::string_view name, std::span<const std::string_view> choices) {
  const ShaderValue* value = constant_of(surface_, name);
  const std::string found = text_of(surface_, name);
  if (!value || std::ranges::find(choices, found) != choices.end())
    return value ? found : std::string(choices.front());
  const Origin origin = origin_of(surface_, *surface_.input(name));
  log_at(origin.path)
      .warn(origin.attribute, "found " + value->text + ", expected " + std::string(choices.front()) + " or " +
                                  std::string(choices.back()) + "; took the first");
  return std::string(choices.front());
}

bool SurfaceReader::uses_specular_workflow() {
  const ShaderValue* value = constant_of(surface_, "useSpecularWorkflow");
  if (!value) return false;
  if (const auto* flag = std::get_if<bool>(&value->data)) return *flag;
  return constant("useSpecularWorkflow", 0.0) != 0.0;
}

template <typename Kind>
Kind SurfaceReader::connected(const ShaderInput& input, SurfaceInput which, const Kind& standard) {
  const ShaderNode* node = network_.node(input.connections.front().node);
  if (node && node->identifier == kTexture) return textured(input, which, *node, standard);
  if (node && node->identifier.starts_with(kPrimvarReader) && width_of(node->identifier) != 0)
    return by_primvar(input, which, *node, standard);
  const std::string what = node && !node->identifier.empty() ? node->identifier : "node of no known type";
  const Kind drawn =
      node ? fallback_of(*node, standard, kIsColor<Kind> ? 3 : 1).value_or(standard) : standard;
  log_.warn_in_common(full_name(input.name),
                      "connected to a " + what + ", which is not evaluated; drawn as " + text(drawn));
  return drawn;
}

// Of a texture without a file: its fallback, else the input's default.
template <typename Kind>
Kind SurfaceReader::textured(const ShaderInput& input, SurfaceInput which, const ShaderNode& texture,
                             const Kind& standard) {
  const std::string& output = input.connections.front().output;
  const std::optional<std::size_t> channel = channel_of(output);
  // Of all channels, the last is an opacity.
  const std::size_t one = channel.value_or(which == SurfaceInput::kOpacity ? kAlpha : 0);
  if (!channel && !kIsColor<Kind> && which != SurfaceInput::kOpacity) {
    log_.warn_in_common(full_name(input.name),
                        "connected to all channels of a texture, expected one; its red one is read");
  }
  NoFile no_file;
  if (const std::optional<std::uint32_t> read = texture_read(texture, which, no_file)) {
    const bool grey = kIsColor<Kind> && channel.has_value();
    const bool all = kIsColor<Kind> && !grey;
    look_.material.driven.push_back(
        {which, DrivenInput::Source::kTexture, *read, std::uint8_t(all ? 0 : one), grey});
    return standard;
  }
  const ShaderValue* value = constant_of(texture, "fallback");
  std::vector<double> fallback = value ? numbers_of(*value) : std::vector<double>{};
  Kind drawn = standard;
  if (value && fallback.size() == 4) {
    const std::span<const double> all(fallback);
    drawn = kind_of(kIsColor<Kind> && !channel ? all.first(3) : all.subspan(one, 1), standard);
  } else if (value) {
    drawn = number_or(standard, *value, {texture.path, full_name("fallback")});
  }
  log_.warn_in_common(full_name(input.name),
                      "connected to a " + std::string(kTexture) + "; " + no_file.why +
                          (value ? ", drawn as its fallback, " : ", and it has no fallback: drawn as ") +
                          text(drawn));
  return drawn;
}

std::optional<std::uint32_t> SurfaceReader::texture_read(const ShaderNode& node, SurfaceInput which,
                                                         NoFile& no_file) {
  const bool normal = which == SurfaceInput::kNormal;
  const std::pair key{node.path, normal};
  const auto known = reads_.find(key);
  if (known != reads_.end()) {
    no_file = no_files_[node.path];
    return known->second;
  }
  const std::optional<SurfaceTexture> found =
      surface_texture(node, network_, textures_, normal ? kNormalFallback : kFallback, log_, no_file);
  no_files_[node.path] = no_file;
  if (!found) return reads_[key] = std::nullopt;
  const auto texture = std::ranges::find(look_.textures, found->image);
  TextureRead read;
  read.texture = TextureId(texture - look_.textures.begin());
  if (texture == look_.textures.end()) look_.textures.push_back(found->image);
  const TextureCoordinates& st = found->coordinates;
  if (!st.primvar.empty()) read.coordinates = primvar(st.primvar, 2);
  std::ranges::transform(st.fallback, read.fallback_coordinates.begin(), [](double x) { return float(x); });
  std::ranges::transform(st.matrix, read.matrix.begin(), [](double x) { return float(x); });
  std::ranges::transform(st.offset, read.offset.begin(), [](double x) { return float(x); });
  std::ranges::transform(found->scale, read.scale.begin(), [](double x) { return float(x); });
  std::ranges::transform(found->bias, read.bias.begin(), [](double x) { return float(x); });
  std::vector<TextureRead>& all = look_.material.texture_reads;
  const auto same = std::ranges::find(all, read);
  const auto number = std::uint32_t(same - all.begin());
  if (same == all.end()) all.push_back(read);
  return reads_[key] = number;
}

PrimvarName SurfaceReader::primvar(const std::string& name, std::uint32_t width) {
  const auto found = std::ranges::find(look_.primvars, name, &NeededPrimvar::name);
  const auto number = PrimvarName(found - look_.primvars.begin());
  if (found == look_.primvars.end()) {
    look_.primvars.push_back({name, width});
  } else {
    found->width = std::max(found->width, width);
  }
  return number;
}

bool SurfaceReader::is_by_display(SurfaceInput which, const std::string& primvar, std::uint32_t width) {
  Material& material = look_.material;
  if (primvar == "displayColor" && width >= 3) {
    if (which == SurfaceInput::kDiffuseColor) return material.diffuse_from_display_color = true;
    if (which == SurfaceInput::kEmissiveColor) return material.emissive_from_display_color = true;
  }
  if (primvar == "displayOpacity" && width == 1 && which == SurfaceInput::kOpacity)
    return material.opacity_from_display_opacity = true;
  return false;
}

template <typename Kind>
Kind SurfaceReader::by_primvar(const ShaderInput& input, SurfaceInput which, const ShaderNode& reader,
                               const Kind& standard) {
  const std::uint32_t width = width_of(reader.identifier);
  const Kind fallback = fallback_of(reader, standard, width).value_or(standard);
  const std::string name = primvar_of(reader);
  if (name.empty()) {
    log_.warn_in_common(full_name(input.name), "connected to a " + reader.identifier +
                                                   " that names no primvar; drawn as " + text(fallback));
    return fallback;
  }
  if (!kIsColor<Kind> && width > 1) {
    log_.warn_in_common(full_name(input.name),
                        "connected to a " + reader.identifier + ", expected one number; its first is read");
  }
  if (is_by_display(which, name, width)) return fallback;
  look_.material.driven.push_back(
      {which, DrivenInput::Source::kPrimvar, primvar(name, width), 0, kIsColor<Kind> && width == 1});
  return fallback;
}

template <typename Kind>
std::optional<Kind> SurfaceReader::fallback_of(const ShaderNode& node, const Kind& standard,
                                               std::uint32_t width) {
  const ShaderValue* value = constant_of(node, "fallback");
  if (!value) return std::nullopt;
  const std::vector<double> found = numbers_of(*value);
  if (found.size() == width) return kind_of(found, standard);
  return number_or(standard, *value, {node.path, full_name("fallback")});
}

std::string SurfaceReader::primvar_of(const ShaderNode& reader) {
  const ShaderValue* name = constant_of(reader, "varname");
  if (!name) return {};
  if (const auto* found = std::get_if<std::string>(&name->data)) return *found;
  const Origin origin = origin_of(reader, *reader.input("varname"));
  log_at(origin.path).warn(origin.attribute, "found " + name->type + ", expected token; ignored");
  return {};
}

template <typename Kind>
Kind SurfaceReader::number_or(const Kind& standard, const ShaderValue& value, const Origin& origin) {
  if (const std::optional<Kind> number = as_kind_of(value, standard)) return *number;
  log_at(origin.path)
      .warn(origin.attribute,
            "found " + value.text + ", expected " + expected(standard) + "; drawn as " + text(standard));
  return standard;
}

}  // namespace

std::optional<SurfaceLook> preview_surface(const ShaderNetwork& network, const TextureSource& textures,
                                           std::vector<Diagnostic>& diagnostics) {
  const auto terminal = network.terminals.find("surface");
  const ShaderNode* surface =
      terminal == network.terminals.end() ? nullptr : network.node(terminal->second.node);
  if (surface && surface->identifier == kPreviewSurface) {
    return SurfaceReader(network, *surface, textures, PrimLog(diagnostics, surface->path)).look();
  }
  if (surface && is_materialx_surface(surface->identifier))
    return preview_surface(as_preview_network(network, diagnostics), textures, diagnostics);
  std::string found = "no surface shader that can be read";
  if (surface) {
    found = "a surface shader " + (surface->identifier.empty() ? "of no known type" : surface->identifier);
  }
  PrimLog(diagnostics, network.path)
      .warn_in_common("outputs:surface", "found " + found + ", expected " + std::string(kPreviewSurface) +
                                             "; displayColor shows instead");
  return std::nullopt;
}

}  // namespace msbvh::translate
