// Texture coordinates of any size, brought near the unit square, where single precision has room for texels.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/texture/image_texture.h"

namespace msbvh {

// A picture's widths: beyond it a footprint covers the whole picture many times over, or none of it.
inline constexpr float kFarthest = 1000.0f;

// `coordinate` is finite; the texel there is the same.
inline float near_unit_square(float coordinate, TextureWrap wrap) {
  switch (wrap) {
    case TextureWrap::kRepeat:
      return coordinate - std::floor(coordinate);
    case TextureWrap::kMirror:
      return coordinate - 2.0f * std::floor(0.5f * coordinate);
    default:
      return std::clamp(coordinate, -kFarthest, kFarthest);
  }
}

// Of OpenImageIO's filter in one of a footprint's. Its filter is bilinear between texels as large as the
// footprint, and as wide again along the longer axis: at half its width it has the spread of an even mean
// over the footprint, about (a standard deviation of 0.25 of its width, where that has 0.29).
inline constexpr float kFilterWidth = 0.5f;

// One component of a footprint's axes as OpenImageIO takes it.
inline float filter_extent(float extent) {
  return std::isfinite(extent) ? std::clamp(kFilterWidth * extent, -kFarthest, kFarthest) : 0.0f;
}

}  // namespace msbvh
