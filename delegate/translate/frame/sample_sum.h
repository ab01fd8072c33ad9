// A picture that grows by ranges of its samples, and in which steps it does.
#pragma once

#include <cstdint>
#include <vector>

#include "core/film/image.h"
#include "core/film/sum_tree.h"

namespace msbvh::translate {

// Pictures of some of a pixel's samples each, summed up to the picture of all. Colours are means, weighted by
// the samples; AOVs are merged as core/film/aov.h says of each.
class SampleSum {
 public:
  // Of a picture of `count` samples of each pixel. All must be of one size and have the same AOVs; where
  // depths or ids are among them, cameraDepth must be too. Throws Error for others.
  void add(const Image& picture, std::uint32_t count);
  void clear() { *this = {}; }

  std::uint32_t samples() const { return samples_; }
  // Empty while there are no samples.
  Image picture() const;

 private:
  void add_means(const Image& picture, std::uint32_t count);
  void take_nearest(const Image& picture);

  std::uint32_t samples_ = 0;
  Image nearest_;                           // size, and AOVs of the nearest sample
  std::vector<double> rgba_;                // sums
  std::vector<std::vector<double>> means_;  // sums by AOV; empty for those of the nearest sample
};

// Depth and ids can be told from each other only with the distance of each sample.
std::vector<Aov> with_depth(std::vector<Aov> aovs);

// The samples that come after the first `done` of `all`: one at first, so that there is something to see,
// then as many as there are already, up to a block, so that later ranges start and end where blocks of the
// sum do (core/film/sum_tree.h).
SampleRange next_samples(std::uint32_t done, std::uint32_t all);

}  // namespace msbvh::translate
