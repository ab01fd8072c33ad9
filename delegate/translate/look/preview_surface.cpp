#include "delegate/translate/look/preview_surface.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "delegate/translate/look/shader_values.h"

namespace msbvh::translate {
namespace {

// UsdPreviewSurface's defaults, and UsdUVTexture's.
constexpr Vec3d kDiffuseColor{0.18, 0.18, 0.18}, kEmissiveColor{}, kNormal{0.0, 0.0, 1.0};
constexpr double kOpacity = 1.0, kOpacityThreshold = 0.0;
constexpr Rgba kScale{1.0, 1.0, 1.0, 1.0}, kBias{};

// What an input of the surface is drawn as. Kind: double for a number, Vec3d for a colour.
template <typename Kind>
struct Constant {
  Kind value;
  bool from_primvar = false;  // the one that can be drawn; `value` where a mesh has none
  bool is_mean = false;       // of the texture that it stands for
};

const char* expected(double) { return "a number"; }
const char* expected(const Vec3d&) { return "three numbers"; }

// What an output of a texture gives an input of a kind. Null: all channels, not one.
const double* one_channel(const Rgba& texture, std::string_view output) {
  constexpr std::string_view kOutputs[] = {"r", "g", "b", "a"};
  const auto found = std::ranges::find(kOutputs, output);
  return found == std::end(kOutputs) ? nullptr : &texture[std::size_t(found - std::begin(kOutputs))];
}
// Of all channels, the last is an opacity.
double output_of(const Rgba& texture, std::string_view output, double) {
  const double* channel = one_channel(texture, output);
  return channel ? *channel : texture[3];
}
// One channel is grey.
Vec3d output_of(const Rgba& texture, std::string_view output, const Vec3d&) {
  const double* grey = one_channel(texture, output);
  return grey ? Vec3d{*grey, *grey, *grey} : Vec3d{texture[0], texture[1], texture[2]};
}

class SurfaceReader {
 public:
  SurfaceReader(const ShaderNetwork& network, const ShaderNode& surface, const TextureSource& textures,
                PrimLog log)
      : network_(network), surface_(surface), textures_(textures), log_(std::move(log)) {}

  Material material();

 private:
  void tell_of_the_rest();
  // The surface's input of that name. `primvar`: what it may be driven by.
  template <typename Kind>
  Constant<Kind> input(std::string_view name, const Kind& standard, std::string_view primvar = {});
  template <typename Kind>
  Constant<Kind> connected(const ShaderInput& input, const Kind& standard, std::string_view primvar);
  template <typename Kind>
  Constant<Kind> textured(const ShaderInput& input, const ShaderNode& texture, const Kind& standard);
  std::optional<Rgba> mean_of(const ShaderNode& texture) const;
  // What a node says is drawn in its place; none: nothing. `output`: of a texture, whose fallback may have
  // four channels.
  template <typename Kind>
  std::optional<Kind> fallback_of(const ShaderNode& node, const Kind& standard, const std::string* output);
  std::string primvar_of(const ShaderNode& reader);
  // `standard`, with a warning, where the value is of another kind.
  template <typename Kind>
  Kind number_or(const Kind& standard, const ShaderValue& value, const Origin& origin);
  PrimLog log_at(const std::string& path) const { return log_.of_prim(path); }

