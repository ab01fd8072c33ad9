// The SIMD twin of core/base/lerp.h: fma(w1, b, w0 * a), both weights >= 0. Where the instruction set has no
// fused multiply-add the sum is rounded once more; both forms are monotone in a and b. Boxes and vertices of
// one traversal go through this function and no other.

#if defined(MSBVH_SIMD_LERP_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MSBVH_SIMD_LERP_INL_H
#undef MSBVH_SIMD_LERP_INL_H
#else
#define MSBVH_SIMD_LERP_INL_H
#endif

#include <cstdint>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace msbvh::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// The weights of a segment's two keys: at one time, or at as many as there are lanes.
template <class D>
struct Weights {
  hn::Vec<D> w0, w1;
  Weights(D d, float w) : w0(hn::Set(d, 1.0f - w)), w1(hn::Set(d, w)) {}
  Weights(D d, hn::Vec<D> w) : w0(hn::Sub(hn::Set(d, 1.0f), w)), w1(w) {}
};

template <class D>
HWY_INLINE hn::Vec<D> simd_lerp(hn::Vec<D> a, hn::Vec<D> b, const Weights<D>& w) {
  return hn::MulAdd(w.w1, b, hn::Mul(w.w0, a));
}

// The SIMD twin of core/motion/bezier.h: nested calls of the one lerp. `control(i)` loads control i of the
// segment.
template <class D, class Controls>
HWY_INLINE hn::Vec<D> simd_bezier(const Controls& control, std::uint32_t degree, const Weights<D>& w) {
  const auto b1 = control(1);
  const auto a = simd_lerp<D>(control(0), b1, w);
  if (degree == 1) return a;
  const auto b2 = control(2);
  const auto b = simd_lerp<D>(b1, b2, w);
  const auto ab = simd_lerp<D>(a, b, w);
  if (degree == 2) return ab;
  const auto bc = simd_lerp<D>(b, simd_lerp<D>(b2, control(3), w), w);
  return simd_lerp<D>(ab, bc, w);
}

}  // namespace msbvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
