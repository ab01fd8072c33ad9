// A ray against a piece of a curve: a ribbon turned to the ray, one across its own normals, or a tube.
//
// Each shape (curve_shapes-inl.h) says where a ray may meet it by the roots of a function of the parameter.
// The piece is cut to 8 parts, one a lane, and in those where the function changes its sign Newton's method,
// kept inside by bisection, finds the root. Where a span carries on another, the end that they share counts
// as well if neither of both is met earlier next to it: joints have no gaps. Free ends of ribbons are cut
// straight, those of tubes are round. What has no length is not there: chains carry on across it.
//
// The parts are exact fractions of the span, and at their ends all pieces compute the same bits: what lies on
// a boundary is found on one side of it. Where the function has the same sign at both ends of a part and
// turns between them, there may be two roots: the part is cut where it turns. Of three in one part one is
// found.

#if defined(MSBVH_CURVE_TEST_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MSBVH_CURVE_TEST_INL_H
#undef MSBVH_CURVE_TEST_INL_H
#else
#define MSBVH_CURVE_TEST_INL_H
#endif

#include <bit>
#include <cstdint>
#include <hwy/highway.h>
#include <type_traits>

#include "core/geometry/curve_piece.h"
#include "core/trace/curve_shapes-inl.h"
#include "core/trace/round_test-inl.h"
#include "core/trace/span_hull-inl.h"

HWY_BEFORE_NAMESPACE();
namespace msbvh::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

struct CurveHit {
  float t, u, v;
};

template <class Shape>
class CurveTest {
 public:
  HWY_INLINE CurveTest(const SeenSpan& span, const Shape& shape, float inverse_length, float tnear)
      : span_(span), shape_(shape), inverse_length_(inverse_length), tnear_(tnear) {}

  // The nearest hit of the piece up to `hit.t`, which it replaces. Any will do: the first that is found.
  // `beyond(at_end)`: the way of the span that it carries on, or that carries it on.
  template <typename Beyond>
  HWY_INLINE bool run(const CurvePiece& piece, const Beyond& beyond, CurveHit& hit) const {
    const Way begins = span_.way(false, Shape::kAxes);
    if (!begins.there) return false;
    bool found = roots(piece, hit);
    if (!Shape::kJoints) return found;
    if (piece.part == 0 && span_.touches(false)) {
      const Way before = beyond(false);
      if (before.there || Shape::kCaps) found |= end(0.0f, before, begins, hit);
    }
    if (piece.part + 1 == piece.parts && span_.touches(true)) {
      const Way after = beyond(true);
      if (after.there || Shape::kCaps) found |= end(1.0f, span_.way(true, Shape::kAxes), after, hit);
    }
    return found;
  }

 private:
  using D = CurveTag;
  using V = CurveLanes;
  using M = hn::Mask<CurveTag>;
  static constexpr int kParts = 8, kSteps = 24, kTurnSteps = 6;
  // Of a part, next to a span's ends.
  static constexpr float kAside = 0x1p-12f;
  // Of a span: a step of Newton's method that is as short as this is the last.
  static constexpr float kConverged = 0x1p-21f;

  HWY_INLINE V value(V u) const { return shape_.value(Parameter(u)); }
  HWY_INLINE V distance2(V u) const {
    const Parameter p(u);
    const V x = span_[kX].at(p), y = span_[kY].at(p);
    return hn::MulAdd(x, x, hn::Mul(y, y));
  }

