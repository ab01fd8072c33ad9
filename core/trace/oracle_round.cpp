// The oracle's part for curves and points: their definitions, in double precision.
//
// A ray meets a ribbon where the foot of a perpendicular, in the plane across the ray, from the ray to the
// projected centre line is no farther away than the radius there; t is the centre line's. Where a span
// carries on another, the end that they share counts as well if it is the nearest point of both thereabouts;
// what lies between that has no length is passed.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "core/motion/bezier.h"
#include "core/trace/oracle.h"
#include "core/trace/verdict.h"

namespace msbvh {
namespace {

// Parts of a span in which roots are told apart, and how near each other two may be that a kernel must find.
constexpr int kParts = 512;
constexpr double kApart = 1.0 / 16;

struct RoundD {
  Vec3d p;
  double radius;
};
RoundD lerp(const RoundD& a, const RoundD& b, double w) {
  return {msbvh::lerp(a.p, b.p, w), msbvh::lerp(a.radius, b.radius, w)};
}

template <typename Set>
RoundD vertex_at(const Set& set, std::uint32_t vertex, double u) {
  const auto at = [&](std::uint32_t control) {
    const RoundVertex& v = set.control_vertices(control)[vertex];
    return RoundD{Vec3d(v.p), double(v.radius)};
  };
  if (set.segments == 0) return at(0);
  const double scaled = u * set.segments;
  const std::uint32_t key = std::min(static_cast<std::uint32_t>(scaled), set.segments - 1);
  return bezier([&](std::uint32_t i) { return at(key * set.degree + i); }, set.degree, scaled - key);
}

double largest(const Vec3d& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

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
    v.clear = v.hit = surely_ < std::numeric_limits<double>::infinity();
    v.t = v.clear ? t_ : first_;
    v.t_lo = first_;
    v.t_hi = v.clear ? surely_ : last_;
    return v;
  }

 private:
  const RayD& ray_;
  double first_ = std::numeric_limits<double>::infinity(), last_ = -first_, surely_ = first_, t_ = 0.0;
};

Verdict judge_point(const RayD& ray, const RoundD& ball) {
  const double l = length(ray.dir), size = std::max({largest(ball.p), largest(ray.org), ball.radius});
  const double error = ray.error + kOracleError * size;
  const Vec3d d = ray.dir * (1.0 / l), to = ball.p - ray.org;
  const double along = dot(to, d), aside = length(to - d * along);
  Answers answers(ray);
  if (aside > ball.radius + error || ball.radius <= 0.0) return answers.verdict();
  const auto half = [&](double r, double off) { return std::sqrt(std::max(0.0, r * r - off * off)); };
  const double least = half(std::max(0.0, ball.radius - error), aside + error);
  const double most = half(ball.radius + error, std::max(0.0, aside - error));
  const double middle = 0.5 * (least + most), slack = (0.5 * (most - least) + error) / l;
  const bool clear = aside < ball.radius - error;
  answers.add(clear, (along - middle) / l, slack);
  answers.add(clear, (along + middle) / l, slack);
  return answers.verdict();
}

// The way of a curve, along its parameter, next to a place; none where it ends.
using Way = std::optional<Vec3d>;

// A span seen along the ray: x and y across, z along it.
class SeenSpan {
 public:
  SeenSpan(const RayD& ray, const std::array<RoundD, kSpanVertices>& v) : length_(length(ray.dir)) {
    const Vec3d z = ray.dir * (1.0 / length_);
    const Vec3d other = std::abs(z.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
    const Vec3d x = normalize(cross(other, z)), y = cross(z, x);
    x_ = x, y_ = y;
    double size = largest(ray.org);
    for (std::uint32_t i = 0; i < kSpanVertices; ++i) {
      const Vec3d to = v[i].p - ray.org;
      p_[i] = {dot(to, x), dot(to, y), dot(to, z)};
      radius_[i] = v[i].radius;
      size = std::max({size, largest(v[i].p), v[i].radius});
    }
    error_ = ray.error + kOracleError * size;
  }

  void judge(const Way& before, const Way& after, Answers& answers) const {
    if (!way(false)) return;
    std::vector<double> roots;
    for (int i = 0; i < kParts; ++i) {
      const double a = double(i) / kParts, b = double(i + 1) / kParts;
      if ((foot(a) <= 0.0) != (foot(b) <= 0.0) || foot(b) == 0.0) roots.push_back(root(a, b));
    }
    for (std::size_t i = 0; i < roots.size(); ++i) {
      const bool alone = (i == 0 || roots[i] - roots[i - 1] > kApart) &&
                         (i + 1 == roots.size() || roots[i + 1] - roots[i] > kApart);
      add(roots[i], alone && surely_foot(roots[i]), answers);
    }
    add_end(0.0, across(before), way(false), answers);
    add_end(1.0, way(true), across(after), answers);
  }

 private:
  Vec3d at(double u) const {
    return bezier([&](std::uint32_t i) { return p_[i]; }, 3, u);
  }
  Vec3d along(double u) const {
    return bezier([&](std::uint32_t i) { return (p_[i + 1] - p_[i]) * 3.0; }, 2, u);
  }
  double radius(double u) const {
    return bezier([&](std::uint32_t i) { return radius_[i]; }, 3, u);
  }
  // Half the slope of the squared distance: 0 at the foot of a perpendicular.
  double foot(double u) const {
    const Vec3d p = at(u), d = along(u);
    return p.x * d.x + p.y * d.y;
  }
  double root(double a, double b) const {
    const bool below = foot(a) <= 0.0;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (a + b);
      ((foot(middle) <= 0.0) == below ? a : b) = middle;
    }
    return 0.5 * (a + b);
  }
  // Not so near a free end that rounding puts the foot beyond it, nor where the line has no direction.
  bool surely_foot(double u) const {
    const Vec3d d = along(u);
    const double speed = std::hypot(d.x, d.y);
    return speed * std::min(u, 1.0 - u) > 4.0 * error_ && speed > 64.0 * error_;
  }

