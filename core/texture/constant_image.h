// Images whose texels are all alike, found without reading more of the others than their first rows.
#pragma once

#include <optional>
#include <string>

#include "core/texture/image_texture.h"
#include "core/texture/texture_cache.h"

namespace msbvh {

// Images of more texels count as varying, unless their metadata has maketx's "oiio:ConstantColor": they are
// not read through for it.
inline constexpr std::uint64_t kMostTexelsToCompare = 1u << 24;

// What a TextureCache would read everywhere, in the rendering space; none where it might vary (UDIM textures,
// wraps to black, levels that are not alike, NaN) and where the file cannot be read: the cache says what is
// wrong with it. Rows are read until one texel differs.
std::optional<TexelColor> constant_color(const ImageTexture& texture, const std::string& rendering_space);

}  // namespace msbvh