  HWY_INLINE bool roots(const CurvePiece& piece, CurveHit& hit) const {
    const D d;
    bool found = false;
    const float begin = piece.begin(), step = 1.0f / static_cast<float>(kParts * piece.parts);
    // No point of a part is farther from the nearer one of its ends than half of its length.
    const float reach = 1.001f * (span_.largest_radius() + 0.5f * step * span_.largest_speed());
    const V most2 = hn::Set(d, reach * reach);
    for (int lane = 0; lane < kParts; lane += static_cast<int>(hn::Lanes(d))) {
      const V number = hn::Add(hn::Iota(d, 0.0f), hn::Set(d, static_cast<float>(lane)));
      V lo = hn::MulAdd(number, hn::Set(d, step), hn::Set(d, begin)), hi = hn::Add(lo, hn::Set(d, step));
      const M near = hn::Le(hn::Min(distance2(lo), distance2(hi)), most2);
      if (hn::AllFalse(d, near)) continue;
      V at_lo = value(lo), at_hi = value(hi);
      const V zero = hn::Zero(d);
      // Where control points coincide, the value is 0 at the span's end whatever is near: that is no root,
      // and would hide one in the same part.
      const M stuck_lo = hn::And(hn::Eq(lo, zero), hn::Eq(at_lo, zero));
      const M stuck_hi = hn::And(hn::Eq(hi, hn::Set(d, 1.0f)), hn::Eq(at_hi, zero));
      if (!hn::AllFalse(d, hn::Or(stuck_lo, stuck_hi))) {
        const V aside = hn::Set(d, kAside * step);
        lo = hn::IfThenElse(stuck_lo, aside, lo);
        hi = hn::IfThenElse(stuck_hi, hn::Sub(hi, aside), hi);
        at_lo = value(lo), at_hi = value(hi);
      }
      const M rises = hn::And(hn::Le(at_lo, zero), hn::Ge(at_hi, zero));
      const M falls = hn::And(hn::Ge(at_lo, zero), hn::Le(at_hi, zero));
      const M has = hn::And(Shape::kRisingOnly ? rises : hn::Or(rises, falls), near);
      if (!hn::AllFalse(d, has)) found |= take(root(lo, hi, at_lo, at_hi, rises, has), has, hit);
      found |= pairs(lo, hi, at_lo, at_hi, hn::AndNot(hn::Or(rises, falls), near), hit);
    }
    return found;
  }

  // Two roots in a part: the function turns between them. Where it turns is narrowed down by secants of its
  // slope until it has the other sign there; a few of them tell, or it only comes near 0.
  HWY_INLINE bool pairs(V lo, V hi, V at_lo, V at_hi, M candidates, CurveHit& hit) const {
    const D d;
    if (hn::AllFalse(d, candidates)) return false;
    const V zero = hn::Zero(d);
    const M above = hn::Gt(at_lo, zero);
    V left = lo, right = hi, turn_left = shape_.slope(Parameter(lo)),
      turn_right = shape_.slope(Parameter(hi));
    const M dips = hn::And(hn::Lt(turn_left, zero), hn::Gt(turn_right, zero));
    const M peaks = hn::And(hn::Gt(turn_left, zero), hn::Lt(turn_right, zero));
    candidates = hn::And(candidates, hn::Or(hn::And(above, dips), hn::AndNot(above, peaks)));
    V middle = lo, at_middle = at_lo;
    M crossed = hn::FirstN(d, 0);
    for (int i = 0; i < kTurnSteps && !hn::AllFalse(d, hn::AndNot(crossed, candidates)); ++i) {
      const V next =
          hn::MulAdd(hn::Sub(right, left), hn::Div(turn_left, hn::Sub(turn_left, turn_right)), left);
      middle = hn::IfThenElse(crossed, middle, next);
      at_middle = hn::IfThenElse(crossed, at_middle, value(next));
      crossed = hn::Xor(hn::Gt(at_middle, zero), above);
      const V turn = shape_.slope(Parameter(next));
      const M as_left = hn::Not(hn::Xor(hn::Lt(turn, zero), hn::Lt(turn_left, zero)));
      left = hn::IfThenElse(as_left, next, left);
      turn_left = hn::IfThenElse(as_left, turn, turn_left);
      right = hn::IfThenElse(as_left, right, next);
      turn_right = hn::IfThenElse(as_left, turn_right, turn);
    }
    candidates = hn::And(candidates, crossed);
    // The first one rises where the function begins below 0, the second one where it begins above.
    const M first = Shape::kRisingOnly ? hn::AndNot(above, candidates) : candidates;
    const M second = Shape::kRisingOnly ? hn::And(above, candidates) : candidates;
    bool found = false;
    if (!hn::AllFalse(d, first))
      found |= take(root(lo, middle, at_lo, at_middle, hn::Not(above), first), first, hit);
    if (!hn::AllFalse(d, second))
      found |= take(root(middle, hi, at_middle, at_hi, above, second), second, hit);
    return found;
  }