  void add(double u, bool certain, Answers& answers) const {
    const Vec3d p = at(u), d = along(u);
    const double distance = std::hypot(p.x, p.y), r = radius(u), speed = std::hypot(d.x, d.y);
    if (distance > r + slack(u) || r <= 0.0) return;
    const double steepness = speed > 0.0 ? std::abs(d.z) / speed : 0.0;
    const bool clear = certain && distance < r - slack(u);
    // How far the foot may be from where it is: more where the line is nearly as far away all along.
    const double t_slack = (error_ + 16.0 * steepness * (error_ + r * kOracleError)) / length_;
    answers.add(clear, p.z / length_, std::isfinite(t_slack) ? t_slack : 0.0);
    if (!clear) answers.add(false, p.z / length_, spread(u));
  }
  Way way(bool at_end) const {
    const std::uint32_t end = at_end ? kSpanVertices - 1 : 0;
    for (std::uint32_t i = 1; i < kSpanVertices; ++i) {
      const Vec3d d = at_end ? p_[end] - p_[end - i] : p_[i] - p_[end];
      if (d.x != 0.0 || d.y != 0.0) return Vec3d{d.x, d.y, 0.0};
    }
    return std::nullopt;
  }
  Way across(const Way& way) const { return way ? Way(Vec3d{dot(*way, x_), dot(*way, y_), 0.0}) : way; }
  // How fast the line comes nearer to the ray along a way from a place, and how uncertain that is.
  struct Nearing {
    double slope = 0.0, blur = 0.0;
  };
  Nearing nearing(const Vec3d& p, const Vec3d& way) const {
    return {-(p.x * way.x + p.y * way.y),
            8.0 * error_ * (std::hypot(way.x, way.y) + std::hypot(p.x, p.y) + error_)};
  }
  // At an end: round where the span carries on, else there may be a foot next to it.
  void add_end(double u, const Way& before, const Way& after, Answers& answers) const {
    const Vec3d p = at(u);
    if (before && after) {
      const Nearing back = nearing(p, -*before), on = nearing(p, *after);
      if (back.slope <= back.blur && on.slope <= on.blur) {
        add(u, back.slope < -back.blur && on.slope < -on.blur, answers);
        return;
      }
    }
    const Way& own = u == 0.0 ? after : before;
    if (!own) return;
    const Nearing along = nearing(p, *own);
    if (std::abs(along.slope) <= along.blur) add(u, false, answers);
  }
  // Radii change along the line, too.
  double slack(double u) const { return 2.0 * error_ + kOracleError * radius(u); }
  // Of t, where the foot is uncertain.
  double spread(double u) const {
    double lo = std::numeric_limits<double>::infinity(), hi = -lo;
    for (int i = -4; i <= 4; ++i) {
      const double z = at(std::clamp(u + i * kApart / 4, 0.0, 1.0)).z / length_;
      lo = std::min(lo, z);
      hi = std::max(hi, z);
    }
    return hi - lo + error_ / length_;
  }

  std::array<Vec3d, kSpanVertices> p_;
  std::array<double, kSpanVertices> radius_;
  Vec3d x_, y_;
  double length_, error_;
};

// The way of the curve beyond an end of a span.
Way way_beyond(const CurveSet& curves, std::uint32_t span, bool at_end, double u) {
  const Vec3d end = vertex_at(curves, curves.spans[span] + (at_end ? kSpanVertices - 1 : 0), u).p;
  for (auto next = curves.neighbour(span, at_end); next; next = curves.neighbour(*next, at_end)) {
    const std::uint32_t first = curves.spans[*next];
    for (std::uint32_t i = 1; i < kSpanVertices; ++i) {
      const Vec3d other = vertex_at(curves, at_end ? first + i : first + kSpanVertices - 1 - i, u).p;
      if (other != end) return at_end ? other - end : end - other;
    }
    if (*next == span) break;
  }
  return std::nullopt;
}

}  // namespace

void judge_round(const Bvh& bvh, const RayD& ray, double u, std::uint32_t instance,
                 const VerdictVisitor& visit) {
  if (!(length(ray.dir) > 0.0)) return;
  for (std::uint32_t s = 0; s < bvh.points.size(); ++s) {
    for (std::uint32_t i = 0; i < bvh.points[s]->point_count; ++i) {
      const Verdict verdict = judge_point(ray, vertex_at(*bvh.points[s], i, u));
      if (verdict.possible) visit({instance, {GeometryKind::kPoints, s}, i}, verdict);
    }
  }
  for (std::uint32_t s = 0; s < bvh.curves.size(); ++s) {
    const CurveSet& curves = *bvh.curves[s];
    for (std::uint32_t i = 0; i < curves.span_count(); ++i) {
      std::array<RoundD, kSpanVertices> v;
      for (std::uint32_t k = 0; k < kSpanVertices; ++k) v[k] = vertex_at(curves, curves.spans[i] + k, u);
      Answers answers(ray);
      SeenSpan(ray, v).judge(way_beyond(curves, i, false, u), way_beyond(curves, i, true, u), answers);
      const Verdict verdict = answers.verdict();
      if (verdict.possible) visit({instance, {GeometryKind::kCurves, s}, i}, verdict);
    }
  }
}

}  // namespace msbvh
