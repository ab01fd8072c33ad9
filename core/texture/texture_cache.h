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
  // The axes of the footprint, an ellipse, as far as a pixel's width reaches. All 0: a point, bilinear.
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

// Thread-safe once made.
class TextureCache {
 public:
  // Opens no file yet.
  TextureCache(const std::vector<ImageTexture>& textures, const TextureSettings& settings);
  ~TextureCache();

  // `result` is as long as `queries`. Grey images give r = g = b; what has no alpha 1. A file that cannot be
  // read, or a texel that is not finite, gives the fallback, and leaves a fault.
  void read(TextureId texture, std::span<const TextureQuery> queries, std::span<TexelColor> result) const;
  // Each fault once.
  std::vector<TextureFault> faults() const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace msbvh
