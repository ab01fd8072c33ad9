// Object splits of moving sets: a binned SAH over mean areas, by position at the centre and by velocity.
#pragma once

#include <limits>
#include <span>

#include "core/build/moving_set.h"

namespace msbvh {

// Axes 0 to 2 are of position, 3 to 5 of drift over the shutter.
class MovingBinning {
 public:
  static constexpr int kMaxBins = 16;

  MovingBinning(const MovingBounds& bounds, std::size_t references);
  int bins() const { return bins_; }
  __m128i bins_of(const ShutterBox& b, bool by_drift) const {
    const int i = by_drift ? 1 : 0;
    const __m128 x = _mm_mul_ps(_mm_sub_ps(by_drift ? b.drift() : b.position(), lo_[i]), scale_[i]);
    return _mm_cvttps_epi32(_mm_min_ps(_mm_max_ps(x, _mm_setzero_ps()), last_));
  }

 private:
  __m128 lo_[2], scale_[2], last_;
  int bins_;
};

struct MovingSplit {
  float cost = std::numeric_limits<float>::infinity();  // as ObjectSplit::cost, of mean areas
  int axis = 0;
  int first_right_bin = 0;
};

MovingSplit find_moving_split(std::span<const MovingReference> references, const MovingBinning& binning,
                              const MeanArea& mean_area);

}  // namespace msbvh