  const ShaderNetwork& network_;
  const ShaderNode& surface_;
  const TextureSource& textures_;
  PrimLog log_;  // of the surface
};

Material SurfaceReader::material() {
  tell_of_the_rest();
  const Constant<Vec3d> diffuse = input("diffuseColor", kDiffuseColor, "displayColor");
  const Constant<Vec3d> emissive = input("emissiveColor", kEmissiveColor, "displayColor");
  const Constant<double> opacity = input("opacity", kOpacity, "displayOpacity");
  // The mean of a cutout is how much of it is there: a threshold would make it all or nothing.
  const double threshold =
      opacity.is_mean ? kOpacityThreshold : input("opacityThreshold", kOpacityThreshold).value;
  return {.name = network_.path,
          .diffuse_color = Vec3f(diffuse.value),
          .diffuse_from_display_color = diffuse.from_primvar,
          .emissive_color = Vec3f(emissive.value),
          .emissive_from_display_color = emissive.from_primvar,
          .opacity = float(opacity.value),
          .opacity_from_display_opacity = opacity.from_primvar,
          .opacity_threshold = float(threshold)};
}

// Names what a diffuse surface does not show. Every UsdPreviewSurface has a specular part: one note for all
// of them.
void SurfaceReader::tell_of_the_rest() {
  log_.note_in_common(
      "", "UsdPreviewSurface is drawn as diffuse; specular, metallic and clearcoat are not supported yet");
  const auto tell_unless_neutral = [&](const char* name, const auto& neutral) {
    const ShaderInput* found = surface_.input(name);
    if (found && has_effect(*found, neutral)) {
      log_.warn_in_common(full_name(name), "not supported yet; drawn without it");
    }
  };
  tell_unless_neutral("normal", kNormal);
}

template <typename Kind>
Constant<Kind> SurfaceReader::input(std::string_view name, const Kind& standard, std::string_view primvar) {
  const ShaderInput* found = surface_.input(name);
  if (!found) return {standard};
  if (!found->connections.empty()) return connected(*found, standard, primvar);
  const Origin origin = origin_of(surface_, *found);
  if (found->in_shutter.size() > 1) {
    log_at(origin.path)
        .warn_in_common(origin.attribute,
                        "changes within the shutter; held the frame's value, as Hydra does");
  }
  return {found->value ? number_or(standard, *found->value, origin) : standard};
}

template <typename Kind>
Constant<Kind> SurfaceReader::connected(const ShaderInput& input, const Kind& standard,
                                        std::string_view primvar) {
  const ShaderNode* node = network_.node(input.connections.front().node);
  if (node && node->identifier == kTexture) return textured(input, *node, standard);
  std::string what = node && !node->identifier.empty() ? node->identifier : "node of no known type";
  const Kind drawn = node ? fallback_of(*node, standard, nullptr).value_or(standard) : standard;
  if (what.starts_with(kPrimvarReader)) {
    const std::string read = primvar_of(*node);
    if (!primvar.empty() && read == primvar) return {drawn, true};
    what += " of '" + read + "'";
  }
  log_.warn_in_common(full_name(input.name),
                      "connected to a " + what + ", which is not evaluated yet; drawn as " + text(drawn));
  return {drawn};
}

// What stands in for a texture: its mean, else its fallback, else the input's default.
template <typename Kind>
Constant<Kind> SurfaceReader::textured(const ShaderInput& input, const ShaderNode& texture,
                                       const Kind& standard) {
  const std::string& output = input.connections.front().output;
  Constant<Kind> found{standard};
  std::string drawn;
  if (const std::optional<Rgba> mean = mean_of(texture)) {
    found = {output_of(*mean, output, standard), false, true};
    drawn = "drawn as the mean of its texture";
  } else {
    const std::optional<Kind> fallback = fallback_of(texture, standard, &output);
    found.value = fallback.value_or(standard);
    const ShaderValue* file = constant_of(texture, "file");
    const auto* asset = file ? std::get_if<Asset>(&file->data) : nullptr;
    const std::string why =
        asset && !asset->path.empty() ? "@" + asset->path + "@ cannot be read" : "it names no file";
    drawn = why + (fallback ? ", drawn as its fallback, " : ", and it has no fallback: drawn as ") +
            text(found.value);
  }
  log_.warn_in_common(full_name(input.name),
                      "connected to a " + std::string(kTexture) + ", which is not evaluated yet; " + drawn);
  return found;
}

// With scale and bias.
std::optional<Rgba> SurfaceReader::mean_of(const ShaderNode& texture) const {
  const ShaderValue* file = constant_of(texture, "file");
  const auto* asset = file ? std::get_if<Asset>(&file->data) : nullptr;
  if (!asset || asset->path.empty()) return std::nullopt;
  const ShaderValue* space = constant_of(texture, "sourceColorSpace");
  const auto* named = space ? std::get_if<std::string>(&space->data) : nullptr;
  std::optional<Rgba> mean = textures_.mean(*asset, named ? std::string_view(*named) : "auto");
  if (!mean) return std::nullopt;
  const Rgba scale = finite_or(kScale, constant_of(texture, "scale"));
  const Rgba bias = finite_or(kBias, constant_of(texture, "bias"));
  for (std::size_t i = 0; i < mean->size(); ++i) (*mean)[i] = (*mean)[i] * scale[i] + bias[i];
  return mean;
}

template <typename Kind>
std::optional<Kind> SurfaceReader::fallback_of(const ShaderNode& node, const Kind& standard,
                                               const std::string* output) {
  const ShaderValue* value = constant_of(node, "fallback");
  if (!value) return std::nullopt;
  const std::optional<Rgba> channels = output ? numbers<4>(*value) : std::nullopt;
  if (channels) return output_of(*channels, *output, standard);
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

std::span<const std::string_view> evaluated_inputs(std::string_view identifier) {
  static constexpr std::string_view kOfSurface[] = {
      "diffuseColor", "emissiveColor", "opacity", "opacityThreshold", "normal", "displacement", "fallback"};
  static constexpr std::string_view kOfTexture[] = {
      "file", "sourceColorSpace", "st", "wrapS", "wrapT", "scale", "bias", "fallback"};
  static constexpr std::string_view kOfTransform[] = {"in", "rotation", "scale", "translation", "fallback"};
  static constexpr std::string_view kOfReader[] = {"varname", "fallback"};
  static constexpr std::string_view kOfOthers[] = {"fallback"};
  if (identifier == kPreviewSurface) return kOfSurface;
  if (identifier == kTexture) return kOfTexture;
  if (identifier == kTransform2d) return kOfTransform;
  return identifier.starts_with(kPrimvarReader) ? std::span<const std::string_view>(kOfReader) : kOfOthers;
}

std::optional<Material> preview_surface(const ShaderNetwork& network, const TextureSource& textures,
                                        std::vector<Diagnostic>& diagnostics) {
  const auto terminal = network.terminals.find("surface");
  const ShaderNode* surface =
      terminal == network.terminals.end() ? nullptr : network.node(terminal->second.node);
  if (surface && surface->identifier == kPreviewSurface) {
    return SurfaceReader(network, *surface, textures, PrimLog(diagnostics, surface->path)).material();
  }
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
