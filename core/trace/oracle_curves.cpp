// The oracle's part for curves: their definition, in double precision, by brute force.
//
// A ray meets a ribbon where the foot of a perpendicular, in the plane across the ray, from the ray to the
// projected centre line is no farther away than the radius there; t is the centre line's. It meets a tube,
// the union of the balls around the centre line, where it enters it. It meets a ribbon across normals where
// it meets a line through the centre line along tangent x normal, no farther from it than the radius. Where a
// span of the first two carries on another, the end that they share counts as well if neither of both is met
// earlier next to it; what lies between that has no length is passed.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <type_traits>
#include <vector>

#include "core/motion/bezier.h"
#include "core/trace/oracle_round.h"

namespace msbvh {
namespace {

// The oracle looks for one root in each of so many parts of a span.
constexpr int kParts = 512;
// The kernel cuts a span into eighths. Where an eighth holds three roots, the kernel finds one of them; where
// it holds two that are less than half an eighth apart, it may find none.
constexpr double kKernelPart = 1.0 / 8;

// The way of a curve along its parameter next to a place, and how its radius changes; none where it ends.
using Way = std::optional<RoundD>;

// A span seen along the ray: x and y across, z along it.
class SeenSpan {
 public:
  SeenSpan(const RayD& ray, const CurveSet& curves, std::uint32_t span, double u) : length_(length(ray.dir)) {
    const Vec3d z = ray.dir * (1.0 / length_);
    const Vec3d other = std::abs(z.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
    const Vec3d x = normalize(cross(other, z));
    axes_ = {x, cross(z, x), z};
    double size = largest_coordinate(ray.org);
    for (std::uint32_t i = 0; i < kSpanVertices; ++i) {
      const std::uint32_t vertex = curves.spans[span] + i;
      const RoundD v = vertex_at(curves, vertex, u);
      p_[i] = {seen(v.p - ray.org), v.radius};
      if (curves.shape == CurveShape::kOriented) normal_[i] = seen(normal_at(curves, vertex, u));
      size = std::max(size, size_at(curves, vertex, u));
    }
    error_ = ray.error + kOracleError * size;
  }

  Vec3d at(double u) const {
    return bezier([&](std::uint32_t i) { return p_[i].p; }, 3, u);
  }
  Vec3d along(double u) const {
    return bezier([&](std::uint32_t i) { return (p_[i + 1].p - p_[i].p) * 3.0; }, 2, u);
  }
  double radius(double u) const {
    return bezier([&](std::uint32_t i) { return p_[i].radius; }, 3, u);
  }
  double growth(double u) const {
    return bezier([&](std::uint32_t i) { return (p_[i + 1].radius - p_[i].radius) * 3.0; }, 2, u);
  }
  Vec3d normal(double u) const {
    return bezier([&](std::uint32_t i) { return normal_[i]; }, 3, u);
  }
  // Into the span from its beginning, or along it to its end; on the axes across the ray alone, or on all.
  Way way(bool at_end, bool across_alone) const {
    const std::uint32_t end = at_end ? kSpanVertices - 1 : 0;
    for (std::uint32_t i = 1; i < kSpanVertices; ++i) {
      const RoundD &from = p_[at_end ? end - i : end], &to = p_[at_end ? end : i];
      const Vec3d d = to.p - from.p;
      if (d.x != 0.0 || d.y != 0.0 || (!across_alone && d.z != 0.0))
        return RoundD{d, to.radius - from.radius};
    }
    return std::nullopt;
  }
  // Whether the hull of the control points lies on one side of the ray, well beyond the largest radius:
  // nothing of the span is near, and there is no need to look along it.
  bool is_aside() const {
    double room = 64.0 * error_;
    Vec3d lo = p_[0].p, hi = lo;
    for (const RoundD& v : p_) {
      room = std::max(room, 2.0 * v.radius + 64.0 * error_);
      lo = min(lo, v.p), hi = max(hi, v.p);
    }
    return lo.x > room || lo.y > room || hi.x < -room || hi.y < -room;
  }
  Way seen(const Way& way) const { return way ? Way(RoundD{seen(way->p), way->radius}) : way; }
  double error() const { return error_; }
  // Of the ray's direction.
  double ray_length() const { return length_; }

 private:
  Vec3d seen(const Vec3d& v) const { return {dot(v, axes_[0]), dot(v, axes_[1]), dot(v, axes_[2])}; }
  static Vec3d normal_at(const CurveSet& curves, std::uint32_t vertex, double u) {
    return track_at(curves.form(), u,
                    [&](std::uint32_t c) { return Vec3d(curves.control_normals(c)[vertex]); });
  }

  std::array<RoundD, kSpanVertices> p_;
  std::array<Vec3d, kSpanVertices> normal_;
  std::array<Vec3d, 3> axes_;
  double length_, error_;
};

// Where a ray meets a shape at a place of the curve, or may.
struct Met {
  bool possible = false, clear = false;
  double distance = 0.0, slack = 0.0;  // along the ray
};

// What is uncertain of how a shape's function changes along a way.
struct Change {
  double value = -kInfinity, blur = 0.0;
};

struct Ribbon {
  static constexpr double kApart = kKernelPart / 2;
  static constexpr bool kRisingOnly = false, kJoints = true, kCaps = false, kAcross = true;

