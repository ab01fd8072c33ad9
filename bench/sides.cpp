#include "bench/sides.h"

#include <limits>

#include "core/base/parallel.h"

namespace msbvh::bench {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::size_t kRaysPerTask = 1u << 10;
static_assert(kRaysPerTask % kPeerPacket == 0);

}  // namespace

void OurSide::build(unsigned) {
  BuildSettings settings;
  settings.builder = builder.builder;
  settings.layout = layout;
  trees_ = std::make_unique<Trees>(scene_, settings);
  tracer_.emplace(trees_->world());
}

const std::vector<std::string>& OurSide::modes() const {
  static const std::vector<std::string> names{"single", "many"};
  return names;
}

void OurSide::trace(std::size_t mode, RayKind kind, std::size_t begin, std::size_t end, float* t) const {
  const std::span<const Ray> rays = rays_.subspan(begin, end - begin);
  mode == kSingle ? trace_single(kind, rays, t) : trace_many(kind, rays, t);
}

void OurSide::trace_single(RayKind kind, std::span<const Ray> rays, float* t) const {
  if (kind == RayKind::kShadow) {
    for (std::size_t i = 0; i < rays.size(); ++i) t[i] = tracer_->occluded(rays[i]) ? 0.0f : kInfinity;
    return;
  }
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Hit hit;
    t[i] = tracer_->intersect(rays[i], hit) ? hit.t : kInfinity;
  }
}

// As a renderer that has many rays at hand asks.
void OurSide::trace_many(RayKind kind, std::span<const Ray> rays, float* t) const {
  if (kind == RayKind::kShadow) {
    const auto occluded = std::make_unique<bool[]>(rays.size());
    tracer_->occluded(rays, occluded.get());
    for (std::size_t i = 0; i < rays.size(); ++i) t[i] = occluded[i] ? 0.0f : kInfinity;
    return;
  }
  std::vector<Hit> hits(rays.size());
  tracer_->intersect(rays, hits.data());
  for (std::size_t i = 0; i < rays.size(); ++i) t[i] = hits[i].found() ? hits[i].t : kInfinity;
}

void trace_all(const Side& side, std::size_t mode, RayKind kind, std::vector<float>& t) {
  parallel_for_ranges(t.size(), kRaysPerTask, [&](std::size_t begin, std::size_t end) {
    side.trace(mode, kind, begin, end, t.data() + begin);
  });
}

}  // namespace msbvh::bench
