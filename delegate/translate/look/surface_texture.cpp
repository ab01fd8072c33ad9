#include "delegate/translate/look/surface_texture.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "delegate/translate/look/shader_values.h"
#include "delegate/translate/look/udim.h"

namespace msbvh::translate {
namespace {

constexpr Rgba kScale{1.0, 1.0, 1.0, 1.0}, kBias{};

class TextureReader {
 public:
  TextureReader(const ShaderNode& node, const ShaderNetwork& network, const TextureSource& textures,
                PrimLog log)
      : node_(node), network_(network), textures_(textures), log_(std::move(log)) {}

  std::optional<SurfaceTexture> read(const Rgba& standard, NoFile& no_file);

 private:
  std::optional<std::vector<TextureTile>> tiles(const Asset& asset, NoFile& no_file) const;
  TextureWrap wrap(std::string_view name) const;
  std::string color_space(const Asset& asset) const;
  void tell_of_connections() const;

  const ShaderNode& node_;
  const ShaderNetwork& network_;
  const TextureSource& textures_;
  PrimLog log_;  // of the node
};

std::optional<SurfaceTexture> TextureReader::read(const Rgba& standard, NoFile& no_file) {
  const ShaderValue* file = constant_of(node_, "file");
  const auto* asset = file ? std::get_if<Asset>(&file->data) : nullptr;
  if (!asset || asset->path.empty()) {
    no_file.why = file && !asset ? "its file is " + file->text + ", which names none" : "it names no file";
    return std::nullopt;
  }
  SurfaceTexture found;
  std::optional<std::vector<TextureTile>> tiles = this->tiles(*asset, no_file);
  if (!tiles) return std::nullopt;
  tell_of_connections();
  found.image.name = asset->path;
  found.image.tiles = std::move(*tiles);
  found.image.udim = is_tiled(*asset);
  found.image.wrap_s = wrap("wrapS");
  found.image.wrap_t = wrap("wrapT");
  found.image.color_space = color_space(*asset);
  found.coordinates = coordinates_of(node_, network_, log_);
  found.scale = checked_numbers<4>(kScale, node_, "scale", log_);
  found.bias = checked_numbers<4>(kBias, node_, "bias", log_);
  const Rgba fallback = checked_numbers<4>(standard, node_, "fallback", log_);
  for (std::size_t i = 0; i < fallback.size(); ++i) {
    const double unscaled = (fallback[i] - found.bias[i]) / found.scale[i];
    found.image.fallback[i] = float(std::isfinite(unscaled) ? unscaled : fallback[i]);
  }
  return found;
}

// None where there is no file that can be read as it stands.
std::optional<std::vector<TextureTile>> TextureReader::tiles(const Asset& asset, NoFile& no_file) const {
  std::vector<TextureTile> tiles;
  for (const std::string& file : asset.files) {
    TilePlace place{0, 0};
    if (is_tiled(asset)) {
      const std::optional<TilePlace> found = tile_place(asset, file);
      if (!found) continue;
      place = *found;
    }
    if (std::optional<TextureFile> located = textures_.locate(file)) {
      tiles.push_back({place.s, place.t, std::move(*located)});
    } else {
      no_file.why = "@" + asset.path + "@ lies in a package in a way that it cannot be read";
    }
    if (!is_tiled(asset)) break;
  }
  if (!tiles.empty()) return tiles;
  if (no_file.why.empty()) no_file.why = "@" + asset.path + "@ cannot be found";
  return std::nullopt;
}

TextureWrap TextureReader::wrap(std::string_view name) const {
  constexpr std::pair<std::string_view, TextureWrap> kWraps[] = {{"useMetadata", TextureWrap::kMetadata},
                                                                 {"black", TextureWrap::kBlack},
                                                                 {"clamp", TextureWrap::kClamp},
                                                                 {"repeat", TextureWrap::kRepeat},
                                                                 {"mirror", TextureWrap::kMirror}};
  const ShaderValue* value = constant_of(node_, name);
  if (!value) return TextureWrap::kMetadata;
  const std::string token = text_of(node_, name);
  for (const auto& [known, wrap] : kWraps) {
    if (token == known) return wrap;
  }
  const Origin origin = origin_of(node_, *node_.input(name));
  log_.of_prim(origin.path)
      .warn(origin.attribute,
            "found " + value->text + ", expected black, clamp, repeat, mirror or useMetadata; took the last");
  return TextureWrap::kMetadata;
}

// sourceColorSpace decides; what the stage says of the file only where that is left to be found out.
std::string TextureReader::color_space(const Asset& asset) const {
  const ShaderValue* value = constant_of(node_, "sourceColorSpace");
  const std::string token = text_of(node_, "sourceColorSpace");
  if (token == "raw") return {};
  if (token == "sRGB") return kSrgb;
  if (value && token != "auto") {
    const Origin origin = origin_of(node_, *node_.input("sourceColorSpace"));
    log_.of_prim(origin.path)
        .warn(origin.attribute, "found " + value->text + ", expected raw, sRGB or auto; took auto");
  }
  constexpr std::string_view kData[] = {"raw", "Raw", "data", "identity", "unknown"};
  if (std::ranges::find(kData, asset.color_space) != std::end(kData)) return {};
  if (asset.color_space == "sRGB") return kSrgb;
  return asset.color_space.empty() ? kAutoColorSpace : asset.color_space;
}

// What may be connected but to texture coordinates and interfaces is computed nowhere.
void TextureReader::tell_of_connections() const {
  for (const ShaderInput& input : node_.inputs) {
    if (input.name == "st" || input.connections.empty()) continue;
    log_.of_prim(node_.path)
        .warn_in_common(full_name(input.name),
                        "connected to another node, which is not evaluated here; its default counts");
  }
}

}  // namespace

std::optional<std::size_t> channel_of(std::string_view output) {
  constexpr std::string_view kOutputs[] = {"r", "g", "b", "a"};
  const auto found = std::ranges::find(kOutputs, output);
  return found == std::end(kOutputs) ? std::nullopt
                                     : std::optional(std::size_t(found - std::begin(kOutputs)));
}

std::optional<SurfaceTexture> surface_texture(const ShaderNode& node, const ShaderNetwork& network,
                                              const TextureSource& textures, const Rgba& standard,
                                              PrimLog log, NoFile& no_file) {
  return TextureReader(node, network, textures, std::move(log)).read(standard, no_file);
}

}  // namespace msbvh::translate
