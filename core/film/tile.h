// The tiles that an image is rendered in.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace msbvh {

// A half-open rectangle of pixels; y runs down from the top row.
struct Tile {
  std::uint32_t x0, y0, x1, y1;

  std::uint32_t width() const { return x1 - x0; }
  std::uint32_t pixels() const { return (x1 - x0) * (y1 - y0); }
};

// Pixels along a tile's edge: its rays look the same way, its sums stay in the second-level cache.
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

}  // namespace msbvh
