#include "core/build/object_split.h"

#include <array>

#include "core/build/reduce.h"

namespace msbvh {
namespace {

// Above this, a set is looked at in parallel, in chunks of this size.
constexpr std::size_t kChunk = 16384;

struct Bins {
  // Not boxes, whose constructor would fill all of them: only the bins in use are ever looked at.
  __m128 lo[ObjectBinning::kMaxBins][3], hi[ObjectBinning::kMaxBins][3];
  // One lane an axis; lane 3 is unused.
  alignas(16) std::uint32_t count[ObjectBinning::kMaxBins][4];

  explicit Bins(int bins) {
    const Box4 none;
    for (int b = 0; b < bins; ++b) {
      for (int axis = 0; axis < 3; ++axis) lo[b][axis] = none.lo, hi[b][axis] = none.hi;
      _mm_store_si128(reinterpret_cast<__m128i*>(count[b]), _mm_setzero_si128());
    }
  }
  Box4 box(int bin, int axis) const { return {lo[bin][axis], hi[bin][axis]}; }
  void grow(int bin, int axis, const Box4& b) {
    lo[bin][axis] = _mm_min_ps(lo[bin][axis], b.lo);
    hi[bin][axis] = _mm_max_ps(hi[bin][axis], b.hi);
  }
  void add(std::span<const Reference> references, const ObjectBinning& binning) {
    for (const Reference& r : references) {
      const Box4 b(r.box);
      alignas(16) std::int32_t bin[4];
      _mm_store_si128(reinterpret_cast<__m128i*>(bin), binning.bins_of(b));
      for (int axis = 0; axis < 3; ++axis) {
        grow(bin[axis], axis, b);
        ++count[bin[axis]][axis];
      }
    }
  }
  void add(const Bins& other, int bins) {
    for (int b = 0; b < bins; ++b) {
      for (int axis = 0; axis < 3; ++axis) {
        grow(b, axis, other.box(b, axis));
        count[b][axis] += other.count[b][axis];
      }
    }
  }
  __m128i counts(int bin) const { return _mm_load_si128(reinterpret_cast<const __m128i*>(count[bin])); }
};

// Boxes that grow bin by bin, one an axis, and the cost of what is in them.
struct Side {
  Box4 box[3];
  __m128i count = _mm_setzero_si128();

  void grow(const Bins& bins, int bin) {
    for (int axis = 0; axis < 3; ++axis) box[axis].grow(bins.box(bin, axis));
    count = _mm_add_epi32(count, bins.counts(bin));
  }
  __m128 costs() const { return _mm_mul_ps(half_areas(box[0], box[1], box[2]), block_counts(count)); }
  __m128 none() const { return _mm_castsi128_ps(_mm_cmpeq_epi32(count, _mm_setzero_si128())); }
};

// All three axes at once, one a lane.
ObjectSplit sweep(const Bins& bins, int bin_count) {
  const __m128 infinity = _mm_set1_ps(std::numeric_limits<float>::infinity());
  __m128 right_cost[ObjectBinning::kMaxBins];
  Side side;
  for (int b = bin_count - 1; b > 0; --b) {
    side.grow(bins, b);
    right_cost[b] = select4(side.none(), infinity, side.costs());
  }
  side = {};
  __m128 best = infinity;
  __m128i best_bin = _mm_setzero_si128();
  for (int b = 1; b < bin_count; ++b) {
    side.grow(bins, b - 1);
    const __m128 cost = _mm_add_ps(select4(side.none(), infinity, side.costs()), right_cost[b]);
    const __m128 better = _mm_cmplt_ps(cost, best);
    best = select4(better, cost, best);
    best_bin =
        _mm_castps_si128(select4(better, _mm_castsi128_ps(_mm_set1_epi32(b)), _mm_castsi128_ps(best_bin)));
  }
  alignas(16) float costs[4];
  alignas(16) std::int32_t first_right[4];
  _mm_store_ps(costs, best);
  _mm_store_si128(reinterpret_cast<__m128i*>(first_right), best_bin);
  ObjectSplit split;
  for (int axis = 0; axis < 3; ++axis) {
    if (costs[axis] < split.cost) split = {costs[axis], axis, first_right[axis], {}, {}};
  }
  return split;
}

}  // namespace

ObjectBinning::ObjectBinning(const SetBounds& bounds, std::size_t references)
    : lo_(bounds.sums.lo), bins_(static_cast<int>(std::min<std::size_t>(kMaxBins, 4 + references / 8))) {
  last_ = _mm_set1_ps(static_cast<float>(bins_ - 1));
  const __m128 extent = _mm_sub_ps(bounds.sums.hi, lo_);
  const __m128 scale = _mm_div_ps(_mm_set1_ps(0.9999f * static_cast<float>(bins_)), extent);
  // A denormal extent is as good as none: its scale is infinite.
  const __m128 usable = _mm_and_ps(_mm_cmpgt_ps(extent, _mm_setzero_ps()),
                                   _mm_cmplt_ps(scale, _mm_set1_ps(std::numeric_limits<float>::infinity())));
  scale_ = _mm_and_ps(usable, scale);
}

ObjectSplit find_object_split(std::span<const Reference> references, const ObjectBinning& binning) {
  const int count = binning.bins();
  const Bins bins = reduce_in_chunks<Bins>(
      references.size(), kChunk, [&] { return Bins(count); },
      [&](Bins& sum, std::size_t begin, std::size_t end) {
        sum.add(references.subspan(begin, end - begin), binning);
      },
      [&](Bins& sum, const Bins& part) { sum.add(part, count); });
  ObjectSplit split = sweep(bins, count);
  for (int b = 0; b < count; ++b) {
    (b < split.first_right_bin ? split.left : split.right).grow(bins.box(b, split.axis));
  }
  return split;
}

}  // namespace msbvh
