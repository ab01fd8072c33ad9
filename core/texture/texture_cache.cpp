#include "core/texture/texture_cache.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <tuple>

#include "core/texture/color_conversion.h"
#include "core/texture/texel_pyramid.h"
#include "core/texture/texture_coordinates.h"

namespace msbvh {
namespace {

using OIIO::Tex::Wrap;

// Of the axes of a footprint; a longer one is filtered as if the shorter were wider.
constexpr int kMostAnisotropic = 16;

Wrap wrap_of(TextureWrap wrap) {
  switch (wrap) {
    case TextureWrap::kBlack:
      return Wrap::Black;
    case TextureWrap::kClamp:
      return Wrap::Clamp;
    case TextureWrap::kRepeat:
      return Wrap::Periodic;
    case TextureWrap::kMirror:
      return Wrap::Mirror;
    case TextureWrap::kMetadata:
      break;
  }
  return Wrap::Default;
}

TextureWrap either(TextureWrap wanted, TextureWrap said_by_file) {
  return wanted == TextureWrap::kMetadata ? said_by_file : wanted;
}

bool finite(const TexelColor& color) {
  return std::all_of(color.begin(), color.end(), [](float value) { return std::isfinite(value); });
}

// Grey is red, green and blue; no alpha is 1.
TexelColor expanded(const float* texel, int channels) {
  switch (channels) {
    case 1:
      return {texel[0], texel[0], texel[0], 1.0f};
    case 2:
      return {texel[0], texel[0], texel[0], texel[1]};
    case 3:
      return {texel[0], texel[1], texel[2], 1.0f};
    default:
      return {texel[0], texel[1], texel[2], texel[3]};
  }
}

struct Tile {
  std::int32_t s, t;
  const TexelSource* source;
};

}  // namespace

struct TextureCache::Data {
  explicit Data(const TextureSettings& settings) : store(settings.memory_limit_bytes) {}

  const TexelSource* source_of(const Tile* tile) const {
    return tile != nullptr && tile->source->open() ? tile->source : nullptr;
  }
  const Tile* tile_of(TextureId texture, TextureQuery& query) const;
  TexelColor look_up(TextureId texture, const TextureQuery& query,
                     OIIO::TextureSystem::Perthread* thread) const;

