// A ray against a piece of a curve that is a flat ribbon turned to the ray.
//
// The ray meets it where the foot of a perpendicular, in the plane across the ray, from the ray to the
// projected centre line is no farther away than the radius there; t is the centre line's. Feet are roots of
// the slope of the squared distance, of degree 5: the piece is cut to 8 parts, one a lane, and in those where
// the slope changes its sign Newton's method, kept inside by bisection, finds the root. Where a span carries
// on another, the end that they share counts as well if it is the nearest point of both thereabouts: joints
// are round on their outside and have no gaps. Free ends are cut straight. What has no length is not there:
// chains carry on across it.
//
// The parts are exact fractions of the span, and at their ends all pieces compute the same bits: what lies on
// a boundary is found on one side of it. Where the slope has the same sign at both ends of a part and turns
// between them, there may be two feet: the part is cut where it turns. Of three in one part one is found.

#if defined(MSBVH_CURVE_TEST_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MSBVH_CURVE_TEST_INL_H
#undef MSBVH_CURVE_TEST_INL_H
#else
#define MSBVH_CURVE_TEST_INL_H
#endif

#include <bit>
#include <cmath>
#include <cstdint>
#include <hwy/highway.h>

#include "core/geometry/curve_piece.h"
#include "core/trace/round_test-inl.h"

HWY_BEFORE_NAMESPACE();
namespace msbvh::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

struct CurveHit {
  float t, u, v;
};

// The way that a curve takes along its parameter next to a place, across the ray; `there`: it has one.
struct Way {
  bool there = false;
  float x = 0.0f, y = 0.0f;
};

// A span as the ray sees it: control points across and along the ray, and radii, as polynomials in u.
class SeenSpan {
 public:
  template <Movement kMovement>
  HWY_INLINE SeenSpan(const VerticesAtTime<kMovement>& vertices, std::uint32_t first, const RayFrame& frame,
                      const float* org) {
    float c[kSpanVertices][4];
    for (std::uint32_t i = 0; i < kSpanVertices; ++i) {
      alignas(16) float v[4];
      hn::Store(vertices[first + i], D4f(), v);
      const float x = v[0] - org[0], y = v[1] - org[1], z = v[2] - org[2];
      const auto dot3 = [&](const Vec3f& a) { return a.x * x + a.y * y + a.z * z; };
      c[i][0] = dot3(frame.x);
      c[i][1] = dot3(frame.y);
      c[i][2] = dot3(frame.z);
      c[i][3] = v[3];
    }
    for (int k = 0; k < 4; ++k) {
      for (std::uint32_t i = 0; i < kSpanVertices; ++i) control_[k][i] = c[i][k];
      for (std::uint32_t i = 0; i + 1 < kSpanVertices; ++i) slope_[k][i] = 3.0f * (c[i + 1][k] - c[i][k]);
      for (std::uint32_t i = 0; i + 2 < kSpanVertices; ++i)
        bend_[k][i] = 6.0f * (c[i + 2][k] - 2.0f * c[i + 1][k] + c[i][k]);
    }
  }

  // Into the span from its beginning, or along it to its end: from the nearest control point that is seen
  // elsewhere. Not there: the span has no length, or runs along the ray.
  HWY_INLINE Way way(bool at_end) const {
    const int from = at_end ? 3 : 0, step = at_end ? -1 : 1;
    for (int i = from + step; i >= 0 && i < int(kSpanVertices); i += step) {
      const float x = control_[0][i] - control_[0][from], y = control_[1][i] - control_[1][from];
      if (x != 0.0f || y != 0.0f) return {true, static_cast<float>(step) * x, static_cast<float>(step) * y};
    }
    return {};
  }
  float largest_radius() const {
    return std::max(std::max(control_[3][0], control_[3][1]), std::max(control_[3][2], control_[3][3]));
  }
  // Across the ray, by the hull of the slopes' own control points.
  float largest_speed() const {
    float most = 0.0f;
    for (int i = 0; i < 3; ++i)
      most = std::max(most, slope_[0][i] * slope_[0][i] + slope_[1][i] * slope_[1][i]);
    return std::sqrt(most);
  }

