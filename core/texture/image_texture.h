// An image on a surface: where its texels are, and how they are read. Plain data; texture_cache.h reads it.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace msbvh {

// In Scene::textures.
using TextureId = std::uint32_t;

// Beyond the unit square. UsdUVTexture's wrapS and wrapT.
enum class TextureWrap : std::uint8_t {
  kMetadata,  // what the file says; black where it says nothing
  kBlack,
  kClamp,
  kRepeat,
  kMirror
};

// A file, or a part of one, such as of a usdz package.
struct TextureFile {
  std::string path{};
  std::uint64_t offset = 0, bytes = 0;  // 0 bytes: the whole file
  bool operator==(const TextureFile&) const = default;
};

// Of a UDIM texture: a file that covers the unit square from (s, t) on.
struct TextureTile {
  std::int32_t s = 0, t = 0;
  TextureFile file{};
  bool operator==(const TextureTile&) const = default;
};

struct ImageTexture {
  std::string name{};                // for messages: as authored
  std::vector<TextureTile> tiles{};  // one, which wraps; a UDIM texture's, which do not
  bool udim = false;
  TextureWrap wrap_s = TextureWrap::kMetadata, wrap_t = TextureWrap::kMetadata;
  // OpenColorIO's name of what the file holds, from which red, green and blue are taken to the rendering
  // space before they are filtered; empty: used as they are. "auto": sRGB for 8 bits of three or four
  // channels, as UsdUVTexture says.
  std::string color_space{};
  // Red, green, blue and alpha where a file is missing or cannot be read.
  std::array<float, 4> fallback{0.0f, 0.0f, 0.0f, 1.0f};
  bool operator==(const ImageTexture&) const = default;
};

}  // namespace msbvh
