#include "core/bvh/track_area.h"

#include "core/build/box4.h"
#include "core/motion/bezier.h"

namespace msbvh {
namespace {

Box3d in_double(const Box3f& b) { return {Vec3d(b.lo), Vec3d(b.hi)}; }

// Half areas of two boxes: x, y and z of both, in double.
__m128d half_areas(const __m128d (&lo)[3], const __m128d (&hi)[3]) {
  __m128d extent[3], empty = _mm_setzero_pd();
  for (int i = 0; i < 3; ++i) {
    extent[i] = _mm_sub_pd(hi[i], lo[i]);
    empty = _mm_or_pd(empty, _mm_cmpgt_pd(lo[i], hi[i]));
  }
  const auto product = [&](int i, int j) { return _mm_mul_pd(extent[i], extent[j]); };
  return _mm_andnot_pd(empty, _mm_add_pd(_mm_add_pd(product(0, 1), product(1, 2)), product(2, 0)));
}

// Of x, y and z of `a` and `b`: their middle, as lerp() has it, and b's.
void middle_and_end(__m128 a, __m128 b, __m128d (&out)[3]) {
  const __m128 xy = _mm_unpacklo_ps(a, b);
  const __m128d both[3] = {_mm_cvtps_pd(xy), _mm_cvtps_pd(_mm_movehl_ps(xy, xy)),
                           _mm_cvtps_pd(_mm_unpackhi_ps(a, b))};
  for (int i = 0; i < 3; ++i) {
    const __m128d halves = _mm_mul_pd(both[i], _mm_set1_pd(0.5));
    out[i] = _mm_shuffle_pd(_mm_add_pd(halves, _mm_shuffle_pd(halves, halves, 1)), both[i], 2);
  }
}

// Sums over segments of the area's mean. Linear: Simpson's rule, exact up to degree 3.
double linear_area_sum(std::span<const Box3f> keys) {
  double sum = 0.0, begin_area = half_area(in_double(keys[0]));
  for (std::size_t k = 1; k < keys.size(); ++k) {
    const Box4 begin(keys[k - 1]), end(keys[k]);
    __m128d lo[3], hi[3];
    middle_and_end(begin.lo, end.lo, lo);
    middle_and_end(begin.hi, end.hi, hi);
    const __m128d areas = half_areas(lo, hi);
    const double middle_area = _mm_cvtsd_f64(areas), end_area = _mm_cvtsd_f64(_mm_unpackhi_pd(areas, areas));
    sum += (begin_area + 4.0 * middle_area + end_area) / 6.0;
    begin_area = end_area;
  }
  return sum;
}

// Gauss-Legendre with 4 points: exact up to degree 7.
double curved_area_sum(std::span<const Box3f> controls, const TrackForm& form) {
  constexpr double kNear = 0.33000947820757187, kFar = 0.06943184420297371;
  constexpr double kNearWeight = 0.32607257743127307, kFarWeight = 0.17392742256872693;
  double sum = 0.0;
  for (std::uint32_t k = 0; k < form.segments; ++k) {
    const Box3f* segment = controls.data() + k * form.degree;
    const auto at = [&](double w) {
      return half_area(bezier([&](std::uint32_t i) { return in_double(segment[i]); }, form.degree, w));
    };
    sum += kNearWeight * (at(kNear) + at(1.0 - kNear)) + kFarWeight * (at(kFar) + at(1.0 - kFar));
  }
  return sum;
}

}  // namespace

double mean_half_area(std::span<const Box3f> controls, const TrackForm& form) {
  if (!form.moving()) return half_area(in_double(controls[0]));
  return (form.degree == 1 ? linear_area_sum(controls) : curved_area_sum(controls, form)) / form.segments;
}

}  // namespace msbvh