  // Axes 0 to 2, and the radius. By Bernstein's polynomials: monotone in the controls, exact at both ends.
  template <class D>
  HWY_INLINE hn::Vec<D> at(D d, int k, hn::Vec<D> u, hn::Vec<D> v) const {
    const auto c = [&](int i) { return hn::Set(d, control_[k][i]); };
    const auto three = hn::Set(d, 3.0f), uv = hn::Mul(hn::Mul(u, v), three);
    const auto ends = hn::MulAdd(hn::Mul(hn::Mul(u, u), u), c(3), hn::Mul(hn::Mul(hn::Mul(v, v), v), c(0)));
    return hn::MulAdd(hn::Mul(uv, u), c(2), hn::MulAdd(hn::Mul(uv, v), c(1), ends));
  }
  template <class D>
  HWY_INLINE hn::Vec<D> slope(D d, int k, hn::Vec<D> u, hn::Vec<D> v) const {
    const auto c = [&](int i) { return hn::Set(d, slope_[k][i]); };
    const auto uv = hn::Mul(hn::Add(u, u), v);
    return hn::MulAdd(uv, c(1), hn::MulAdd(hn::Mul(u, u), c(2), hn::Mul(hn::Mul(v, v), c(0))));
  }
  template <class D>
  HWY_INLINE hn::Vec<D> bend(D d, int k, hn::Vec<D> u, hn::Vec<D> v) const {
    return hn::MulAdd(u, hn::Set(d, bend_[k][1]), hn::Mul(v, hn::Set(d, bend_[k][0])));
  }

 private:
  float control_[4][4], slope_[4][3], bend_[4][2];
};

class CurveTest {
 public:
  HWY_INLINE CurveTest(const SeenSpan& span, float inverse_length, float tnear)
      : span_(span), inverse_length_(inverse_length), tnear_(tnear) {}

  // The nearest hit of the piece up to `hit.t`, which it replaces. Any will do: the first that is found.
  // `before` and `after`: the ways of the spans that it carries on and that carry it on.
  HWY_INLINE bool run(const CurvePiece& piece, const Way& before, const Way& after, CurveHit& hit) const {
    const Way begins = span_.way(false);
    if (!begins.there) return false;
    bool found = feet(piece, hit);
    if (before.there && piece.part == 0) found |= joint(0.0f, before, begins, hit);
    if (after.there && piece.part + 1 == piece.parts) found |= joint(1.0f, span_.way(true), after, hit);
    return found;
  }

 private:
  using D = hn::CappedTag<float, 8>;
  using V = hn::Vec<D>;
  static constexpr int kParts = 8, kSteps = 24;
  // Of a part, next to a span's ends.
  static constexpr float kAside = 0x1p-12f;
  // Of a span: a step of Newton's method that is as short as this is the last.
  static constexpr float kConverged = 0x1p-21f;

  // Half the slope of the squared distance from the ray.
  template <class Tag>
  HWY_INLINE hn::Vec<Tag> foot(Tag d, hn::Vec<Tag> u) const {
    const auto v = hn::Sub(hn::Set(d, 1.0f), u);
    return hn::MulAdd(span_.at(d, 0, u, v), span_.slope(d, 0, u, v),
                      hn::Mul(span_.at(d, 1, u, v), span_.slope(d, 1, u, v)));
  }
  HWY_INLINE V distance2(V u) const {
    const D d;
    const V v = hn::Sub(hn::Set(d, 1.0f), u), x = span_.at(d, 0, u, v), y = span_.at(d, 1, u, v);
    return hn::MulAdd(x, x, hn::Mul(y, y));
  }
  HWY_INLINE V foot_slope(V u) const {
    const D d;
    const V v = hn::Sub(hn::Set(d, 1.0f), u);
    V sum = hn::Zero(d);
    for (int k = 0; k < 2; ++k) {
      const V s = span_.slope(d, k, u, v);
      sum = hn::MulAdd(s, s, hn::MulAdd(span_.at(d, k, u, v), span_.bend(d, k, u, v), sum));
    }
    return sum;
  }

