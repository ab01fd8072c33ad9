// Pixels, and the tiles that they are rendered in.
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/shade/integrator.h"

namespace msbvh {

// A half-open rectangle of pixels; y runs down from the top row.
struct Tile {
  std::uint32_t x0, y0, x1, y1;
};

// Pixels along a tile's edge: a tile's rays of one sample share a time stratum (core/shade/sampler.h), its
// sums stay in the first-level cache.
inline constexpr std::uint32_t kTileSize = 16;

// The tiles of an image, row by row.
class TileGrid {
 public:
  TileGrid(std::uint32_t width, std::uint32_t height)
      : width_(width), height_(height), columns_(ceil_divide(width)), rows_(ceil_divide(height)) {}

  std::size_t count() const { return std::size_t(columns_) * rows_; }
  Tile tile(std::size_t i) const {
    const std::uint32_t x = static_cast<std::uint32_t>(i % columns_) * kTileSize;
    const std::uint32_t y = static_cast<std::uint32_t>(i / columns_) * kTileSize;
    return {x, y, std::min(width_, x + kTileSize), std::min(height_, y + kTileSize)};
  }

 private:
  static std::uint32_t ceil_divide(std::uint32_t pixels) { return (pixels + kTileSize - 1) / kTileSize; }

  std::uint32_t width_, height_, columns_, rows_;
};

// The sum of a pixel's samples. Double: the sum of a million floats would have lost its last digits.
class PixelSum {
 public:
  void add(const PathResult& sample) {
    radiance_ += Vec3d(sample.radiance);
    alpha_ += sample.alpha;
  }
  // The mean of `count` samples, four floats: box filter over the pixel, premultiplied.
  void resolve(std::uint32_t count, float* rgba) const {
    const Vec3d mean = radiance_ * (1.0 / count);
    rgba[0] = static_cast<float>(mean.x);
    rgba[1] = static_cast<float>(mean.y);
    rgba[2] = static_cast<float>(mean.z);
    rgba[3] = static_cast<float>(alpha_ / count);
  }

 private:
  Vec3d radiance_;
  double alpha_ = 0.0;
};

}  // namespace msbvh
