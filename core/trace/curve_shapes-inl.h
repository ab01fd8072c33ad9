// What is drawn around a curve's centre line, as curve_test-inl.h asks for it: a function of the parameter
// whose roots are where a ray may meet the shape, and whether and where it does.

#if defined(MSBVH_CURVE_SHAPES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MSBVH_CURVE_SHAPES_INL_H
#undef MSBVH_CURVE_SHAPES_INL_H
#else
#define MSBVH_CURVE_SHAPES_INL_H
#endif

#include "core/trace/curve_span-inl.h"

HWY_BEFORE_NAMESPACE();
namespace msbvh::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Where a ray meets a shape at a place of the curve: distances along the ray, and places across the curve,
// from -1 on its right edge to 1 on the left one.
struct Met {
  hn::Mask<CurveTag> there;
  CurveLanes distance, across;
};

namespace curve_shape {

HWY_INLINE CurveLanes sum_of_products(CurveLanes a, CurveLanes b, CurveLanes c, CurveLanes d) {
  return hn::MulAdd(a, b, hn::Mul(c, d));
}
// Of the place across the ray that lies at (x, y) from it, as a share of the radius.
HWY_INLINE CurveLanes across_of(const SeenSpan& span, const Parameter& p, CurveLanes x, CurveLanes y,
                                CurveLanes r) {
  const CurveTag d;
  const CurveLanes share = hn::Min(hn::Div(hn::Sqrt(sum_of_products(x, x, y, y)), r), hn::Set(d, 1.0f));
  const CurveLanes turn = hn::Sub(hn::Mul(span[kX].slope(p), y), hn::Mul(span[kY].slope(p), x));
  return hn::IfThenElse(hn::Lt(turn, hn::Zero(d)), share, hn::Neg(share));
}

}  // namespace curve_shape

// A flat ribbon turned to the ray: met at the feet of perpendiculars, in the plane across the ray, from the
// ray to the projected centre line, where they are no longer than the radius; at the centre line's distance.
class RibbonShape {
 public:
  static constexpr bool kRisingOnly = false, kJoints = true, kCaps = false;
  static constexpr int kAxes = 2;  // on which what is drawn has a length

  HWY_INLINE explicit RibbonShape(const SeenSpan& span) : span_(span) {}

  // Half the slope of the squared distance from the ray.
  HWY_INLINE CurveLanes value(const Parameter& p) const {
    return curve_shape::sum_of_products(span_[kX].at(p), span_[kX].slope(p), span_[kY].at(p),
                                        span_[kY].slope(p));
  }
  HWY_INLINE CurveLanes slope(const Parameter& p) const {
    CurveLanes sum = hn::Zero(CurveTag());
    for (const Axis k : {kX, kY}) {
      const CurveLanes s = span_[k].slope(p);
      sum = hn::MulAdd(s, s, hn::MulAdd(span_[k].at(p), span_[k].bend(p), sum));
    }
    return sum;
  }
  // The same along a way from a place.
  HWY_INLINE float value(const Parameter& p, const Way& way) const {
    return hn::GetLane(span_[kX].at(p)) * way.along[kX] + hn::GetLane(span_[kY].at(p)) * way.along[kY];
  }
  HWY_INLINE Met meet(const Parameter& p) const {
    const CurveTag d;
    const CurveLanes x = span_[kX].at(p), y = span_[kY].at(p), r = span_[kRadius].at(p);
    const CurveLanes apart2 = curve_shape::sum_of_products(x, x, y, y);
    const auto there = hn::And(hn::Le(apart2, hn::Mul(r, r)), hn::Gt(r, hn::Zero(d)));
    return {there, span_[kZ].at(p), curve_shape::across_of(span_, p, x, y, r)};
  }

 private:
  const SeenSpan& span_;
};

// The union of the balls around the centre line, met where the ray enters it. The ball at u is entered at
// z - s, s^2 = r^2 - x^2 - y^2; the first of those near each other has the slope 0: z's is s's. Where the ray
// misses the ball, the sign of -s^2's slope leads to one that it meets, if there is one.
class TubeShape {
 public:
  static constexpr bool kRisingOnly = true, kJoints = true, kCaps = true;
  static constexpr int kAxes = 3;

  HWY_INLINE explicit TubeShape(const SeenSpan& span) : span_(span) {}

  // s times the slope of where the ball is entered.
  HWY_INLINE CurveLanes value(const Parameter& p) const {
    return hn::MulSub(span_[kZ].slope(p), depth(p), half_slope(p));
  }
  HWY_INLINE CurveLanes slope(const Parameter& p) const {
    const CurveTag d;
    const CurveLanes s = depth(p), half = half_slope(p);
    CurveLanes sum = hn::Zero(d);
    for (const Axis k : {kX, kY}) {
      const CurveLanes slope = span_[k].slope(p);
      sum = hn::MulAdd(slope, slope, hn::MulAdd(span_[k].at(p), span_[k].bend(p), sum));
    }
    const CurveLanes grows = span_[kRadius].slope(p);
    sum = hn::NegMulAdd(grows, grows, hn::NegMulAdd(span_[kRadius].at(p), span_[kRadius].bend(p), sum));
    const CurveLanes inside = hn::MulAdd(span_[kZ].bend(p), s, hn::Div(hn::Mul(span_[kZ].slope(p), half), s));
    return hn::Add(sum, hn::IfThenElseZero(hn::Gt(s, hn::Zero(d)), inside));
  }
  HWY_INLINE float value(const Parameter& p, const Way& way) const {
    const auto at = [&](Axis k) { return hn::GetLane(span_[k].at(p)); };
    return way.along[kZ] * hn::GetLane(depth(p)) + at(kX) * way.along[kX] + at(kY) * way.along[kY] -
           at(kRadius) * way.along[kRadius];
  }
  HWY_INLINE Met meet(const Parameter& p) const {
    const CurveTag d;
    const CurveLanes x = span_[kX].at(p), y = span_[kY].at(p), r = span_[kRadius].at(p);
    const CurveLanes apart2 = curve_shape::sum_of_products(x, x, y, y);
    const auto there = hn::And(hn::Le(apart2, hn::Mul(r, r)), hn::Gt(r, hn::Zero(d)));
    return {there, hn::Sub(span_[kZ].at(p), depth(p)), curve_shape::across_of(span_, p, x, y, r)};
  }