  static double value(const SeenSpan& s, double u) {
    const Vec3d p = s.at(u), d = s.along(u);
    return p.x * d.x + p.y * d.y;
  }
  static Change change(const SeenSpan& s, double u, const RoundD& way) {
    const Vec3d p = s.at(u);
    return {p.x * way.p.x + p.y * way.p.y,
            8.0 * s.error() * (std::hypot(way.p.x, way.p.y) + std::hypot(p.x, p.y) + s.error())};
  }
  static Met meet(const SeenSpan& s, double u) {
    const Vec3d p = s.at(u), d = s.along(u);
    const double distance = std::hypot(p.x, p.y), r = s.radius(u), speed = std::hypot(d.x, d.y);
    const double slack = 2.0 * s.error() + kOracleError * r;
    if (distance > r + slack || r <= 0.0) return {};
    const double steepness = speed > 0.0 ? std::abs(d.z) / speed : 0.0;
    // How far the foot may be from where it is: more where the line is nearly as far away all along.
    const double t_slack = s.error() + 16.0 * steepness * (s.error() + r * kOracleError);
    return {true, distance < r - slack && speed > 64.0 * s.error(), p.z,
            std::isfinite(t_slack) ? t_slack : 0.0};
  }
  // How much of the parameter's way is seen, for what is near an end.
  static double speed(const SeenSpan& s, double u) {
    const Vec3d d = s.along(u);
    return std::hypot(d.x, d.y);
  }
};

struct Tube {
  static constexpr double kApart = kKernelPart / 2;
  static constexpr bool kRisingOnly = true, kJoints = true, kCaps = true, kAcross = false;

  static double value(const SeenSpan& s, double u) {
    const Vec3d p = s.at(u), d = s.along(u);
    const double r = s.radius(u);
    return d.z * half_chord(r, std::hypot(p.x, p.y)) + p.x * d.x + p.y * d.y - r * s.growth(u);
  }
  static Change change(const SeenSpan& s, double u, const RoundD& way) {
    const Vec3d p = s.at(u);
    const double r = s.radius(u), off = std::hypot(p.x, p.y);
    const double size = length(way.p) + std::abs(way.radius) + off + r + s.error();
    return {way.p.z * half_chord(r, off) + p.x * way.p.x + p.y * way.p.y - r * way.radius,
            16.0 * s.error() * size + std::abs(way.p.z) * (most(s, r, off) - least(s, r, off))};
  }
  static Met meet(const SeenSpan& s, double u) {
    const Vec3d p = s.at(u);
    const double off = std::hypot(p.x, p.y), r = s.radius(u), error = blur(s);
    if (off > r + error || r <= 0.0) return {};
    const double lo = least(s, r, off), hi = most(s, r, off);
    return {true, off < r - 16.0 * error, p.z - 0.5 * (lo + hi), 0.5 * (hi - lo) + error};
  }
  static double speed(const SeenSpan& s, double u) { return length(s.along(u)); }

