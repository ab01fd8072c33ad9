#include "core/build/moving_split.h"

#include "core/build/reduce.h"

namespace msbvh {
namespace {

constexpr std::size_t kChunk = 8192;
constexpr int kAxes = 6;

struct MovingBins {
  // A union, so that only the bins in use are ever written or looked at: a small set's are few.
  union {
    ShutterBox box[MovingBinning::kMaxBins][kAxes];
  };
  alignas(16) std::uint32_t count[MovingBinning::kMaxBins][8];  // axes 0 to 2, unused, 3 to 5, unused
  int bins;
  static constexpr int lane(int axis) { return axis < 3 ? axis : axis + 1; }

  explicit MovingBins(int bins_) : bins(bins_) {
    for (int b = 0; b < bins; ++b) {
      for (ShutterBox& along : box[b]) along = ShutterBox();
      for (std::uint32_t& c : count[b]) c = 0;
    }
  }
  void add(std::span<const MovingReference> references, const MovingBinning& binning) {
    for (const MovingReference& r : references) {
      const ShutterBox b(r);
      alignas(16) std::int32_t bin[8];
      _mm_store_si128(reinterpret_cast<__m128i*>(bin), binning.bins_of(b, false));
      _mm_store_si128(reinterpret_cast<__m128i*>(bin + 4), binning.bins_of(b, true));
      for (int axis = 0; axis < kAxes; ++axis) {
        box[bin[lane(axis)]][axis].grow(b);
        ++count[bin[lane(axis)]][lane(axis)];
      }
    }
  }
  void add(const MovingBins& other) {
    for (int b = 0; b < bins; ++b) {
      for (int axis = 0; axis < kAxes; ++axis) {
        box[b][axis].grow(other.box[b][axis]);
        count[b][lane(axis)] += other.count[b][lane(axis)];
      }
    }
  }
};

// What grows bin by bin from one end, along three axes, one a lane.
struct Side {
  ShutterBox box[3];
  __m128i count = _mm_setzero_si128();

  void grow(const MovingBins& bins, int bin, int group) {
    for (int axis = 0; axis < 3; ++axis) box[axis].grow(bins.box[bin][3 * group + axis]);
    count =
        _mm_add_epi32(count, _mm_load_si128(reinterpret_cast<const __m128i*>(bins.count[bin] + 4 * group)));
  }
  __m128 costs(const MeanArea& mean_area) const {
    const __m128 none = _mm_castsi128_ps(_mm_cmpeq_epi32(count, _mm_setzero_si128()));
    return select4(none, _mm_set1_ps(std::numeric_limits<float>::infinity()),
                   _mm_mul_ps(mean_area(box), block_counts(count)));
  }
};

void sweep(const MovingBins& bins, int bin_count, int group, const MeanArea& mean_area, MovingSplit& best) {
  alignas(16) float costs[MovingBinning::kMaxBins][4];
  Side side;
  for (int b = bin_count - 1; b > 0; --b) {
    side.grow(bins, b, group);
    _mm_store_ps(costs[b], side.costs(mean_area));
  }
  side = {};
  for (int b = 1; b < bin_count; ++b) {
    side.grow(bins, b - 1, group);
    _mm_store_ps(costs[b], _mm_add_ps(_mm_load_ps(costs[b]), side.costs(mean_area)));
    for (int axis = 0; axis < 3; ++axis) {
      if (costs[b][axis] < best.cost) best = {costs[b][axis], 3 * group + axis, b};
    }
  }
}

}  // namespace

MovingBinning::MovingBinning(const MovingBounds& bounds, std::size_t references)
    : bins_(static_cast<int>(std::min<std::size_t>(kMaxBins, 4 + references / 8))) {
  last_ = _mm_set1_ps(static_cast<float>(bins_ - 1));
  for (int i = 0; i < 2; ++i) {
    const Box4& range = i == 0 ? bounds.positions : bounds.drifts;
    const __m128 extent = _mm_sub_ps(range.hi, range.lo);
    const __m128 scale = _mm_div_ps(_mm_set1_ps(0.9999f * static_cast<float>(bins_)), extent);
    const __m128 usable =
        _mm_and_ps(_mm_cmpgt_ps(extent, _mm_setzero_ps()),
                   _mm_cmplt_ps(scale, _mm_set1_ps(std::numeric_limits<float>::infinity())));
    lo_[i] = range.lo;
    scale_[i] = _mm_and_ps(usable, scale);
  }
}

MovingSplit find_moving_split(std::span<const MovingReference> references, const MovingBinning& binning,
                              const MeanArea& mean_area) {
  const MovingBins bins = reduce_in_chunks<MovingBins>(
      references.size(), kChunk, [&] { return MovingBins(binning.bins()); },
      [&](MovingBins& sum, std::size_t begin, std::size_t end) {
        sum.add(references.subspan(begin, end - begin), binning);
      },
      [](MovingBins& sum, const MovingBins& part) { sum.add(part); });
  MovingSplit best;
  for (int group = 0; group < 2; ++group) sweep(bins, binning.bins(), group, mean_area, best);
  return best;
}

}  // namespace msbvh