 private:
  // s, or 0 where the ray misses the ball. By factors: r^2 and the square of the distance may be alike.
  HWY_INLINE CurveLanes depth(const Parameter& p) const {
    const CurveLanes x = span_[kX].at(p), y = span_[kY].at(p), r = span_[kRadius].at(p);
    const CurveLanes apart = hn::Sqrt(curve_shape::sum_of_products(x, x, y, y));
    return hn::Sqrt(hn::Max(hn::Mul(hn::Sub(r, apart), hn::Add(r, apart)), hn::Zero(CurveTag())));
  }
  // Of s^2.
  HWY_INLINE CurveLanes half_slope(const Parameter& p) const {
    const CurveLanes aside = curve_shape::sum_of_products(span_[kX].at(p), span_[kX].slope(p),
                                                          span_[kY].at(p), span_[kY].slope(p));
    return hn::MulSub(span_[kRadius].at(p), span_[kRadius].slope(p), aside);
  }

  const SeenSpan& span_;
};

// A flat ribbon across authored normals: the lines from the centre line along b = tangent x normal, as long
// to both sides as the radius. A ray meets such a line where the centre line lies, across the ray, along b.
class OrientedShape {
 public:
  static constexpr bool kRisingOnly = false, kJoints = false, kCaps = false;
  static constexpr int kAxes = 3;

  HWY_INLINE OrientedShape(const SeenSpan& span, const SeenNormals& normals)
      : span_(span), normals_(normals) {}

  // How far the line passes by the ray, times the length of b.
  HWY_INLINE CurveLanes value(const Parameter& p) const {
    return hn::MulSub(span_[kX].at(p), along(kY, p), hn::Mul(span_[kY].at(p), along(kX, p)));
  }
  HWY_INLINE CurveLanes slope(const Parameter& p) const {
    const CurveLanes by_x =
        hn::MulAdd(span_[kX].slope(p), along(kY, p), hn::Mul(span_[kX].at(p), along_slope(kY, p)));
    const CurveLanes by_y =
        hn::MulAdd(span_[kY].slope(p), along(kX, p), hn::Mul(span_[kY].at(p), along_slope(kX, p)));
    return hn::Sub(by_x, by_y);
  }
  HWY_INLINE float value(const Parameter&, const Way&) const { return 0.0f; }  // no joints
  HWY_INLINE Met meet(const Parameter& p) const {
    const CurveTag d;
    const CurveLanes x = span_[kX].at(p), y = span_[kY].at(p), r = span_[kRadius].at(p);
    const CurveLanes bx = along(kX, p), by = along(kY, p), bz = along(kZ, p);
    const CurveLanes aside2 = curve_shape::sum_of_products(bx, bx, by, by);
    const CurveLanes length = hn::Sqrt(hn::MulAdd(bz, bz, aside2));
    // In units of b: NaN where b has no length, or runs along the ray.
    const CurveLanes w = hn::Div(hn::Neg(curve_shape::sum_of_products(x, bx, y, by)), aside2);
    const auto there = hn::And(hn::Le(hn::Mul(hn::Abs(w), length), r), hn::Gt(r, hn::Zero(d)));
    return {there, hn::MulAdd(w, bz, span_[kZ].at(p)), hn::Neg(hn::Div(hn::Mul(w, length), r))};
  }

 private:
  // b on an axis, and its slope.
  HWY_INLINE CurveLanes along(Axis axis, const Parameter& p) const {
    const auto [i, j] = others(axis);
    return hn::MulSub(span_[i].slope(p), normals_[j].at(p), hn::Mul(span_[j].slope(p), normals_[i].at(p)));
  }
  HWY_INLINE CurveLanes along_slope(Axis axis, const Parameter& p) const {
    const auto [i, j] = others(axis);
    const CurveLanes turns =
        hn::MulSub(span_[i].bend(p), normals_[j].at(p), hn::Mul(span_[j].bend(p), normals_[i].at(p)));
    return hn::Add(turns, hn::MulSub(span_[i].slope(p), normals_[j].slope(p),
                                     hn::Mul(span_[j].slope(p), normals_[i].slope(p))));
  }
  struct Two {
    Axis first, second;
  };
  static constexpr Two others(Axis axis) {
    return axis == kX ? Two{kY, kZ} : axis == kY ? Two{kZ, kX} : Two{kX, kY};
  }

  const SeenSpan& span_;
  const SeenNormals& normals_;
};

}  // namespace msbvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