  // In the lanes of `wanted`; it goes on until all of them have theirs.
  HWY_INLINE V root(V lo, V hi, V at_lo, V at_hi, M rises, M wanted) const {
    const D d;
    const V half = hn::Set(d, 0.5f);
    const V difference = hn::Sub(at_lo, at_hi);
    V u = hn::IfThenElse(hn::Eq(difference, hn::Zero(d)), lo,
                         hn::MulAdd(hn::Sub(hi, lo), hn::Div(at_lo, difference), lo));
    for (int i = 0; i < kSteps; ++i) {
      const V f = value(u);
      const M before = hn::Xor(hn::Lt(f, hn::Zero(d)), hn::Not(rises));  // the root lies beyond
      lo = hn::IfThenElse(before, u, lo);
      hi = hn::IfThenElse(before, hi, u);
      const V next = hn::Sub(u, hn::Div(f, shape_.slope(Parameter(u))));
      const M inside = hn::And(hn::Ge(next, lo), hn::Le(next, hi));
      const V better = hn::IfThenElse(inside, next, hn::Mul(hn::Add(lo, hi), half));
      const M moves = hn::Gt(hn::Abs(hn::Sub(better, u)), hn::Set(d, kConverged));
      u = better;
      if (hn::AllFalse(d, hn::And(wanted, moves))) break;
    }
    return u;
  }

  HWY_INLINE bool take(V u, M candidates, CurveHit& hit) const {
    const D d;
    const Met met = shape_.meet(Parameter(u));
    const V t = hn::Mul(met.distance, hn::Set(d, inverse_length_));
    const M in_range = hn::And(hn::Ge(t, hn::Set(d, tnear_)), hn::Le(t, hn::Set(d, hit.t)));
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, hn::And(candidates, hn::And(met.there, in_range)), bits);
    if (bits[0] == 0) return false;
    alignas(64) float us[8], ts[8], vs[8];
    hn::Store(u, d, us), hn::Store(t, d, ts), hn::Store(met.across, d, vs);
    for (std::uint32_t lanes = bits[0]; lanes != 0; lanes &= lanes - 1) {
      const int i = std::countr_zero(lanes);
      if (ts[i] <= hit.t) hit = {ts[i], us[i], vs[i]};
    }
    return true;
  }

  // The end of a span, where two meet or it is free: there unless along one of both the shape is met earlier.
  HWY_INLINE bool end(float u, const Way& before, const Way& after, CurveHit& hit) const {
    const D d;
    const V uu = hn::Set(d, u);
    const Parameter p(uu);
    if (before.there && shape_.value(p, before) > 0.0f) return false;
    if (after.there && shape_.value(p, after) < 0.0f) return false;
    return take(uu, hn::FirstN(d, 1), hit);
  }

  const SeenSpan& span_;
  const Shape& shape_;
  const float inverse_length_, tnear_;
};

// The way of the curve beyond an end of a span: spans without length are passed. Not there: the end is free.
template <Movement kMovement>
HWY_INLINE Way way_beyond(const CurveSet& curves, const VerticesAtTime<kMovement>& vertices,
                          std::uint32_t span, bool at_end, const RayFrame& frame) {
  const std::uint32_t end = curves.spans[span] + (at_end ? kSpanVertices - 1 : 0);
  for (auto next = curves.neighbour(span, at_end); next; next = curves.neighbour(*next, at_end)) {
    const std::uint32_t first = curves.spans[*next];
    for (std::uint32_t i = 1; i < kSpanVertices; ++i) {
      const std::uint32_t other = at_end ? first + i : first + kSpanVertices - 1 - i;
      alignas(16) float v[4];
      hn::Store(at_end ? hn::Sub(vertices[other], vertices[end]) : hn::Sub(vertices[end], vertices[other]),
                D4f(), v);
      if (v[0] == 0.0f && v[1] == 0.0f && v[2] == 0.0f) continue;
      const Vec3f seen = frame.seen({v[0], v[1], v[2]});
      return {true, {seen.x, seen.y, seen.z, v[3]}};
    }
    if (*next == span) break;  // round a loop
  }
  return {};
}

