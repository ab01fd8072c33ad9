// What a front-end can say about a texture.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "core/base/vec.h"
#include "delegate/translate/look/scalar_texture.h"
#include "delegate/translate/look/shader_network.h"

namespace msbvh::translate {

using Rgba = std::array<double, 4>;  // linear red, green and blue, and alpha

struct ColourImage {
  std::uint32_t width = 0, height = 0;
  std::vector<Vec3f> texels;  // [height][width], the uppermost row first
};

class TextureSource {
 public:
  virtual ~TextureSource() = default;

  // Every texel counts alike. None where the texture cannot be read. `colour_space` is UsdUVTexture's
  // sourceColorSpace: raw, sRGB, or auto, as which anything else counts.
  virtual std::optional<Rgba> mean(const Asset& texture, std::string_view colour_space) const = 0;
  // All texels, likewise; one channel is grey.
  virtual std::optional<ColourImage> colours(const Asset&, std::string_view) const { return std::nullopt; }
  // All texels of one of red, green, blue and alpha (0 to 3), likewise; of a source that knows no texels
  // none.
  virtual std::optional<ScalarImage> channel(const Asset&, std::string_view, std::size_t) const {
    return std::nullopt;
  }
};

}  // namespace msbvh::translate
