// In place of texture_cache.cpp where the library is built without OpenImageIO (MSBVH_TEXTURES): every
// texture is drawn as its fallback, and is a fault that says so.
#include <algorithm>

#include "core/base/error.h"
#include "core/texture/constant_image.h"
#include "core/texture/plain_color.h"
#include "core/texture/texture_cache.h"

namespace msbvh {

struct TextureCache::Data {
  std::vector<ImageTexture> textures;
};

TextureCache::TextureCache(const std::vector<ImageTexture>& textures, const TextureSettings&)
    : data_(std::make_unique<Data>(textures)) {}
TextureCache::~TextureCache() = default;

bool can_read_textures() { return false; }

void TextureCache::read(TextureId texture, std::span<const TextureQuery>,
                        std::span<TexelColor> result) const {
  std::fill(result.begin(), result.end(), data_->textures[texture].fallback);
}

TextureSize TextureCache::size(TextureId) const { return {}; }

std::optional<TexelColor> constant_color(const ImageTexture&, const std::string&) { return std::nullopt; }

void convert_colors(std::span<float>, const std::string& from, const std::string& to) {
  const bool as_it_is =
      from.empty() ? to == kLinearRec709
                   : from == to || from == "raw" || from == "data" || from == "identity" || from == "unknown";
  if (!as_it_is)
    throw Error("colour space '" + from + "': this msbvh was built without OpenImageIO (MSBVH_TEXTURES)");
}

TextureStatistics TextureCache::statistics() const { return {}; }

std::vector<TextureFault> TextureCache::faults() const {
  std::vector<TextureFault> result;
  for (TextureId texture = 0; texture < data_->textures.size(); ++texture)
    for (const TextureTile& tile : data_->textures[texture].tiles)
      result.push_back(
          {texture, tile.file.path, "this msbvh was built without OpenImageIO (MSBVH_TEXTURES)"});
  return result;
}

}  // namespace msbvh
