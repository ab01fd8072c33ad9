#include "core/build/object_split.h"

#include <cstring>

#include "core/build/bins.h"
#include "core/build/reduce.h"

namespace msbvh {
namespace {

// Above this, a set is looked at in parallel, in chunks of this size.
constexpr std::size_t kChunk = 16384;

using ObjectBins = Bins<ObjectBinning::kMaxBins>;

void add(std::span<const Reference> references, const ObjectBinning& binning, ObjectBins& bins) {
  for (const Reference& r : references) {
    const Box4 b(r.box);
    alignas(16) std::int32_t bin[4];
    _mm_store_si128(reinterpret_cast<__m128i*>(bin), binning.bins_of(b));
    for (int axis = 0; axis < 3; ++axis) {
      bins.grow(bin[axis], axis, b);
      ++bins.enter[bin[axis]][axis];
    }
  }
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
  ObjectBins bins = reduce_in_chunks<ObjectBins>(
      references.size(), kChunk, [&] { return ObjectBins(binning.bins()); },
      [&](ObjectBins& sum, std::size_t begin, std::size_t end) {
        add(references.subspan(begin, end - begin), binning, sum);
      },
      [](ObjectBins& sum, const ObjectBins& part) { sum.add(part); });
  std::memcpy(bins.leave, bins.enter, sizeof(bins.enter));  // a reference is in one bin
  const BestPlane best = best_plane(bins);
  return {best.cost, best.axis, best.first_right_bin, bins.union_of(best.axis, 0, best.first_right_bin),
          bins.union_of(best.axis, best.first_right_bin, bins.count)};
}

}  // namespace msbvh
