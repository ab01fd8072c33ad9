// Sorts a set of references into left and right, and bounds both on the way.
#pragma once

#include <span>
#include <vector>

#include "core/base/parallel.h"
#include "core/build/reference.h"
#include "core/build/sah.h"

namespace msbvh {

struct Halves {
  std::size_t left_count = 0;
  SetBounds bounds[2];  // left, right

  const SetBounds& left() const { return bounds[0]; }
  const SetBounds& right() const { return bounds[1]; }
};

namespace detail {

// Sets from this size on are sorted in parallel, in chunks of this size.
inline constexpr std::size_t kPartitionChunk = 32768;

// Grows one of two bounds without a branch: a minimum with what is not a number is the other operand.
class HalfBounds {
 public:
  void grow(const Box4& box, bool left) {
    const __m128 in_left = _mm_castsi128_ps(_mm_set1_epi32(-static_cast<int>(left)));
    const __m128 in_right = _mm_castsi128_ps(_mm_set1_epi32(static_cast<int>(left) - 1));
    grow(bounds_[0], box, in_right);
    grow(bounds_[1], box, in_left);
  }
  const SetBounds& operator[](int side) const { return bounds_[side]; }

 private:
  static void grow(SetBounds& bounds, const Box4& box, __m128 not_this) {
    const __m128 lo = _mm_or_ps(box.lo, not_this), hi = _mm_or_ps(box.hi, not_this);
    const __m128 sum = _mm_or_ps(box.sum(), not_this);
    bounds.box = {_mm_min_ps(lo, bounds.box.lo), _mm_max_ps(hi, bounds.box.hi)};
    bounds.sums = {_mm_min_ps(sum, bounds.sums.lo), _mm_max_ps(sum, bounds.sums.hi)};
  }

  SetBounds bounds_[2];
};

// Lomuto's scheme, without a branch to mispredict: every reference is swapped to the end of the left ones,
// which then grow by it or not. The box is loaded from where it lies: loads across recent stores stall.
template <typename Ref, typename IsLeft>
Halves partition_chunk(std::span<Ref> references, const IsLeft& is_left) {
  HalfBounds bounds;
  std::size_t left = 0;
  for (std::size_t i = 0; i < references.size(); ++i) {
    const Box4 box(references[i].box);
    const Ref r = references[i];
    const bool is = is_left(box, references[i]);
    references[i] = references[left];
    references[left] = r;
    left += is;
    bounds.grow(box, is);
  }
  return {left, {bounds[0], bounds[1]}};
}

// Where in the set the k-th reference is that its chunk has sorted to the wrong side of `middle`.
class Misplaced {
 public:
  void add(std::size_t begin, std::size_t end) {
    if (begin >= end) return;
    runs_.push_back({begin, end, count_});
    count_ += end - begin;
  }
  std::size_t count() const { return count_; }
  std::size_t at(std::size_t k) const {
    const auto after = std::upper_bound(runs_.begin(), runs_.end(), k,
                                        [](std::size_t i, const Run& run) { return i < run.first; });
    const Run& run = *(after - 1);
    return run.begin + (k - run.first);
  }

 private:
  struct Run {
    std::size_t begin, end, first;
  };
  std::vector<Run> runs_;
  std::size_t count_ = 0;
};

template <typename Ref>
void swap_misplaced(std::span<Ref> references, const std::vector<Halves>& chunks, std::size_t middle) {
  Misplaced rights, lefts;  // in the left part, in the right part: equally many
  for (std::size_t c = 0; c < chunks.size(); ++c) {
    const std::size_t begin = c * kPartitionChunk, end = std::min(begin + kPartitionChunk, references.size());
    const std::size_t split = begin + chunks[c].left_count;
    rights.add(split, std::min(end, middle));
    lefts.add(std::max(begin, middle), split);
  }
  parallel_for_ranges(rights.count(), kPartitionChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) std::swap(references[rights.at(k)], references[lefts.at(k)]);
  });
}

}  // namespace detail

// `is_left` is given a reference and its box. The order within each side depends on that before, but not on
// the number of threads.
template <typename Ref, typename IsLeft>
Halves partition(std::span<Ref> references, const IsLeft& is_left) {
  using namespace detail;
  if (references.size() <= kPartitionChunk) return partition_chunk(references, is_left);
  std::vector<Halves> chunks((references.size() + kPartitionChunk - 1) / kPartitionChunk);
  parallel_for_ranges(references.size(), kPartitionChunk, [&](std::size_t begin, std::size_t end) {
    chunks[begin / kPartitionChunk] = partition_chunk(references.subspan(begin, end - begin), is_left);
  });
  Halves all;
  for (const Halves& chunk : chunks) {
    all.left_count += chunk.left_count;
    for (int side = 0; side < 2; ++side) all.bounds[side].grow(chunk.bounds[side]);
  }
  swap_misplaced(references, chunks, all.left_count);
  return all;
}

}  // namespace msbvh
