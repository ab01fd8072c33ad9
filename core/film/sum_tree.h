// The sum of a pixel's samples, in an order that does not depend on how the work was cut up.
//
// Samples are added one after another within a block of kBlockSamples; whole blocks are added in a binary
// tree, the two halves of every aligned run of 2^k blocks first. What has summed any aligned run of blocks,
// be it another tile, run or machine, therefore has a node of the same tree, and nodes merge to the same
// bits.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace msbvh {

inline constexpr std::uint32_t kBlockSamples = 16;

// Of each pixel's samples, which are the same whatever range they are taken in.
struct SampleRange {
  std::uint32_t first, count;
};

// Many pixels in step: each has `count()` samples. `Sum` must have += and be zero when made.
template <typename Sum>
class SumTrees {
 public:
  // Forgets all sums.
  void reset(std::size_t pixels) {
    open_.assign(pixels, Sum{});
    whole_.clear();
    count_ = 0;
  }

  std::uint32_t count() const { return count_; }

  // The sum of the block at hand, for the next sample of each pixel to be added to; end_sample() follows.
  Sum& open(std::size_t pixel) { return open_[pixel]; }
  void end_sample() {
    if (++count_ % kBlockSamples == 0) close_block();
  }

  // Gives back the memory of nodes that are not whole, which close_block() would use again.
  void trim() {
    for (std::size_t level = 0; level < whole_.size(); ++level) {
      if ((blocks() >> level & 1) == 0) whole_[level] = {};
    }
  }

  // Over all samples: the nodes of the tree that are whole, the youngest first, then their elders.
  Sum total(std::size_t pixel) const {
    Sum sum = open_[pixel];
    for (std::size_t level = 0; level < whole_.size(); ++level) {
      if (blocks() >> level & 1) sum += whole_[level][pixel];
    }
    return sum;
  }

 private:
  std::uint32_t blocks() const { return count_ / kBlockSamples; }

  // As a binary counter is increased: two whole nodes of a level are one of the next.
  void close_block() {
    const auto level = static_cast<std::size_t>(std::countr_one(blocks() - 1));
    for (std::size_t l = 0; l < level; ++l) {
      for (std::size_t i = 0; i < open_.size(); ++i) open_[i] += whole_[l][i];
    }
    if (level == whole_.size()) whole_.emplace_back();
    whole_[level] = open_;
    open_.assign(open_.size(), Sum{});
  }

  std::uint32_t count_ = 0;
  std::vector<Sum> open_;                // of the block that is not full yet
  std::vector<std::vector<Sum>> whole_;  // by level: of 2^level blocks, where blocks() has that bit
};

}  // namespace msbvh
