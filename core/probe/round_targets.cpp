#include "core/probe/round_targets.h"

#include <algorithm>

#include "core/geometry/curve_set.h"
#include "core/geometry/point_set.h"
#include "core/trace/pose.h"
#include "core/trace/ray.h"

namespace msbvh {
namespace {

RoundTarget on_span(const CurveSet& curves, double u, ProbeRandom& random) {
  const std::uint32_t first = curves.spans[random.below(curves.spans.size())];
  const double ends[] = {0.0, 1.0, random.uniform(), random.uniform()};
  const double s = ends[random.below(4)], r = 1.0 - s;
  const double weights[] = {r * r * r, 3 * r * r * s, 3 * r * s * s, s * s * s};
  const double slopes[] = {-r * r, r * r - 2 * r * s, 2 * r * s - s * s, s * s};
  RoundTarget target{};
  for (std::uint32_t i = 0; i < kSpanVertices; ++i) {
    const RoundVertex v = curves.vertex(first + i, static_cast<float>(u));
    target.centre = target.centre + Vec3d(v.p) * weights[i];
    target.along = target.along + Vec3d(v.p) * slopes[i];
    target.radius += double(v.radius) * weights[i];
  }
  return target;
}

RoundTarget on_point(const PointSet& points, double u, ProbeRandom& random) {
  const auto i = static_cast<std::uint32_t>(random.below(points.point_count));
  const RoundVertex v = points.vertex(i, static_cast<float>(u));
  return {Vec3d(v.p), {}, double(v.radius)};
}

}  // namespace

RoundTargets::RoundTargets(const Bvh& world) : world_(world) {
  add(world, kNoInstance);
  for (std::uint32_t i = 0; i < world.instances.size(); ++i) add(*world.instances[i].object, i);
}

void RoundTargets::add(const Bvh& bvh, std::uint32_t instance) {
  for (const auto& set : bvh.curves) {
    if (set->span_count() > 0) sets_.push_back({set.get(), nullptr, instance});
  }
  for (const auto& set : bvh.points) {
    if (set->point_count > 0) sets_.push_back({nullptr, set.get(), instance});
  }
}

std::optional<RoundTarget> RoundTargets::pick(float time, ProbeRandom& random) const {
  const Set& set = sets_[random.below(sets_.size())];
  std::optional<double> inside = double(time);
  Affine3d map;
  if (set.instance != kNoInstance) {
    const Instance& instance = world_.instances[set.instance];
    const std::optional<double> own = local_time(world_.time_remap_of(instance), double(time));
    inside = local_time(&instance.object->time_remap, double(time));
    if (!own || !inside) return std::nullopt;
    map = map_at(world_, instance, *own);
  }
  RoundTarget target =
      set.curves ? on_span(*set.curves, *inside, random) : on_point(*set.points, *inside, random);
  target.centre = map.point(target.centre);
  target.along = map.vector(target.along);
  target.radius *= std::max({length(map.x), length(map.y), length(map.z)});
  return target;
}

}  // namespace msbvh