  HWY_INLINE bool feet(const CurvePiece& piece, CurveHit& hit) const {
    const D d;
    bool found = false;
    const float begin = piece.begin(), step = 1.0f / static_cast<float>(kParts * piece.parts);
    // No point of a part is farther from the nearer one of its ends than half of its length.
    const float reach = 1.001f * (span_.largest_radius() + 0.5f * step * span_.largest_speed());
    const V most2 = hn::Set(d, reach * reach);
    for (int lane = 0; lane < kParts; lane += static_cast<int>(hn::Lanes(d))) {
      const V number = hn::Add(hn::Iota(d, 0.0f), hn::Set(d, static_cast<float>(lane)));
      V lo = hn::MulAdd(number, hn::Set(d, step), hn::Set(d, begin)), hi = hn::Add(lo, hn::Set(d, step));
      const auto near = hn::Le(hn::Min(distance2(lo), distance2(hi)), most2);
      if (hn::AllFalse(d, near)) continue;
      V at_lo = foot(d, lo), at_hi = foot(d, hi);
      const V zero = hn::Zero(d);
      // Where control points coincide, the slope is 0 at the span's end whatever is near: that is no foot,
      // and would hide one in the same part.
      const auto stuck_lo = hn::And(hn::Eq(lo, zero), hn::Eq(at_lo, zero));
      const auto stuck_hi = hn::And(hn::Eq(hi, hn::Set(d, 1.0f)), hn::Eq(at_hi, zero));
      if (!hn::AllFalse(d, hn::Or(stuck_lo, stuck_hi))) {
        const V aside = hn::Set(d, kAside * step);
        lo = hn::IfThenElse(stuck_lo, aside, lo);
        hi = hn::IfThenElse(stuck_hi, hn::Sub(hi, aside), hi);
        at_lo = foot(d, lo), at_hi = foot(d, hi);
      }
      const auto rises = hn::And(hn::Le(at_lo, zero), hn::Ge(at_hi, zero));
      const auto falls = hn::And(hn::Ge(at_lo, zero), hn::Le(at_hi, zero));
      const auto has = hn::Or(rises, falls);
      if (!hn::AllFalse(d, hn::And(has, near)))
        found |= take(root(lo, hi, at_lo, at_hi, rises, hn::And(has, near)), hn::And(has, near), hit);
      found |= pairs(lo, hi, at_lo, at_hi, hn::AndNot(has, near), hit);
    }
    return found;
  }

  // Two feet in a part: the slope turns between them.
  template <class M>
  HWY_INLINE bool pairs(V lo, V hi, V at_lo, V at_hi, M candidates, CurveHit& hit) const {
    const D d;
    if (hn::AllFalse(d, candidates)) return false;
    const V zero = hn::Zero(d), turn_lo = foot_slope(lo), turn_hi = foot_slope(hi);
    const auto above = hn::Gt(at_lo, zero);
    const auto dips = hn::And(hn::Lt(turn_lo, zero), hn::Gt(turn_hi, zero));
    const auto peaks = hn::And(hn::Gt(turn_lo, zero), hn::Lt(turn_hi, zero));
    candidates = hn::And(candidates, hn::Or(hn::And(above, dips), hn::AndNot(above, peaks)));
    if (hn::AllFalse(d, candidates)) return false;
    const V middle = hn::MulAdd(hn::Sub(hi, lo), hn::Div(turn_lo, hn::Sub(turn_lo, turn_hi)), lo);
    const V at_middle = foot(d, middle);
    candidates = hn::And(candidates, hn::Xor(hn::Gt(at_middle, zero), above));
    if (hn::AllFalse(d, candidates)) return false;
    const bool first = take(root(lo, middle, at_lo, at_middle, hn::Not(above), candidates), candidates, hit);
    return take(root(middle, hi, at_middle, at_hi, above, candidates), candidates, hit) || first;
  }

  // In the lanes of `wanted`; it goes on until all of them have theirs.
  template <class M>
  HWY_INLINE V root(V lo, V hi, V at_lo, V at_hi, M rises, M wanted) const {
    const D d;
    const V half = hn::Set(d, 0.5f);
    const V difference = hn::Sub(at_lo, at_hi);
    V u = hn::IfThenElse(hn::Eq(difference, hn::Zero(d)), lo,
                         hn::MulAdd(hn::Sub(hi, lo), hn::Div(at_lo, difference), lo));
    for (int i = 0; i < kSteps; ++i) {
      const V f = foot(d, u);
      const auto before = hn::Xor(hn::Lt(f, hn::Zero(d)), hn::Not(rises));  // the root lies beyond
      lo = hn::IfThenElse(before, u, lo);
      hi = hn::IfThenElse(before, hi, u);
      const V next = hn::Sub(u, hn::Div(f, foot_slope(u)));
      const auto inside = hn::And(hn::Ge(next, lo), hn::Le(next, hi));
      const V better = hn::IfThenElse(inside, next, hn::Mul(hn::Add(lo, hi), half));
      const auto moves = hn::Gt(hn::Abs(hn::Sub(better, u)), hn::Set(d, kConverged));
      u = better;
      if (hn::AllFalse(d, hn::And(wanted, moves))) break;
    }
    return u;
  }

