// Boxes in SSE registers, for the builder's inner loops. Lane 3 carries nothing of meaning. SSE2 is part of
// x86-64.
#pragma once

#include <emmintrin.h>
#include <limits>

#include "core/base/box.h"

namespace msbvh {

inline __m128 load4(const Vec3f* p) { return _mm_loadu_ps(reinterpret_cast<const float*>(p)); }

// Lanes of `a` where the mask is set, of `b` elsewhere.
inline __m128 select4(__m128 mask, __m128 a, __m128 b) {
  return _mm_or_ps(_mm_and_ps(mask, a), _mm_andnot_ps(mask, b));
}

struct Box4 {
  __m128 lo = _mm_set1_ps(std::numeric_limits<float>::infinity());
  __m128 hi = _mm_set1_ps(-std::numeric_limits<float>::infinity());

  Box4() = default;
  Box4(__m128 lo_, __m128 hi_) : lo(lo_), hi(hi_) {}
  // Two loads that stay inside the box; no lane is filled with what is not a coordinate (a denormal would be
  // slow to compute with).
  explicit Box4(const Box3f& box) {
    const float* p = reinterpret_cast<const float*>(&box);
    static_assert(sizeof(Box3f) == 6 * sizeof(float));
    const __m128 high = _mm_loadu_ps(p + 2);
    lo = _mm_loadu_ps(p);
    hi = _mm_shuffle_ps(high, high, _MM_SHUFFLE(3, 3, 2, 1));
  }

  void grow(__m128 point) {
    lo = _mm_min_ps(lo, point);
    hi = _mm_max_ps(hi, point);
  }
  void grow(const Box4& b) {
    lo = _mm_min_ps(lo, b.lo);
    hi = _mm_max_ps(hi, b.hi);
  }
  // Twice the centre: a sum that orders boxes as well.
  __m128 sum() const { return _mm_add_ps(lo, hi); }
  bool empty() const { return (_mm_movemask_ps(_mm_cmpgt_ps(lo, hi)) & 7) != 0; }

  void store(Box3f& box) const {
    float* p = reinterpret_cast<float*>(&box);
    const __m128 zx = _mm_shuffle_ps(lo, hi, _MM_SHUFFLE(0, 0, 2, 2));
    _mm_storeu_ps(p, lo);
    _mm_storeu_ps(p + 2, _mm_shuffle_ps(zx, hi, _MM_SHUFFLE(2, 1, 2, 0)));
  }
  Box3f box() const {
    alignas(16) float l[4], h[4];
    _mm_store_ps(l, lo);
    _mm_store_ps(h, hi);
    return {{l[0], l[1], l[2]}, {h[0], h[1], h[2]}};
  }
};

inline Box4 intersect(const Box4& a, const Box4& b) {
  return {_mm_max_ps(a.lo, b.lo), _mm_min_ps(a.hi, b.hi)};
}

// As half_area() of three boxes, in lanes 0 to 2; not a number, or infinite, for empty ones.
inline __m128 half_areas(const Box4& a, const Box4& b, const Box4& c) {
  __m128 x = _mm_sub_ps(a.hi, a.lo), y = _mm_sub_ps(b.hi, b.lo), z = _mm_sub_ps(c.hi, c.lo), w = z;
  _MM_TRANSPOSE4_PS(x, y, z, w);
  return _mm_add_ps(_mm_mul_ps(x, _mm_add_ps(y, z)), _mm_mul_ps(y, z));
}

// 0 for an empty box.
inline float half_area(const Box4& b) {
  const __m128 e = _mm_max_ps(_mm_sub_ps(b.hi, b.lo), _mm_setzero_ps());
  const __m128 p = _mm_mul_ps(e, _mm_shuffle_ps(e, e, _MM_SHUFFLE(3, 0, 2, 1)));
  const __m128 xz = _mm_add_ss(p, _mm_movehl_ps(p, p));
  return _mm_cvtss_f32(_mm_add_ss(xz, _mm_shuffle_ps(p, p, _MM_SHUFFLE(1, 1, 1, 1))));
}

}  // namespace msbvh
