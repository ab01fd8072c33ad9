// A span of a curve as a ray sees it: across and along the ray, as polynomials of its parameter.

#if defined(MSBVH_CURVE_SPAN_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MSBVH_CURVE_SPAN_INL_H
#undef MSBVH_CURVE_SPAN_INL_H
#else
#define MSBVH_CURVE_SPAN_INL_H
#endif

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <hwy/highway.h>

#include "core/geometry/curve_set.h"
#include "core/trace/round_test-inl.h"

HWY_BEFORE_NAMESPACE();
namespace msbvh::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Lanes hold parts of a piece (curve_test-inl.h).
using CurveTag = hn::CappedTag<float, 8>;
using CurveLanes = hn::Vec<CurveTag>;

// Axes of a span: two across the ray, one along it, and the radius.
enum Axis : int { kX, kY, kZ, kRadius };

// The way that a curve takes along its parameter next to a place; `there`: it has one.
struct Way {
  bool there = false;
  float along[4] = {};
};

// A place of a span, in each lane. `v` is 1 - u.
struct Parameter {
  CurveLanes u, v;
  HWY_INLINE explicit Parameter(CurveLanes at) : u(at), v(hn::Sub(hn::Set(CurveTag(), 1.0f), at)) {}
};

// A cubic, by Bernstein's polynomials: monotone in the controls, exact at both ends.
class Cubic {
 public:
  HWY_INLINE void set(hn::Vec<D4f> controls) {
    const D4f d;
    const auto slope = hn::Mul(hn::Sub(hn::ShiftRightLanes<1>(d, controls), controls), hn::Set(d, 3.0f));
    const auto change = hn::Sub(hn::ShiftRightLanes<1>(d, slope), slope);
    hn::Store(controls, d, control);
    hn::Store(slope, d, slope_);
    hn::Store(hn::Add(change, change), d, bend_);
  }
  HWY_INLINE CurveLanes at(const Parameter& p) const {
    const CurveTag d;
    const auto c = [&](int i) { return hn::Set(d, control[i]); };
    const CurveLanes uv = hn::Mul(hn::Mul(p.u, p.v), hn::Set(d, 3.0f));
    const CurveLanes ends =
        hn::MulAdd(hn::Mul(hn::Mul(p.u, p.u), p.u), c(3), hn::Mul(hn::Mul(hn::Mul(p.v, p.v), p.v), c(0)));
    return hn::MulAdd(hn::Mul(uv, p.u), c(2), hn::MulAdd(hn::Mul(uv, p.v), c(1), ends));
  }
  HWY_INLINE CurveLanes slope(const Parameter& p) const {
    const CurveTag d;
    const auto c = [&](int i) { return hn::Set(d, slope_[i]); };
    const CurveLanes uv = hn::Mul(hn::Add(p.u, p.u), p.v);
    return hn::MulAdd(uv, c(1), hn::MulAdd(hn::Mul(p.u, p.u), c(2), hn::Mul(hn::Mul(p.v, p.v), c(0))));
  }
  // Of the slope.
  HWY_INLINE CurveLanes bend(const Parameter& p) const {
    const CurveTag d;
    return hn::MulAdd(p.u, hn::Set(d, bend_[1]), hn::Mul(p.v, hn::Set(d, bend_[0])));
  }

  alignas(16) float control[kSpanVertices];
  const float* slopes() const { return slope_; }

 private:
  alignas(16) float slope_[4], bend_[4];  // 3 and 2 of them
};

class SeenSpan {
 public:
  template <Movement kMovement>
  HWY_INLINE SeenSpan(const VerticesAtTime<kMovement>& vertices, std::uint32_t first, const RayFrame& frame,
                      const float* org) {
    const D4f d;
    alignas(16) float v[kSpanVertices][4];
    for (std::uint32_t i = 0; i < kSpanVertices; ++i) hn::Store(vertices[first + i], d, v[i]);
    auto x = hn::Zero(d), y = x, z = x, r = x;
    hn::LoadInterleaved4(d, v[0], x, y, z, r);
    x = hn::Sub(x, hn::Set(d, org[0]));
    y = hn::Sub(y, hn::Set(d, org[1]));
    z = hn::Sub(z, hn::Set(d, org[2]));
    axis_[kX].set(dot_lanes(d, frame.x, x, y, z));
    axis_[kY].set(dot_lanes(d, frame.y, x, y, z));
    axis_[kZ].set(dot_lanes(d, frame.z, x, y, z));
    axis_[kRadius].set(r);
  }

  // Whether the ray meets the ball at an end.
  HWY_INLINE bool touches(bool at_end) const {
    const int i = at_end ? kSpanVertices - 1 : 0;
    const float x = axis_[kX].control[i], y = axis_[kY].control[i], r = axis_[kRadius].control[i];
    return x * x + y * y <= r * r;
  }

  const Cubic& operator[](Axis axis) const { return axis_[axis]; }

  // Into the span from its beginning, or along it to its end: from the nearest control point that is
  // elsewhere on the first `axes` axes. Not there: on those, the span has no length.
  HWY_INLINE Way way(bool at_end, int axes) const {
    const int from = at_end ? 3 : 0, step = at_end ? -1 : 1;
    for (int i = from + step; i >= 0 && i < int(kSpanVertices); i += step) {
      Way way;
      for (int k = 0; k < 4; ++k) {
        way.along[k] = static_cast<float>(step) * (axis_[k].control[i] - axis_[k].control[from]);
        way.there |= k < axes && way.along[k] != 0.0f;
      }
      if (way.there) return way;
    }
    return {};
  }
  float largest_radius() const {
    const float* r = axis_[kRadius].control;
    return std::max(std::max(r[0], r[1]), std::max(r[2], r[3]));
  }
  // Across the ray, by the hull of the slopes' own control points.
  float largest_speed() const {
    const float *x = axis_[kX].slopes(), *y = axis_[kY].slopes();
    float most = 0.0f;
    for (int i = 0; i < 3; ++i) most = std::max(most, x[i] * x[i] + y[i] * y[i]);
    return std::sqrt(most);
  }

 private:
  Cubic axis_[4];
};

// The normals of a span that have been authored for it.
class SeenNormals {
 public:
  template <Movement kMovement>
  HWY_INLINE SeenNormals(const NormalsAtTime<kMovement>& normals, std::uint32_t first,
                         const RayFrame& frame) {
    alignas(16) float c[3][kSpanVertices];
    for (std::uint32_t i = 0; i < kSpanVertices; ++i) {
      alignas(16) float n[4];
      hn::Store(normals[first + i], D4f(), n);
      const Vec3f seen = frame.seen({n[0], n[1], n[2]});
      for (int k = 0; k < 3; ++k) c[k][i] = seen[k];
    }
    for (int k = 0; k < 3; ++k) axis_[k].set(hn::Load(D4f(), c[k]));
  }
  const Cubic& operator[](Axis axis) const { return axis_[axis]; }

 private:
  Cubic axis_[3];
};

}  // namespace msbvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
