// The SIMD twin of core/base/lerp.h: fma(w1, b, w0 * a), both weights >= 0. Where the instruction set has no
// fused multiply-add the sum is rounded once more; both forms are monotone in a and b. Boxes and vertices of
// one traversal go through this function and no other.

#if defined(MSBVH_SIMD_LERP_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MSBVH_SIMD_LERP_INL_H
#undef MSBVH_SIMD_LERP_INL_H
#else
#define MSBVH_SIMD_LERP_INL_H
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace msbvh::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// The weights of a segment's two keys.
template <class D>
struct Weights {
  hn::Vec<D> w0, w1;
  explicit Weights(D d, float w) : w0(hn::Set(d, 1.0f - w)), w1(hn::Set(d, w)) {}
};

template <class D>
HWY_INLINE hn::Vec<D> simd_lerp(hn::Vec<D> a, hn::Vec<D> b, const Weights<D>& w) {
  return hn::MulAdd(w.w1, b, hn::Mul(w.w0, a));
}

}  // namespace msbvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
