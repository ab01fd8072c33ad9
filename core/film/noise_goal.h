// Noise that ends: how much of it a pixel may keep.
#pragma once

#include <cstdint>

namespace msbvh {

struct NoiseGoal {
  // Relative standard error of a pixel's colour, and the absolute one of its alpha; 0: every pixel has the
  // same number of samples.
  float target = 0.0f;
  // Samples of each pixel before anybody asks how noisy it is; rounded up to least_samples().
  std::uint32_t min_spp = 32;

  bool decides() const { return target > 0.0f; }
  // A power of two, at least two blocks of the pixel's sum (core/film/sum_tree.h): so that whatever number of
  // samples comes of it is whole blocks.
  std::uint32_t least_samples() const;
};

inline constexpr float kLargestNoiseTarget = 1.0f;

// Throws Error naming the setting, found and expected.
void check(const NoiseGoal& goal);

}  // namespace msbvh
