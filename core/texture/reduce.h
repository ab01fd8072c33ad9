// One level of a pyramid from the next finer one: means of the texels below, weighted by area, so that the
// mean of an image is the mean of its every level, whatever its size.
#pragma once

#include <span>

namespace msbvh {

// Texels [x0, x1) x [y0, y1) of a level.
struct TexelRegion {
  int x0, y0, x1, y1;
  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
};

struct LevelSize {
  int width, height;
  bool operator==(const LevelSize&) const = default;
};

// Half of each, rounded down; 1 at least.
LevelSize next_coarser(LevelSize fine);

// The texels of `fine` that those of `region` in `coarse` cover, in part or whole.
TexelRegion covered(const TexelRegion& region, LevelSize coarse, LevelSize fine);

// `fine_texels`: of covered(region, coarse, fine), rows of `channels` values a texel; `result`: of `region`,
// likewise. A texel that is not finite makes those above it so.
void reduce(std::span<const float> fine_texels, LevelSize fine, const TexelRegion& region, LevelSize coarse,
            int channels, std::span<float> result);

}  // namespace msbvh
