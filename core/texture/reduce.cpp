#include "core/texture/reduce.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace msbvh {
namespace {

// Along one axis coarse texel i covers [i * fine, (i + 1) * fine) in units of 1 / coarse of a fine texel:
// whole numbers, so that what it covers is known exactly.
struct Cover {
  int first, count;
};

Cover cover(int texel, int coarse, int fine) {
  const std::int64_t begin = std::int64_t{texel} * fine, end = begin + fine;
  const int first = static_cast<int>(begin / coarse);
  return {first, static_cast<int>((end + coarse - 1) / coarse) - first};
}

// Of what `texel` covers, the share that lies in `fine_texel`.
double share(int texel, int fine_texel, int coarse, int fine) {
  const std::int64_t begin = std::int64_t{texel} * fine;
  const std::int64_t low = std::max(begin, std::int64_t{fine_texel} * coarse);
  const std::int64_t high = std::min(begin + fine, (std::int64_t{fine_texel} + 1) * coarse);
  return static_cast<double>(high - low) / fine;
}

// Of one axis of a region: for each of its texels the first fine one, and the weights of those covered.
struct Weights {
  std::vector<int> first;
  std::vector<std::vector<double>> of;
};

Weights weights(int begin, int end, int coarse, int fine) {
  Weights result;
  for (int texel = begin; texel < end; ++texel) {
    const Cover covers = cover(texel, coarse, fine);
    std::vector<double> each;
    for (int i = 0; i < covers.count; ++i) each.push_back(share(texel, covers.first + i, coarse, fine));
    result.first.push_back(covers.first);
    result.of.push_back(std::move(each));
  }
  return result;
}

}  // namespace

LevelSize next_coarser(LevelSize fine) { return {std::max(fine.width / 2, 1), std::max(fine.height / 2, 1)}; }

TexelRegion covered(const TexelRegion& region, LevelSize coarse, LevelSize fine) {
  const Cover left = cover(region.x0, coarse.width, fine.width);
  const Cover right = cover(region.x1 - 1, coarse.width, fine.width);
  const Cover top = cover(region.y0, coarse.height, fine.height);
  const Cover bottom = cover(region.y1 - 1, coarse.height, fine.height);
  return {left.first, top.first, right.first + right.count, bottom.first + bottom.count};
}

void reduce(std::span<const float> fine_texels, LevelSize fine, const TexelRegion& region, LevelSize coarse,
            int channels, std::span<float> result) {
  const TexelRegion below = covered(region, coarse, fine);
  const Weights across = weights(region.x0, region.x1, coarse.width, fine.width);
  const Weights down = weights(region.y0, region.y1, coarse.height, fine.height);
  const std::size_t row = static_cast<std::size_t>(below.width()) * channels;
  float* out = result.data();
  for (int y = 0; y < region.height(); ++y) {
    for (int x = 0; x < region.width(); ++x) {
      for (int channel = 0; channel < channels; ++channel) {
        double sum = 0.0;
        for (std::size_t j = 0; j < down.of[y].size(); ++j) {
          const float* texel = fine_texels.data() + (down.first[y] - below.y0 + j) * row +
                               static_cast<std::size_t>(across.first[x] - below.x0) * channels + channel;
          for (std::size_t i = 0; i < across.of[x].size(); ++i)
            sum += down.of[y][j] * across.of[x][i] * texel[i * channels];
        }
        *out++ = static_cast<float>(sum);
      }
    }
  }
}

}  // namespace msbvh