 private:
  static double blur(const SeenSpan& s) { return 4.0 * s.error(); }
  static double least(const SeenSpan& s, double r, double off) {
    return half_chord(std::max(0.0, r - blur(s)), off + blur(s));
  }
  static double most(const SeenSpan& s, double r, double off) {
    return half_chord(r + blur(s), std::max(0.0, off - blur(s)));
  }
};

struct Oriented {
  // Between two roots its function may turn more than once, which a kernel does not expect.
  static constexpr double kApart = kKernelPart;
  static constexpr bool kRisingOnly = false, kJoints = false, kCaps = false, kAcross = false;

  static double value(const SeenSpan& s, double u) {
    const Vec3d p = s.at(u), b = cross(s.along(u), s.normal(u));
    return p.x * b.y - p.y * b.x;
  }
  static Change change(const SeenSpan& s, double u, const RoundD&) {
    const Vec3d p = s.at(u);
    const double speed = length(s.along(u));
    return {value(s, u), 32.0 * s.error() * (speed + std::hypot(p.x, p.y)) * length(s.normal(u))};
  }
  static Met meet(const SeenSpan& s, double u) {
    const Vec3d p = s.at(u), b = side(s, u);
    const double r = s.radius(u), aside2 = b.x * b.x + b.y * b.y;
    const double w = -(p.x * b.x + p.y * b.y) / aside2;
    // By the tangent, whose digits the side has, and the angle between ray and surface.
    const double blur = 64.0 * s.error() * (1.0 + 3.0 * r / length(s.along(u))) / cosine(s, u, w);
    if (!(blur < kInfinity) || std::abs(w) > r + blur || r <= 0.0) return {};
    return {true, std::abs(w) < r - blur, p.z + w * b.z, blur};
  }
  static double speed(const SeenSpan& s, double u) {
    const Vec3d p = s.at(u), b = side(s, u);
    const double w = -(p.x * b.x + p.y * b.y) / (b.x * b.x + b.y * b.y);
    return length(s.along(u)) * cosine(s, u, w) / 16.0;
  }

 private:
  static Vec3d side(const SeenSpan& s, double u) { return normalize(cross(s.along(u), s.normal(u))); }
  // Between the ray and the surface's normal, w from the centre line.
  static double cosine(const SeenSpan& s, double u, double w) {
    constexpr double kStep = 1e-6;
    const auto at = [&](double v) { return s.at(v) + side(s, v) * w; };
    const Vec3d n = cross(at(u + kStep) - at(u - kStep), side(s, u));
    return std::abs(n.z) / length(n);
  }
};

// Whether root i is one of three that may lie in one part of a kernel's. Ascending.
bool is_crowded(const std::vector<double>& roots, std::size_t i) {
  for (std::size_t first = i < 2 ? 0 : i - 2; first <= i && first + 2 < roots.size(); ++first) {
    if (roots[first + 2] - roots[first] <= kKernelPart) return true;
  }
  return false;
}

// A span against a ray, by the shape's function.
template <class Shape>
class Judge {
 public:
  Judge(const SeenSpan& span, Answers& answers) : span_(span), answers_(answers) {}

  void run(const Way& before, const Way& after) const {
    const Way begins = span_.way(false, Shape::kAcross), ends = span_.way(true, Shape::kAcross);
    if (!begins) return;
    std::vector<double> roots;
    std::vector<bool> wanted;
    for (int i = 0; i < kParts; ++i) {
      const double a = double(i) / kParts, b = double(i + 1) / kParts;
      const bool below = value(a) <= 0.0;
      if (below == (value(b) <= 0.0) && value(b) != 0.0) continue;
      roots.push_back(root(a, b));
      wanted.push_back(below || !Shape::kRisingOnly);
    }
    for (std::size_t i = 0; i < roots.size(); ++i) {
      const double u = roots[i];
      const bool alone = (i == 0 || u - roots[i - 1] > Shape::kApart) &&
                         (i + 1 == roots.size() || roots[i + 1] - u > Shape::kApart);
      // Not so near an end that rounding puts it beyond.
      const bool inside = Shape::speed(span_, u) * std::min(u, 1.0 - u) > 4.0 * span_.error();
      if (wanted[i]) add(u, alone && !is_crowded(roots, i) && inside);
    }
    end(0.0, before, begins);
    end(1.0, ends, after);
  }

