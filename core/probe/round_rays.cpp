#include "core/probe/round_rays.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/base/box.h"
#include "core/motion/bezier.h"
#include "core/probe/probe_random.h"
#include "core/trace/oracle.h"
#include "core/trace/pose.h"

namespace msbvh {
namespace {

constexpr int kTries = 16;
constexpr std::size_t kRaysOfTime = 60;
// Of the sizes that go into where the shape and the ray are: as core/probe/closed_mesh.cpp has it.
constexpr double kClearance = 4.0 * kOracleError;
constexpr double kFromMiddle = 0.5;  // of the radius: how far from the middle a ray may end
constexpr double kFromEnds = 3.0;    // radii: how near to a tube's free end
constexpr double kMostAlong = 0.7;   // the cosine of a ray and a tube: 45 degrees

// A ball that a ray may end in.
struct Place {
  Vec3d middle;
  double radius;
  double rounded_size;           // of the coordinates that it is interpolated from
  std::optional<Vec3d> along{};  // of a tube: its direction
};

// What there is to aim at, at one time.
class RoundPose {
 public:
  RoundPose(const Bvh& world, float time) : time_(time) {
    for (const auto& set : world.curves) {
      if (set->shape == CurveShape::kTube && set->span_count() > 0) tubes_.push_back(set.get());
      if (set->shape == CurveShape::kTube) grow(*set, set->vertex_count);
    }
    for (const auto& set : world.points) {
      if (set->point_count > 0) points_.push_back(set.get());
      grow(*set, set->point_count);
    }
  }
  bool empty() const { return tubes_.empty() && points_.empty(); }
  // Of what has been found.
  double diagonal() const { return length(box_.hi - box_.lo); }

  std::optional<Place> place(ProbeRandom& random) const {
    const std::size_t which = random.below(tubes_.size() + points_.size());
    return which < tubes_.size() ? in_tube(*tubes_[which], random)
                                 : in_point(*points_[which - tubes_.size()], random);
  }

 private:
  struct Vertex {
    Vec3d p;
    double radius;
  };
  template <typename Set>
  Vertex vertex(const Set& set, std::uint32_t v) const {
    const RoundVertex at = set.vertex(v, time_);
    return {Vec3d(at.p), double(at.radius)};
  }
  template <typename Set>
  double control_size(const Set& set, std::uint32_t v) const {
    return largest_control(set.form(), double(time_), [&](std::uint32_t c) {
      const RoundVertex& at = set.control_vertices(c)[v];
      return largest_coordinate(Vec3d(at.p)) + double(at.radius);
    });
  }
  template <typename Set>
  void grow(const Set& set, std::uint32_t count) {
    for (std::uint32_t v = 0; v < count; ++v) {
      const Vertex at = vertex(set, v);
      const Vec3d r{at.radius, at.radius, at.radius};
      box_.grow(at.p - r);
      box_.grow(at.p + r);
    }
  }

  std::optional<Place> in_point(const PointSet& set, ProbeRandom& random) const {
    const auto i = static_cast<std::uint32_t>(random.below(set.point_count));
    const Vertex at = vertex(set, i);
    return Place{at.p, at.radius, control_size(set, i)};
  }

  // None where it is near a free end.
  std::optional<Place> in_tube(const CurveSet& set, ProbeRandom& random) const {
    const auto span = static_cast<std::uint32_t>(random.below(set.span_count()));
    std::array<Vertex, kSpanVertices> v;
    double size = 0.0;
    for (std::uint32_t i = 0; i < kSpanVertices; ++i) {
      v[i] = vertex(set, set.spans[span] + i);
      size = std::max(size, control_size(set, set.spans[span] + i));
    }
    const double t = random.uniform();
    const auto p = [&](std::uint32_t i) { return v[i].p; };
    const auto radius = [&](std::uint32_t i) { return v[i].radius; };
    const auto chord = [&](std::uint32_t i) { return v[i + 1].p - v[i].p; };
    const Vec3d along = bezier(chord, 2, t);
    const Place place{bezier(p, 3, t), bezier(radius, 3, t), size, along};
    for (const bool at_end : {false, true}) {
      const std::optional<Vec3d> end = free_end(set, span, at_end);
      if (end && length(*end - place.middle) < kFromEnds * place.radius) return std::nullopt;
    }
    if (!(length(along) > 0.0)) return std::nullopt;
    return place;
  }
  // Of the chain that the span is of; none: it closes.
  std::optional<Vec3d> free_end(const CurveSet& set, std::uint32_t span, bool at_end) const {
    for (std::uint32_t i = 0; i < set.span_count(); ++i) {
      const std::optional<std::uint32_t> next = set.neighbour(span, at_end);
      if (!next) return vertex(set, set.spans[span] + (at_end ? kSpanVertices - 1 : 0)).p;
      span = *next;
    }
    return std::nullopt;
  }

  const float time_;
  std::vector<const CurveSet*> tubes_;
  std::vector<const PointSet*> points_;
  Box3d box_;
};

// From the side of a tube.
Vec3d direction_to(const Place& place, ProbeRandom& random) {
  for (;;) {
    const Vec3d dir = random.direction();
    if (!place.along || std::abs(dot(dir, normalize(*place.along))) < kMostAlong) return dir;
  }
}

std::optional<Ray> ray_into(const RoundPose& pose, ProbeRandom& random) {
  const std::optional<Place> place = pose.place(random);
  if (!place) return std::nullopt;
  const Vec3d end = place->middle + random.direction() * (kFromMiddle * place->radius * random.uniform());
  const double away = pose.diagonal() * random.uniform(1.1, 2.0);
  Ray ray;
  ray.org = Vec3f(end - direction_to(*place, random) * away);
  ray.dir = Vec3f(end - Vec3d(ray.org));
  ray.tfar = 1.0f;
  const double size = std::max(place->rounded_size, largest_coordinate(Vec3d(ray.org)));
  if (!((1.0 - kFromMiddle) * place->radius > kClearance * size)) return std::nullopt;
  return ray;
}

}  // namespace

std::vector<Ray> rays_into_round(const Bvh& world, std::size_t count, std::uint64_t seed) {
  ProbeRandom random(seed);
  std::vector<Ray> rays;
  for (std::size_t of_time = 0; of_time * kRaysOfTime < count; ++of_time) {
    const float time = random.time();
    const RoundPose pose(world, time);
    if (pose.empty()) break;
    for (std::size_t i = 0; i < kRaysOfTime; ++i) {
      std::optional<Ray> ray;
      for (int tries = 0; tries < kTries && !ray; ++tries) ray = ray_into(pose, random);
      if (!ray) continue;
      ray->time = time;
      rays.push_back(*ray);
    }
  }
  return rays;
}

}  // namespace msbvh
