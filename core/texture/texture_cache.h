// Reads image textures, filtered: OpenImageIO behind one file.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/texture/image_texture.h"

namespace msbvh {

// Where a texture is read, and over how large a part of it. (0, 0) is the lower left corner of the picture,
// (1, 1) its upper right one.
struct TextureQuery {
  float s, t;
  // The axes of the footprint, as long as a pixel is wide: about the mean over the parallelogram that they
  // span around (s, t). All 0: a point, bilinear.
  float ds_dx, dt_dx, ds_dy, dt_dy;
};

using TexelColor = std::array<float, 4>;

struct TextureSettings {
  std::uint64_t memory_limit_bytes = 1ull << 30;     // of texels that are kept
  std::string rendering_space = "lin_rec709_scene";  // OpenColorIO's name
};

// What came of reading a texture.
struct TextureFault {
  TextureId texture;
  std::string file, reason;  // in words; the fallback is drawn
};

struct TextureStatistics {
  std::uint64_t lookups = 0, files = 0;  // files that were asked for
  std::uint64_t bytes_read = 0;  // of texels, as the files store them, uncompressed; again where read again
  std::uint64_t memory_bytes = 0, peak_memory_bytes = 0;
};

// Texels of a texture's file, or of the first tile of a UDIM texture; 0 x 0 where it cannot be read.
struct TextureSize {
  std::uint32_t width = 0, height = 0;
};

// Whether this library was built with OpenImageIO. Where not, every texture is a fault.
bool can_read_textures();

// Thread-safe once made.
class TextureCache {
 public:
  // Opens no file yet. Throws Error where settings.rendering_space is no colour space.
  TextureCache(const std::vector<ImageTexture>& textures, const TextureSettings& settings);
  ~TextureCache();

  // `result` is as long as `queries`. Grey images give r = g = b; what has no alpha 1. A file that cannot be
  // read, or a texel that is not finite, gives the fallback, and leaves a fault.
  void read(TextureId texture, std::span<const TextureQuery> queries, std::span<TexelColor> result) const;
  TextureSize size(TextureId texture) const;
  TextureStatistics statistics() const;
  // Each fault once, by texture and tile.
  std::vector<TextureFault> faults() const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace msbvh
