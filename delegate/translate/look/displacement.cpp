#include "delegate/translate/look/displacement.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "delegate/translate/look/shader_values.h"
#include "delegate/translate/look/udim.h"

namespace msbvh::translate {
namespace {

constexpr double kNone = 0.0;
constexpr Rgba kScale{1.0, 1.0, 1.0, 1.0}, kBias{}, kFallback{0.0, 0.0, 0.0, 1.0};
// An output's channel; of all of them the first.
std::size_t channel_of(std::string_view output) {
  constexpr std::string_view kOutputs[] = {"r", "g", "b", "a"};
  const auto found = std::ranges::find(kOutputs, output);
  return found == std::end(kOutputs) ? 0 : std::size_t(found - std::begin(kOutputs));
}

bool is_distance(double value) { return std::abs(value) <= kMaxDistance; }
const char* expected_distance() { return ", expected a finite number of at most 2^40 in size"; }

class DisplacementReader {
 public:
  DisplacementReader(const ShaderNetwork& network, const ShaderNode& surface, const TextureSource& textures,
                     PrimLog log)
      : network_(network), surface_(surface), textures_(textures), log_(std::move(log)) {}

  std::optional<Displacement> read(const ShaderInput& input);

 private:
  std::optional<Displacement> constant(const ShaderInput& input);
  std::optional<Displacement> connected(const ShaderInput& input);
  std::optional<Displacement> textured(const ShaderInput& input, const ShaderNode& texture);
  std::vector<ScalarTile> images_of(const ShaderNode& texture, const Asset& asset, std::size_t channel) const;
  bool check_texels(const ShaderNode& texture, const Asset& asset, const std::vector<ScalarTile>& images);
  std::optional<Displacement> fallback(const ShaderInput& input, const ShaderNode& texture,
                                       const std::string& why);
  Wrap wrap_of(const ShaderNode& texture, std::string_view name, const std::string& metadata);
  std::optional<Displacement> checked(Displacement displacement, double largest);
  PrimLog log_at(const std::string& path) const { return log_.of_prim(path); }

