#include "bench/sides.h"

#include <limits>

#include "core/base/parallel.h"

namespace msbvh::bench {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::size_t kRaysPerTask = 1u << 10;

}  // namespace

void OurSide::build(unsigned) {
  BuildSettings settings;
  settings.builder = builder.builder;
  trees_ = std::make_unique<Trees>(scene_, settings);
  tracer_.emplace(trees_->world());
}

// As a renderer that has many rays at hand asks.
void OurSide::trace(RayKind kind, const Ray* rays, std::size_t count, float* t) const {
  if (kind == RayKind::kShadow) {
    const auto occluded = std::make_unique<bool[]>(count);
    tracer_->occluded({rays, count}, occluded.get());
    for (std::size_t i = 0; i < count; ++i) t[i] = occluded[i] ? 0.0f : kInfinity;
    return;
  }
  std::vector<Hit> hits(count);
  tracer_->intersect({rays, count}, hits.data());
  for (std::size_t i = 0; i < count; ++i) t[i] = hits[i].found() ? hits[i].t : kInfinity;
}

void trace_all(const Side& side, RayKind kind, const std::vector<Ray>& rays, std::vector<float>& t) {
  parallel_for_ranges(rays.size(), kRaysPerTask, [&](std::size_t begin, std::size_t end) {
    side.trace(kind, rays.data() + begin, end - begin, t.data() + begin);
  });
}

}  // namespace msbvh::bench
