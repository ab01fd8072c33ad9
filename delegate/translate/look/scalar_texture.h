// One channel of an image as a function of texture coordinates, filtered by a pyramid of means. What
// displacement reads as long as textures are not evaluated elsewhere: whatever comes in its place needs at()
// and largest().
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace msbvh::translate {

// UsdUVTexture's wrapS and wrapT.
enum class Wrap : std::uint8_t { kBlack, kClamp, kRepeat, kMirror };
std::optional<Wrap> wrap_from(std::string_view token);  // none for useMetadata, and for what is no mode

struct ScalarImage {
  std::uint32_t width = 0, height = 0;
  std::vector<float> values{};     // row by row, the picture's uppermost first
  std::string wrap_s{}, wrap_t{};  // what the file says; empty: nothing
};

// Of a UDIM texture: an image that covers the unit square from (s, t) on.
struct ScalarTile {
  int s = 0, t = 0;
  ScalarImage image{};
};

class ScalarTexture {
 public:
  // The image must have a texel; all of them finite.
  ScalarTexture(ScalarImage image, Wrap wrap_s, Wrap wrap_t);
  // At least one; black where there is none.
  explicit ScalarTexture(std::vector<ScalarTile> tiles);

  // (0, 0) is the lower left corner of the picture, (1, 1) its upper right one. The mean over about a square
  // of texels whose side is the longer one of a footprint of `size_s` x `size_t` in these coordinates; the
  // bilinear value at the point where that is less than a texel.
  double at(double s, double t, double size_s, double size_t) const;
  double least() const { return least_; }
  double largest() const { return largest_; }

 private:
  struct Level {
    std::uint32_t width, height;
    std::vector<float> values;
  };
  static Level halved(const Level& level);
  double bilinear(const Level& level, double s, double t) const;
  const ScalarTexture* tile(int s, int t) const;
  double in_tiles(double s, double t, double size_s, double size_t) const;

  std::vector<Level> levels_;  // the image first, then each half as large as the one before
  Wrap wrap_s_ = Wrap::kClamp, wrap_t_ = Wrap::kClamp;
  std::vector<std::array<int, 2>> tile_places_{};  // none: an image
  std::vector<ScalarTexture> tiles_{};             // there
  double least_ = 0.0, largest_ = 0.0;
};

}  // namespace msbvh::translate