// The nearest of some of a block's pieces that the ray meets within [tnear, tfar]: `visit(code, hit)` for
// each that is nearer than, or as near as, those before it. False: none.
template <Movement kMovement, typename Visit>
class CurveBlockTest {
 public:
  HWY_INLINE CurveBlockTest(const CurveSet& curves, const BlockHeader& block,
                            const RaySetup<kMovement>& setup, const VerticesAtTime<kMovement>& vertices,
                            const Visit& visit)
      : curves_(curves),
        block_(block),
        setup_(setup),
        vertices_(vertices),
        frame_(direction_of(setup)),
        visit_(visit) {}

  // `pieces`: a bit for each that is to be tested.
  HWY_INLINE bool run(std::uint32_t pieces, float tfar) const {
    switch (curves_.shape) {
      case CurveShape::kRibbon:
        return test<RibbonShape>(pieces, tfar);
      case CurveShape::kTube:
        return test<TubeShape>(pieces, tfar);
      case CurveShape::kOriented:
        break;
    }
    return test<OrientedShape>(pieces, tfar);
  }

 private:
  template <class Shape>
  HWY_INLINE bool test(std::uint32_t pieces, float tfar) const {
    bool found = false;
    for (; pieces != 0; pieces &= pieces - 1) {
      const CurvePiece piece = CurvePiece::of(block_.triangles()[std::countr_zero(pieces)]);
      const SeenSpan span(vertices_, curves_.spans[piece.span], frame_, setup_.org);
      CurveHit hit{tfar, 0.0f, 0.0f};
      if (!met<Shape>(span, piece, hit)) continue;
      tfar = hit.t;
      visit_(piece.span, hit);
      found = true;
    }
    return found;
  }

  template <class Shape>
  HWY_INLINE bool met(const SeenSpan& span, const CurvePiece& piece, CurveHit& hit) const {
    const auto beyond = [&](bool at_end) {
      return way_beyond(curves_, vertices_, piece.span, at_end, frame_);
    };
    const auto run = [&](const Shape& shape) {
      return CurveTest<Shape>(span, shape, frame_.inverse_length, setup_.tnear).run(piece, beyond, hit);
    };
    if constexpr (std::is_same_v<Shape, OrientedShape>) {
      const NormalsAtTime<kMovement> at_time(curves_.normals.data(), curves_.vertex_count, block_.form_code,
                                             setup_);
      const SeenNormals normals(at_time, curves_.spans[piece.span], frame_);
      return run(OrientedShape(span, normals));
    } else {
      return run(Shape(span));
    }
  }

  const CurveSet& curves_;
  const BlockHeader& block_;
  const RaySetup<kMovement>& setup_;
  const VerticesAtTime<kMovement>& vertices_;
  const RayFrame frame_;
  const Visit& visit_;
};

template <Movement kMovement, typename Visit>
HWY_INLINE bool test_curves(const Bvh& bvh, const BlockHeader& block, const RaySetup<kMovement>& setup,
                            float tfar, const Visit& visit) {
  const CurveSet& curves = *bvh.curves[block.owner];
  const VerticesAtTime<kMovement> vertices(curves.vertices.data(), curves.vertex_count, block.form_code,
                                           setup);
  const std::uint32_t near = SpanHulls(setup).near(curves, block, vertices, tfar);
  if (near == 0) return false;
  return CurveBlockTest<kMovement, Visit>(curves, block, setup, vertices, visit).run(near, tfar);
}

}  // namespace msbvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