  template <class M>
  HWY_INLINE bool take(V u, M candidates, CurveHit& hit) const {
    const D d;
    const V v = hn::Sub(hn::Set(d, 1.0f), u);
    const V x = span_.at(d, 0, u, v), y = span_.at(d, 1, u, v), r = span_.at(d, 3, u, v);
    const V t = hn::Mul(span_.at(d, 2, u, v), hn::Set(d, inverse_length_));
    const V apart2 = hn::MulAdd(x, x, hn::Mul(y, y));
    const auto near = hn::And(hn::Le(apart2, hn::Mul(r, r)), hn::Gt(r, hn::Zero(d)));
    const auto in_range = hn::And(hn::Ge(t, hn::Set(d, tnear_)), hn::Le(t, hn::Set(d, hit.t)));
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, hn::And(candidates, hn::And(near, in_range)), bits);
    if (bits[0] == 0) return false;
    alignas(64) float us[8], ts[8], xs[8], ys[8], rs[8];
    hn::Store(u, d, us), hn::Store(t, d, ts), hn::Store(x, d, xs), hn::Store(y, d, ys), hn::Store(r, d, rs);
    for (std::uint32_t lanes = bits[0]; lanes != 0; lanes &= lanes - 1) {
      const int i = std::countr_zero(lanes);
      if (ts[i] <= hit.t) hit = {ts[i], us[i], across(us[i], xs[i], ys[i], rs[i])};
    }
    return true;
  }

  // The ray's place across the ribbon: -1 on its right edge, as seen along the curve, 1 on the left one.
  HWY_INLINE float across(float u, float x, float y, float r) const {
    const hn::CappedTag<float, 1> d;
    const auto uu = hn::Set(d, u), vv = hn::Set(d, 1.0f - u);
    const float sx = hn::GetLane(span_.slope(d, 0, uu, vv)), sy = hn::GetLane(span_.slope(d, 1, uu, vv));
    const float share = std::min(std::sqrt(x * x + y * y) / r, 1.0f);
    return sx * y - sy * x < 0.0f ? share : -share;
  }

  // Where two spans meet: there unless farther along one of both the line is nearer to the ray.
  HWY_INLINE bool joint(float u, const Way& before, const Way& after, CurveHit& hit) const {
    const D d;
    const V uu = hn::Set(d, u), vv = hn::Set(d, 1.0f - u);
    const float x = hn::GetLane(span_.at(d, 0, uu, vv)), y = hn::GetLane(span_.at(d, 1, uu, vv));
    if (x * before.x + y * before.y > 0.0f || x * after.x + y * after.y < 0.0f) return false;
    return take(uu, hn::FirstN(d, 1), hit);
  }

  const SeenSpan& span_;
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
      const auto along = [&](const Vec3f& axis) { return axis.x * v[0] + axis.y * v[1] + axis.z * v[2]; };
      return {true, along(frame.x), along(frame.y)};
    }
    if (*next == span) break;  // round a loop
  }
  return {};
}

// The nearest of the block's pieces that the ray meets within [tnear, tfar]: `visit(code, hit)` for each that
// is nearer than, or as near as, those before it. False: none.
template <Movement kMovement, typename Visit>
HWY_INLINE bool test_curves(const Bvh& bvh, const BlockHeader& block, const RaySetup<kMovement>& setup,
                            float tfar, const Visit& visit) {
  const CurveSet& curves = *bvh.curves[block.owner];
  const VerticesAtTime<kMovement> vertices(curves.vertices.data(), curves.vertex_count, block.form_code,
                                           setup);
  const RayFrame frame(direction_of(setup));
  bool found = false;
  for (std::uint32_t i = 0; i < block.count; ++i) {
    const CurvePiece piece = CurvePiece::of(block.triangles()[i]);
    const SeenSpan span(vertices, curves.spans[piece.span], frame, setup.org);
    Way before, after;
    if (piece.part == 0) before = way_beyond(curves, vertices, piece.span, false, frame);
    if (piece.part + 1 == piece.parts) after = way_beyond(curves, vertices, piece.span, true, frame);
    CurveHit hit{tfar, 0.0f, 0.0f};
    if (!CurveTest(span, frame.inverse_length, setup.tnear).run(piece, before, after, hit)) continue;
    tfar = hit.t;
    visit(piece.span, hit);
    found = true;
  }
  return found;
}

}  // namespace msbvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
