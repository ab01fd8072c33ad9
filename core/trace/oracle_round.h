// What the oracle's parts for curves and for points share.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/geometry/curve_set.h"
#include "core/geometry/round_vertex.h"
#include "core/trace/oracle.h"
#include "core/trace/pose.h"
#include "core/trace/verdict.h"

namespace msbvh {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct RoundD {
  Vec3d p;
  double radius;
};
inline RoundD lerp(const RoundD& a, const RoundD& b, double w) {
  return {msbvh::lerp(a.p, b.p, w), msbvh::lerp(a.radius, b.radius, w)};
}

// Of a vertex's controls at a time, the radius among them.
template <typename Set>
double size_at(const Set& set, std::uint32_t vertex, double u) {
  return largest_control(set.form(), u, [&](std::uint32_t control) {
    const RoundVertex& v = set.control_vertices(control)[vertex];
    return std::max(largest_coordinate(Vec3d(v.p)), double(v.radius));
  });
}
template <typename Set>
RoundD vertex_at(const Set& set, std::uint32_t vertex, double u) {
  return track_at(set.form(), u, [&](std::uint32_t control) {
    const RoundVertex& v = set.control_vertices(control)[vertex];
    return RoundD{Vec3d(v.p), double(v.radius)};
  });
}

// Of a ball of radius r, of a line that passes its centre at the distance `off`.
inline double half_chord(double r, double off) { return std::sqrt(std::max(0.0, r * r - off * off)); }

// The answers that a kernel may give for one primitive, from all the places where the ray meets it or may.
class Answers {
 public:
  explicit Answers(const RayD& ray) : ray_(ray) {}

  void add(bool clear, double t, double slack) {
    const double lo = t - slack, hi = t + slack;
    if (hi < ray_.tnear || lo > ray_.tfar) return;
    first_ = std::min(first_, lo);
    last_ = std::max(last_, hi);
    if (clear && lo > ray_.tnear && hi < ray_.tfar && hi < surely_) {
      surely_ = hi;
      t_ = t;
    }
  }
  Verdict verdict() const {
    Verdict v;
    v.possible = first_ <= last_;
    v.clear = v.hit = surely_ < kInfinity;
    v.t = v.clear ? t_ : first_;
    v.t_lo = first_;
    v.t_hi = v.clear ? surely_ : last_;
    return v;
  }

 private:
  const RayD& ray_;
  double first_ = kInfinity, last_ = -kInfinity, surely_ = first_, t_ = 0.0;
};

// The span's verdict at time u.
Verdict judge_span(const RayD& ray, const CurveSet& curves, std::uint32_t span, double u);

}  // namespace msbvh
