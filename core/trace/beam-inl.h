// The intervals that the rays of a packet span: 8 boxes are held against all of the rays at once, and those
// that none of them can enter are left out (interval arithmetic: A. Reshetov, A. Soupikov, J. Hurley,
// "Multi-Level Ray Tracing Algorithm", SIGGRAPH 2005; S. Boulos, I. Wald, P. Shirley, "Geometric and
// Arithmetic Culling Methods for Entire Ray Packets", 2006).
//
// Never leaves out a box that a ray's own test enters: the bounds are the same operations on the ends of the
// intervals, and each of them is monotone, rounding included. Interpolation alone is not monotone in its
// weight: moving planes are padded.

#if defined(MSBVH_BEAM_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MSBVH_BEAM_INL_H
#undef MSBVH_BEAM_INL_H
#else
#define MSBVH_BEAM_INL_H
#endif

#include <algorithm>
#include <cstdint>
#include <hwy/highway.h>
#include <limits>

#include "core/base/lerp.h"
#include "core/trace/node_test-inl.h"

HWY_BEFORE_NAMESPACE();
namespace msbvh::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

struct Interval {
  float lo = 0.0f, hi = 0.0f;
};
// Of those that are not NaN: such a ray enters nothing.
template <std::size_t kCount>
HWY_INLINE Interval interval_of(const float (&values)[kCount]) {
  const hn::CappedTag<float, kCount> d;
  auto lo = hn::Set(d, std::numeric_limits<float>::infinity()), hi = hn::Neg(lo);
  for (std::size_t i = 0; i < kCount; i += hn::Lanes(d)) {
    lo = hn::Min(hn::Load(d, values + i), lo);  // the second operand where one is NaN, on x86
    hi = hn::Max(hn::Load(d, values + i), hi);
  }
  return {hn::GetLane(hn::MinOfLanes(d, lo)), hn::GetLane(hn::MaxOfLanes(d, hi))};
}

class Beam {
 public:
  // Values of each ray, by axis where there are three.
  template <std::size_t kCount>
  HWY_INLINE void set(const float (&org)[3][kCount], const float (&reciprocal)[3][kCount],
                      const float (&tnear)[kCount], const float (&time)[kCount]) {
    nearest_ = interval_of(tnear).lo;
    time_ = interval_of(time);
    for (int axis = 0; axis < 3; ++axis) {
      org_[axis] = interval_of(org[axis]);
      reciprocal_[axis] = interval_of(reciprocal[axis]);
      // Rays that run both ways, or along the planes, may be anywhere on the axis.
      const Interval r = reciprocal_[axis];
      bounds_[axis] = r.lo * r.hi > 0.0f && r.hi - r.lo < std::numeric_limits<float>::infinity();
      backwards_[axis] = r.hi < 0.0f;
    }
  }

  // A bit for each of 8 boxes that a ray may enter before `farthest`. `first`: the control in force, of a
  // node of 2^k `segments`, 0 for a still one, whose segment `key` the rays are in.
  template <bool kMoves, bool kPolynomial>
  HWY_INLINE std::uint32_t meets(const NodeBounds* first, std::uint32_t degree, std::uint32_t segments,
                                 std::uint32_t key, float farthest) const {
    const D d;
    const auto at = [&](float time) {
      const float w = time * static_cast<float>(segments) - static_cast<float>(key);
      return Weights<D>(d, kMoves ? std::clamp(w, 0.0f, 1.0f) : 0.0f);
    };
    const Weights<D> w0 = at(time_.lo), w1 = at(time_.hi);
    std::uint32_t met = 0;
    for (std::size_t lane = 0; lane < kWidth; lane += ChildKeys::kLanes) {
      V enter = hn::Set(d, nearest_), leave = hn::Set(d, farthest);
      for (int axis = 0; axis < 3; ++axis) {
        if (!bounds_[axis]) continue;
        const float *lo = first->axis[axis].lo + lane, *hi = first->axis[axis].hi + lane;
        if constexpr (kMoves) {
          const std::uint32_t n = kPolynomial ? degree : 1;
          clip(axis, swept(lo, n, w0, w1).lo, swept(hi, n, w0, w1).hi, enter, leave);
        } else {
          clip(axis, hn::Load(d, lo), hn::Load(d, hi), enter, leave);
        }
      }
      std::uint8_t bits[8] = {};
      hn::StoreMaskBits(d, hn::Le(enter, hn::Mul(leave, hn::Set(d, kFarFactor))), bits);
      met |= static_cast<std::uint32_t>(bits[0]) << lane;
    }
    return met;
  }

 private:
  using D = hn::CappedTag<float, kWidth>;
  using V = hn::Vec<D>;
  // Of the largest control: what interpolation may err, there and here, at each degree (core/base/lerp.h).
  static constexpr float kPad = 2 * kMaxDegree * kLerpError;

  struct Planes {
    V lo, hi;
  };
  // Between which planes move while the weight goes from w0 to w1; curves between all of their controls.
  HWY_INLINE static Planes swept(const float* plane, std::uint32_t degree, const Weights<D>& w0,
                                 const Weights<D>& w1) {
    const D d;
    constexpr std::size_t kStride = sizeof(NodeBounds) / sizeof(float);
    const V a = hn::Load(d, plane), b = hn::Load(d, plane + kStride);
    V size = hn::Max(hn::Abs(a), hn::Abs(b)), lo, hi;
    if (degree == 1) {
      const V x0 = simd_lerp<D>(a, b, w0), x1 = simd_lerp<D>(a, b, w1);
      lo = hn::Min(x0, x1);
      hi = hn::Max(x0, x1);
    } else {
      lo = hn::Min(a, b);
      hi = hn::Max(a, b);
      for (std::uint32_t c = 2; c <= degree; ++c) {
        const V x = hn::Load(d, plane + c * kStride);
        lo = hn::Min(lo, x);
        hi = hn::Max(hi, x);
        size = hn::Max(size, hn::Abs(x));
      }
    }
    const V pad = hn::Mul(size, hn::Set(d, kPad));
    return {hn::Sub(lo, pad), hn::Add(hi, pad)};
  }

  // Bounds on the distances of the near and of the far planes.
  HWY_INLINE void clip(int axis, V lo, V hi, V& enter, V& leave) const {
    const D d;
    const V r0 = hn::Set(d, reciprocal_[axis].lo), r1 = hn::Set(d, reciprocal_[axis].hi);
    const V from_lo = hn::Sub(lo, hn::Set(d, org_[axis].hi)),
            from_hi = hn::Sub(hi, hn::Set(d, org_[axis].lo));
    const V near = backwards_[axis] ? from_hi : from_lo, far = backwards_[axis] ? from_lo : from_hi;
    enter = hn::Max(enter, hn::Min(hn::Mul(near, r0), hn::Mul(near, r1)));
    leave = hn::Min(leave, hn::Max(hn::Mul(far, r0), hn::Mul(far, r1)));
  }

  Interval org_[3], reciprocal_[3], time_;
  float nearest_;
  bool bounds_[3], backwards_[3];
};

}  // namespace msbvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
