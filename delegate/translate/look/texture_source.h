// What a front-end can say about a texture.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/vec.h"
#include "core/texture/image_texture.h"
#include "delegate/translate/look/scalar_texture.h"
#include "delegate/translate/look/shader_network.h"

namespace msbvh::translate {

using Rgba = std::array<double, 4>;  // red, green, blue and alpha

struct ColourImage {
  std::uint32_t width = 0, height = 0;
  std::vector<Vec3f> texels;  // [height][width], the uppermost row first
};

class TextureSource {
 public:
  virtual ~TextureSource() = default;

  // Where the bytes of a resolved file are: of one in a package, their place in it. None: nowhere as they
  // stand, such as in a package within a package.
  virtual std::optional<TextureFile> locate(const std::string& file) const { return TextureFile{file}; }
  // All texels of a picture on a light; one channel is grey. `colour_space` is UsdUVTexture's
  // sourceColorSpace: raw, sRGB, or auto, as which anything else counts. None where it cannot be read.
  virtual std::optional<ColourImage> colours(const Asset&, std::string_view) const { return std::nullopt; }
  // For displacement: all texels of one of red, green, blue and alpha (0 to 3), likewise; of a source that
  // knows no texels none.
  virtual std::optional<ScalarImage> channel(const Asset&, std::string_view, std::size_t) const {
    return std::nullopt;
  }
};

}  // namespace msbvh::translate
