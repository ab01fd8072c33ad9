// Object splits: a binned SAH over the centres of the references' boxes at the shutter's centre.
// I. Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", RT 2007.
#pragma once

#include <limits>
#include <span>

#include "core/build/reference.h"
#include "core/build/sah.h"

namespace msbvh {

// Which of equal bins a reference falls in along each axis, by its box's centre. Small sets have fewer: a bin
// costs as much as a reference.
class ObjectBinning {
 public:
  static constexpr int kMaxBins = 32;

  ObjectBinning(const SetBounds& bounds, std::size_t references);
  int bins() const { return bins_; }
  // Lanes 0 to 2; 0 along an axis on which nothing can be told apart.
  __m128i bins_of(const Box4& box) const {
    const __m128 x = _mm_mul_ps(_mm_sub_ps(box.sum(), lo_), scale_);
    return _mm_cvttps_epi32(_mm_min_ps(_mm_max_ps(x, _mm_setzero_ps()), last_));
  }

 private:
  __m128 lo_, scale_, last_;
  int bins_;
};

// References whose bin along `axis` is below `first_right_bin` go left. `cost` is the area-weighted number of
// blocks, infinite if there is no split that leaves something on both sides.
struct ObjectSplit {
  float cost = std::numeric_limits<float>::infinity();
  int axis = 0;
  int first_right_bin = 0;
  Box4 left, right;
};

ObjectSplit find_object_split(std::span<const Reference> references, const ObjectBinning& binning);

// The split's predicate.
class IsLeftOfBin {
 public:
  IsLeftOfBin(const ObjectBinning& binning, const ObjectSplit& split)
      : binning_(binning), first_right_(_mm_set1_epi32(split.first_right_bin)), axis_(split.axis) {}
  bool operator()(const Box4& box, const Reference&) const {
    const __m128i left = _mm_cmplt_epi32(binning_.bins_of(box), first_right_);
    return ((_mm_movemask_ps(_mm_castsi128_ps(left)) >> axis_) & 1) != 0;
  }

 private:
  const ObjectBinning binning_;
  const __m128i first_right_;
  const int axis_;
};

}  // namespace msbvh