  std::vector<ImageTexture> textures;
  std::vector<std::vector<Tile>> tiles;  // of each texture, by t, then s
  std::vector<std::unique_ptr<TexelSource>> sources;
  mutable std::atomic<std::uint64_t> lookups{0};
  TexelStore store;  // goes first: it reads from the sources
};

TextureCache::TextureCache(const std::vector<ImageTexture>& textures, const TextureSettings& settings)
    : data_(std::make_unique<Data>(settings)) {
  if (!textures.empty()) ColorConversion("sRGB", settings.rendering_space);
  std::map<std::tuple<std::string, std::uint64_t, std::uint64_t, std::string>, const TexelSource*> known;
  data_->textures = textures;
  for (const ImageTexture& texture : textures) {
    std::vector<Tile>& tiles = data_->tiles.emplace_back();
    for (const TextureTile& tile : texture.tiles) {
      const TexelSource*& source =
          known[{tile.file.path, tile.file.offset, tile.file.bytes, texture.color_space}];
      if (source == nullptr) {
        const std::string name = "texture " + std::to_string(data_->sources.size());
        source = data_->sources
                     .emplace_back(std::make_unique<TexelSource>(
                         data_->store, name, tile.file, texture.color_space, settings.rendering_space))
                     .get();
      }
      tiles.push_back({tile.s, tile.t, source});
    }
    std::sort(tiles.begin(), tiles.end(),
              [](const Tile& a, const Tile& b) { return std::tie(a.t, a.s) < std::tie(b.t, b.s); });
  }
}

TextureCache::~TextureCache() = default;

bool can_read_textures() { return true; }

// Takes the query into the tile's own unit square. Null: there is none there.
const Tile* TextureCache::Data::tile_of(TextureId texture, TextureQuery& query) const {
  const std::vector<Tile>& all = tiles[texture];
  if (!textures[texture].udim) return all.empty() ? nullptr : &all.front();
  const float s = std::floor(query.s), t = std::floor(query.t);
  const auto found = std::lower_bound(all.begin(), all.end(), std::pair(t, s), [](const Tile& tile, auto at) {
    return std::pair(static_cast<float>(tile.t), static_cast<float>(tile.s)) < at;
  });
  if (found == all.end() || static_cast<float>(found->s) != s || static_cast<float>(found->t) != t)
    return nullptr;
  query.s -= s;
  query.t -= t;
  return &*found;
}

TexelColor TextureCache::Data::look_up(TextureId id, const TextureQuery& asked,
                                       OIIO::TextureSystem::Perthread* thread) const {
  const ImageTexture& texture = textures[id];
  if (!std::isfinite(asked.s) || !std::isfinite(asked.t)) return texture.fallback;
  TextureQuery query = asked;
  const TexelSource* source = source_of(tile_of(id, query));
  if (source == nullptr) return texture.fallback;

  const TextureWrap wrap_s = texture.udim ? TextureWrap::kClamp : either(texture.wrap_s, source->wrap_s());
  const TextureWrap wrap_t = texture.udim ? TextureWrap::kClamp : either(texture.wrap_t, source->wrap_t());
  OIIO::TextureOpt options;
  options.swrap = wrap_of(wrap_s);
  options.twrap = wrap_of(wrap_t);
  options.interpmode = OIIO::Tex::InterpMode::Bilinear;
  options.anisotropic = kMostAnisotropic;
  float texel[4];
  // Of its own the library counts t from the top.
  const bool done = store.system->texture(
      source->handle(), thread, options, near_unit_square(query.s, wrap_s),
      1.0f - near_unit_square(query.t, wrap_t), filter_extent(query.ds_dx), -filter_extent(query.dt_dx),
      filter_extent(query.ds_dy), -filter_extent(query.dt_dy), source->channels(), texel);
  if (!done) {
    const std::string reason = store.system->geterror();
    source->add_fault(reason.empty() ? "it can no longer be read" : reason.substr(0, reason.find('\n')));
    return texture.fallback;
  }
  const TexelColor result = expanded(texel, source->channels());
  return finite(result) ? result : texture.fallback;
}

void TextureCache::read(TextureId texture, std::span<const TextureQuery> queries,
                        std::span<TexelColor> result) const {
  OIIO::TextureSystem::Perthread* thread = data_->store.system->get_perthread_info();
  for (std::size_t i = 0; i < queries.size(); ++i) result[i] = data_->look_up(texture, queries[i], thread);
  data_->lookups += queries.size();
}

TextureSize TextureCache::size(TextureId texture) const {
  const std::vector<Tile>& tiles = data_->tiles[texture];
  const TexelSource* source = data_->source_of(tiles.empty() ? nullptr : &tiles.front());
  if (source == nullptr) return {};
  return {static_cast<std::uint32_t>(source->spec().width),
          static_cast<std::uint32_t>(source->spec().height)};
}

TextureStatistics TextureCache::statistics() const {
  data_->store.note_memory();
  return {data_->lookups.load(), data_->sources.size(), data_->store.memory.read_bytes(),
          data_->store.memory_bytes(), data_->store.peak_bytes.load()};
}

std::vector<TextureFault> TextureCache::faults() const {
  std::vector<TextureFault> result;
  for (TextureId texture = 0; texture < data_->tiles.size(); ++texture)
    for (const Tile& tile : data_->tiles[texture])
      for (const std::string& reason : tile.source->faults())
        result.push_back({texture, tile.source->file().path, reason});
  return result;
}

}  // namespace msbvh
