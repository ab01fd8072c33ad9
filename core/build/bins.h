// Bins along the three axes, and the search for the best plane between them: all axes at once, one a lane.
#pragma once

#include <cstdint>
#include <limits>

#include "core/build/sah.h"

namespace msbvh {

// Only the bins in use are ever written or looked at: a small set's are few.
template <int kMax>
struct Bins {
  // Not boxes, whose constructor would fill all of them.
  __m128 lo[kMax][3], hi[kMax][3];
  alignas(16) std::uint32_t enter[kMax][4], leave[kMax][4];  // references that begin and that end in a bin
  int count;

  explicit Bins(int bins) : count(bins) {
    const Box4 none;
    for (int b = 0; b < bins; ++b) {
      for (int axis = 0; axis < 3; ++axis) lo[b][axis] = none.lo, hi[b][axis] = none.hi;
      _mm_store_si128(reinterpret_cast<__m128i*>(enter[b]), _mm_setzero_si128());
      _mm_store_si128(reinterpret_cast<__m128i*>(leave[b]), _mm_setzero_si128());
    }
  }
  Box4 box(int bin, int axis) const { return {lo[bin][axis], hi[bin][axis]}; }
  void grow(int bin, int axis, const Box4& b) {
    lo[bin][axis] = _mm_min_ps(lo[bin][axis], b.lo);
    hi[bin][axis] = _mm_max_ps(hi[bin][axis], b.hi);
  }
  void add(const Bins& other) {
    for (int b = 0; b < count; ++b) {
      for (int axis = 0; axis < 3; ++axis) {
        grow(b, axis, other.box(b, axis));
        enter[b][axis] += other.enter[b][axis];
        leave[b][axis] += other.leave[b][axis];
      }
    }
  }
  Box4 union_of(int axis, int begin, int end) const {
    Box4 all;
    for (int b = begin; b < end; ++b) all.grow(box(b, axis));
    return all;
  }
};

// Infinite cost: no plane has something on either side of it.
struct BestPlane {
  float cost = std::numeric_limits<float>::infinity();
  int axis = 0;
  int first_right_bin = 0;
};

namespace detail {

// What grows bin by bin from one end, and its cost; infinite while there is nothing.
struct SweepSide {
  Box4 box[3];
  __m128i count = _mm_setzero_si128();

  template <int kMax>
  void grow(const Bins<kMax>& bins, int bin, const std::uint32_t (&counts)[kMax][4]) {
    for (int axis = 0; axis < 3; ++axis) box[axis].grow(bins.box(bin, axis));
    count = _mm_add_epi32(count, _mm_load_si128(reinterpret_cast<const __m128i*>(counts[bin])));
  }
  __m128 costs() const {
    const __m128 none = _mm_castsi128_ps(_mm_cmpeq_epi32(count, _mm_setzero_si128()));
    return select4(none, _mm_set1_ps(std::numeric_limits<float>::infinity()),
                   _mm_mul_ps(half_areas(box[0], box[1], box[2]), block_counts(count)));
  }
};

}  // namespace detail

// Between bins b - 1 and b: those that enter below it are on its left, those that leave above on its right.
template <int kMax>
BestPlane best_plane(const Bins<kMax>& bins) {
  __m128 right_costs[kMax];
  detail::SweepSide side;
  for (int b = bins.count - 1; b > 0; --b) {
    side.grow(bins, b, bins.leave);
    right_costs[b] = side.costs();
  }
  side = {};
  __m128 best = _mm_set1_ps(std::numeric_limits<float>::infinity());
  __m128 best_bin = _mm_setzero_ps();
  for (int b = 1; b < bins.count; ++b) {
    side.grow(bins, b - 1, bins.enter);
    const __m128 costs = _mm_add_ps(side.costs(), right_costs[b]);
    const __m128 better = _mm_cmplt_ps(costs, best);
    best = select4(better, costs, best);
    best_bin = select4(better, _mm_set1_ps(static_cast<float>(b)), best_bin);
  }
  alignas(16) float costs[4], first_right[4];
  _mm_store_ps(costs, best);
  _mm_store_ps(first_right, best_bin);
  BestPlane plane;
  for (int axis = 0; axis < 3; ++axis) {
    if (costs[axis] < plane.cost) plane = {costs[axis], axis, static_cast<int>(first_right[axis])};
  }
  return plane;
}

}  // namespace msbvh