 private:
  double value(double u) const { return Shape::value(span_, u); }
  double root(double a, double b) const {
    const bool below = value(a) <= 0.0;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (a + b);
      ((value(middle) <= 0.0) == below ? a : b) = middle;
    }
    return 0.5 * (a + b);
  }
  void add(double u, bool certain) const {
    const Met met = Shape::meet(span_, u);
    if (!met.possible) return;
    const bool clear = certain && met.clear;
    const double to_t = 1.0 / span_.ray_length();
    answers_.add(clear, met.distance * to_t, met.slack * to_t);
    if (!clear) answers_.add(false, met.distance * to_t, (met.slack + spread(u)) * to_t);
  }
  // The shape is there unless it is met earlier along one of both ways. Elsewhere there may be a root next to
  // the end.
  void end(double u, const Way& before, const Way& after) const {
    const bool joint = Shape::kJoints && (Shape::kCaps || (before && after));
    Change back, on;
    if (before) back = Shape::change(span_, u, *before);
    if (after) on = Shape::change(span_, u, *after), on.value = -on.value;
    if (joint && back.value <= back.blur && on.value <= on.blur)
      return add(u, back.value < -back.blur && on.value < -on.blur);
    const Change& own = u == 0.0 ? on : back;
    if (std::abs(own.value) <= own.blur) add(u, false);
  }
  // Of the distance, where the root is uncertain.
  double spread(double u) const {
    double lo = kInfinity, hi = -lo, r = 0.0;
    for (int i = -4; i <= 4; ++i) {
      const double at = std::clamp(u + i * kKernelPart / 8, 0.0, 1.0), z = span_.at(at).z;
      lo = std::min(lo, z);
      hi = std::max(hi, z);
      r = std::max(r, span_.radius(at));
    }
    return hi - lo + span_.error() + (std::is_same_v<Shape, Ribbon> ? 0.0 : r);
  }

  const SeenSpan& span_;
  Answers& answers_;
};

// The way of the curve beyond an end of a span.
Way way_beyond(const CurveSet& curves, std::uint32_t span, bool at_end, double u) {
  const RoundD end = vertex_at(curves, curves.spans[span] + (at_end ? kSpanVertices - 1 : 0), u);
  for (auto next = curves.neighbour(span, at_end); next; next = curves.neighbour(*next, at_end)) {
    const std::uint32_t first = curves.spans[*next];
    for (std::uint32_t i = 1; i < kSpanVertices; ++i) {
      const RoundD other = vertex_at(curves, at_end ? first + i : first + kSpanVertices - 1 - i, u);
      if (other.p == end.p) continue;
      const RoundD &from = at_end ? end : other, &to = at_end ? other : end;
      return RoundD{to.p - from.p, to.radius - from.radius};
    }
    if (*next == span) break;
  }
  return std::nullopt;
}

}  // namespace

Verdict judge_span(const RayD& ray, const CurveSet& curves, std::uint32_t span, double u) {
  const SeenSpan seen(ray, curves, span, u);
  if (seen.is_aside()) return {};
  const Way before = seen.seen(way_beyond(curves, span, false, u));
  const Way after = seen.seen(way_beyond(curves, span, true, u));
  Answers answers(ray);
  if (curves.shape == CurveShape::kRibbon) Judge<Ribbon>(seen, answers).run(before, after);
  if (curves.shape == CurveShape::kTube) Judge<Tube>(seen, answers).run(before, after);
  if (curves.shape == CurveShape::kOriented) Judge<Oriented>(seen, answers).run(before, after);
  return answers.verdict();
}

}  // namespace msbvh
