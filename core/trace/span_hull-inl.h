// Which of a block's spans of curves a ray may meet, all of them at once.
//
// Seen along the ray, a span's control points lie in a rectangle whose sides run along and across its chord.
// Grown by the largest radius it encloses all that is drawn around the span, whatever the shape: spans whose
// rectangle does not hold the ray are left out. Hairs are long and thin, so that few others remain.

#if defined(MSBVH_SPAN_HULL_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MSBVH_SPAN_HULL_INL_H
#undef MSBVH_SPAN_HULL_INL_H
#else
#define MSBVH_SPAN_HULL_INL_H
#endif

#include <cmath>
#include <cstdint>
#include <hwy/highway.h>

#include "core/geometry/curve_piece.h"
#include "core/trace/round_test-inl.h"

HWY_BEFORE_NAMESPACE();
namespace msbvh::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

class SpanHulls {
  using D = hn::CappedTag<float, kBlockWidth>;  // a lane a span
  using V = hn::Vec<D>;

 public:
  HWY_INLINE explicit SpanHulls(const StillSetup& setup) : setup_(setup), shear_(setup) {}

  // A bit for each of the block's pieces whose span the ray may meet in [tnear, tfar].
  template <Movement kMovement>
  HWY_INLINE std::uint32_t near(const CurveSet& curves, const BlockHeader& block,
                                const VerticesAtTime<kMovement>& at_time, float tfar) const {
    alignas(64) float vertex[kSpanVertices][kBlockWidth][4];
    for (std::uint32_t lane = 0; lane < kBlockWidth; ++lane) {
      const std::uint32_t code = block.triangles()[lane < block.count ? lane : 0];
      const std::uint32_t first = curves.spans[CurvePiece::of(code).span];
      for (std::uint32_t i = 0; i < kSpanVertices; ++i) hn::Store(at_time[first + i], D4f(), vertex[i][lane]);
    }
    std::uint32_t lanes = 0;
    for (std::uint32_t lane = 0; lane < kBlockWidth; lane += hn::Lanes(D())) {
      const auto load = [&](std::uint32_t i, V& x, V& y, V& z, V& r) {
        hn::LoadInterleaved4(D(), vertex[i][lane], x, y, z, r);
      };
      lanes |= near(load, tfar) << lane;
    }
    return lanes & ((1u << block.count) - 1u);
  }

 private:
  // Of the largest coordinate, relative to the ray's origin: what this test and the one that follows
  // (curve_test-inl.h) round, some 16 roundings together.
  static constexpr float kPad = 0x1p-19f;

  struct Extent {
    V lo, hi;
    HWY_INLINE explicit Extent(V first) : lo(first), hi(first) {}
    HWY_INLINE void grow(V v) { lo = hn::Min(lo, v), hi = hn::Max(hi, v); }
  };

  template <class Load>
  HWY_INLINE std::uint32_t near(const Load& load, float tfar) const {
    const D d;
    V x[kSpanVertices], y[kSpanVertices], radius = hn::Zero(d), size = hn::Zero(d);
    Extent distance(hn::Zero(d));
    for (std::uint32_t i = 0; i < kSpanVertices; ++i) {
      V px, py, pz, r;
      load(i, px, py, pz, r);
      px = hn::Sub(px, hn::Set(d, setup_.org[0]));
      py = hn::Sub(py, hn::Set(d, setup_.org[1]));
      pz = hn::Sub(pz, hn::Set(d, setup_.org[2]));
      x[i] = dot_lanes(d, shear_.x, px, py, pz);
      y[i] = dot_lanes(d, shear_.y, px, py, pz);
      const V t = dot_lanes(d, shear_.z, px, py, pz);
      if (i == 0) distance = Extent(t);
      distance.grow(t);
      radius = hn::Max(r, radius);
      size = hn::Max(size, hn::Max(hn::Abs(px), hn::Max(hn::Abs(py), hn::Abs(pz))));
    }
    const V reach = hn::MulAdd(size, hn::Set(d, kPad), hn::Mul(radius, hn::Set(d, shear_.stretch)));
    const V depth = hn::Mul(reach, hn::Set(d, shear_.distance_per_unit));
    const auto in_range = hn::And(hn::Le(hn::Sub(distance.lo, depth), hn::Set(d, tfar)),
                                  hn::Ge(hn::Add(distance.hi, depth), hn::Set(d, setup_.tnear)));
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, hn::AndNot(is_aside(x, y, reach), in_range), bits);
    return bits[0];
  }

  // Where a chord has no length, nothing is.
  HWY_INLINE static hn::Mask<D> is_aside(const V (&x)[kSpanVertices], const V (&y)[kSpanVertices], V reach) {
    const V dx = hn::Sub(x[3], x[0]), dy = hn::Sub(y[3], y[0]);
    const V most = hn::Mul(reach, hn::Sqrt(hn::MulAdd(dx, dx, hn::Mul(dy, dy))));
    const auto along = [&](int i) { return hn::MulAdd(dx, x[i], hn::Mul(dy, y[i])); };
    const auto across = [&](int i) { return hn::MulSub(dx, y[i], hn::Mul(dy, x[i])); };
    Extent a(along(0)), b(across(0));
    for (int i = 1; i < int(kSpanVertices); ++i) a.grow(along(i)), b.grow(across(i));
    const auto beside = [&](const Extent& e) { return hn::Max(e.lo, hn::Neg(e.hi)); };
    return hn::Gt(hn::Max(beside(a), beside(b)), most);
  }

  // The ray as an axis, by its shear: x and y are where a point lies from it in the plane across the
  // direction's largest axis, z the ray's parameter in that plane.
  struct Shear {
    Vec3f x, y, z;
    float stretch;            // of lengths across the ray, at most
    float distance_per_unit;  // change of the parameter per unit of length along the largest axis

    HWY_INLINE explicit Shear(const StillSetup& setup) {
      const auto [sx, sy, scale, unused] = setup.shear;
      x[setup.axes.x] = 1.0f, x[setup.axes.z] = -sx;
      y[setup.axes.y] = 1.0f, y[setup.axes.z] = -sy;
      z[setup.axes.z] = scale;
      stretch = std::sqrt(1.0f + sx * sx + sy * sy);
      distance_per_unit = std::abs(scale);
    }
  };

  const StillSetup& setup_;
  const Shear shear_;
};

}  // namespace msbvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