  const ShaderNetwork& network_;
  const ShaderNode& surface_;
  const TextureSource& textures_;
  PrimLog log_;  // of the surface
};

std::optional<Displacement> DisplacementReader::read(const ShaderInput& input) {
  std::optional<Displacement> found = input.connections.empty() ? constant(input) : connected(input);
  if (found) found->origin = origin_of(surface_, input);
  return found;
}

std::optional<Displacement> DisplacementReader::constant(const ShaderInput& input) {
  const Origin origin = origin_of(surface_, input);
  PrimLog log = log_at(origin.path);
  if (input.in_shutter.size() > 1) {
    log.warn_in_common(origin.attribute, "changes within the shutter; held the frame's value, as Hydra does");
  }
  if (!input.value) return std::nullopt;
  const std::optional<double> number = as_kind_of(*input.value, kNone);
  if (!number || !is_distance(*number)) {
    log.warn(origin.attribute, "found " + (number ? text(*number) : input.value->text) + expected_distance() +
                                   "; drawn without displacement");
    return std::nullopt;
  }
  if (*number == kNone) return std::nullopt;
  return Displacement{.constant = *number};
}

std::optional<Displacement> DisplacementReader::connected(const ShaderInput& input) {
  const ShaderNode* node = network_.node(input.connections.front().node);
  if (node && node->identifier == kTexture) return textured(input, *node);
  if (node && node->identifier == std::string(kPrimvarReader) + "_float") {
    const std::string primvar = text_of(*node, "varname");
    const ShaderValue* value = constant_of(*node, "fallback");
    const double standard = value ? as_kind_of(*value, kNone).value_or(kNone) : kNone;
    if (primvar.empty()) {
      log_at(node->path)
          .warn("inputs:varname", "found no name of a primvar; displaced by its fallback, " + text(standard));
    }
    return checked({.constant = standard, .primvar = primvar}, std::abs(standard));
  }
  const std::string what = node && !node->identifier.empty() ? node->identifier : "node of no known type";
  log_.warn_in_common(full_name(input.name),
                      "connected to a " + what + ", which is not evaluated yet; drawn without displacement");
  return std::nullopt;
}

std::optional<Displacement> DisplacementReader::textured(const ShaderInput& input,
                                                         const ShaderNode& texture) {
  const ShaderValue* file = constant_of(texture, "file");
  const auto* asset = file ? std::get_if<Asset>(&file->data) : nullptr;
  if (!asset || asset->path.empty()) return fallback(input, texture, "it names no file");
  const std::size_t channel = channel_of(input.connections.front().output);
  std::vector<ScalarTile> images = images_of(texture, *asset, channel);
  if (images.empty()) return fallback(input, texture, "@" + asset->path + "@ cannot be read");
  if (!check_texels(texture, *asset, images)) return std::nullopt;
  Displacement found{.coordinates = coordinates_of(texture, network_, log_)};
  found.scale = finite_or(kScale, constant_of(texture, "scale"))[channel];
  found.bias = finite_or(kBias, constant_of(texture, "bias"))[channel];
  if (is_tiled(*asset)) {
    found.texture = std::make_shared<const ScalarTexture>(std::move(images));
  } else {
    ScalarImage& image = images.front().image;
    const Wrap wrap_s = wrap_of(texture, "wrapS", image.wrap_s);
    const Wrap wrap_t = wrap_of(texture, "wrapT", image.wrap_t);
    found.texture = std::make_shared<const ScalarTexture>(std::move(image), wrap_s, wrap_t);
  }
  const double size = std::max(std::abs(found.texture->least()), std::abs(found.texture->largest()));
  return checked(std::move(found), size * std::abs(found.scale) + std::abs(found.bias));
}

// The one, or the tiles; those that can be read.
std::vector<ScalarTile> DisplacementReader::images_of(const ShaderNode& texture, const Asset& asset,
                                                      std::size_t channel) const {
  const std::string named = text_of(texture, "sourceColorSpace"), space = named.empty() ? "auto" : named;
  std::vector<ScalarTile> images;
  if (!is_tiled(asset)) {
    if (auto image = textures_.channel(asset, space, channel)) images.push_back({0, 0, std::move(*image)});
    return images;
  }
  for (const std::string& file : asset.files) {
    const std::optional<TilePlace> place = tile_place(asset, file);
    if (!place) continue;
    auto image = textures_.channel({asset.path, {file}}, space, channel);
    if (image) images.push_back({place->s, place->t, std::move(*image)});
  }
  return images;
}

bool DisplacementReader::check_texels(const ShaderNode& texture, const Asset& asset,
                                      const std::vector<ScalarTile>& images) {
  for (const ScalarTile& tile : images) {
    const std::vector<float>& values = tile.image.values;
    const auto bad = std::ranges::find_if(values, [](float v) { return !std::isfinite(v); });
    if (bad == values.end()) continue;
    log_at(texture.path)
        .warn("inputs:file", "@" + asset.path + "@ has a texel of " + text(double(*bad)) +
                                 ", expected finite numbers; drawn without displacement");
    return false;
  }
  return true;
}

// As the texture's, its output is not scaled.
std::optional<Displacement> DisplacementReader::fallback(const ShaderInput& input, const ShaderNode& texture,
                                                         const std::string& why) {
  const Rgba value = finite_or(kFallback, constant_of(texture, "fallback"));
  const double distance = value[channel_of(input.connections.front().output)];
  log_.warn_in_common(full_name(input.name), "connected to a " + std::string(kTexture) + "; " + why +
                                                 ": displaced by its fallback, " + text(distance));
  if (distance == kNone) return std::nullopt;
  return checked({.constant = distance}, std::abs(distance));
}

// Nothing, with a warning, where distances may be too large.
std::optional<Displacement> DisplacementReader::checked(Displacement displacement, double largest) {
  if (is_distance(largest)) return displacement;
  log_.warn(full_name("displacement"),
            "found up to " + text(largest) + expected_distance() + "; drawn without displacement");
  return std::nullopt;
}

// Black, where neither the node nor the file says another.
Wrap DisplacementReader::wrap_of(const ShaderNode& texture, std::string_view name,
                                 const std::string& metadata) {
  const std::string token = text_of(texture, name);
  if (const std::optional<Wrap> wrap = wrap_from(token)) return *wrap;
  if (!token.empty() && token != "useMetadata") {
    log_at(texture.path)
        .warn(full_name(name),
              "found \"" + token + "\", expected black, clamp, repeat, mirror or useMetadata; took the last");
  }
  return wrap_from(metadata).value_or(Wrap::kBlack);
}

// The surface has the input, but the material does not use it.
void tell_of_unused_input(const ShaderNetwork& network, std::vector<Diagnostic>& diagnostics) {
  const auto terminal = network.terminals.find("surface");
  const ShaderNode* surface =
      terminal == network.terminals.end() ? nullptr : network.node(terminal->second.node);
  const ShaderInput* input =
      surface && surface->identifier == kPreviewSurface ? surface->input("displacement") : nullptr;
  if (!input || !has_effect(*input, kNone)) return;
  PrimLog(diagnostics, surface->path)
      .note_in_common(full_name("displacement"),
                      "the material's outputs:displacement is not connected, so that nothing is displaced");
}

}  // namespace

std::optional<Displacement> displacement_of(const ShaderNetwork& network, const TextureSource& textures,
                                            std::vector<Diagnostic>& diagnostics) {
  const auto terminal = network.terminals.find("displacement");
  if (terminal == network.terminals.end()) {
    tell_of_unused_input(network, diagnostics);
    return std::nullopt;
  }
  const ShaderNode* shader = network.node(terminal->second.node);
  if (!shader || shader->identifier != kPreviewSurface) {
    const std::string found = shader && !shader->identifier.empty() ? shader->identifier : "of no known type";
    PrimLog(diagnostics, network.path)
        .warn_in_common("outputs:displacement", "found a displacement shader " + found + ", expected " +
                                                    std::string(kPreviewSurface) +
                                                    "; drawn without displacement");
    return std::nullopt;
  }
  const ShaderInput* input = shader->input("displacement");
  if (!input) return std::nullopt;
  return DisplacementReader(network, *shader, textures, PrimLog(diagnostics, shader->path)).read(*input);
}

}  // namespace msbvh::translate
