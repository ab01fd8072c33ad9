#include "bench/checks.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>

#include "core/base/parallel.h"
#include "core/trace/oracle.h"

namespace msbvh::bench {
namespace {

bool is_wrong(const Bvh& bvh, const Tracer& tracer, RayKind kind, const Ray& ray) {
  if (kind == RayKind::kShadow) return judge_occlusion(bvh, ray, tracer.occluded(ray)).has_value();
  Hit hit;
  const bool found = tracer.intersect(ray, hit);
  return judge_intersection(bvh, ray, found ? std::optional(hit) : std::nullopt).has_value();
}

}  // namespace

OracleCheck check_oracle(const Bvh& bvh, RayKind kind, const std::vector<Ray>& rays, double triangle_tests) {
  const Tracer tracer(bvh);
  const double affordable = std::max(4.0, triangle_tests / std::max(1.0, oracle_tests_per_ray(bvh)));
  const std::size_t count = std::min(rays.size(), static_cast<std::size_t>(affordable));
  std::atomic<std::size_t> wrong = 0;
  parallel_for(count,
               [&](std::size_t i) { wrong += is_wrong(bvh, tracer, kind, rays[i * rays.size() / count]); });
  return {count, wrong};
}

std::size_t count_differences(const std::vector<Ray>& rays, const std::vector<float>& a,
                              const std::vector<float>& b, double tolerance) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (std::isinf(a[i]) || std::isinf(b[i])) {
      count += std::isinf(a[i]) != std::isinf(b[i]);
    } else {
      count += std::abs(double(a[i]) - double(b[i])) * length(Vec3d(rays[i].dir)) > tolerance;
    }
  }
  return count;
}

std::size_t count_misses(Side& side, const std::vector<Ray>& rays) {
  std::vector<float> t(rays.size());
  side.prepare(rays);
  std::ptrdiff_t most = 0;
  for (std::size_t mode = 0; mode < side.modes().size(); ++mode) {
    trace_all(side, mode, RayKind::kRandom, t);
    most = std::max(most, std::ranges::count_if(t, [](float x) { return std::isinf(x); }));
  }
  return static_cast<std::size_t>(most);
}

TraceCounts count_work(const Bvh& bvh, RayKind kind, const std::vector<Ray>& rays) {
  const Tracer tracer(bvh);
  TraceCounts counts;
  for (std::size_t i = 0; i < rays.size(); i += 16) {
    Hit hit;
    kind == RayKind::kShadow ? tracer.occluded_counted(rays[i], counts)
                             : tracer.intersect_counted(rays[i], hit, counts);
  }
  return counts;
}

}  // namespace msbvh::bench
