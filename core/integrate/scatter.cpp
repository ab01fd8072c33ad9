#include "core/integrate/scatter.h"

#include "core/integrate/shadow.h"
#include "core/shade/warp.h"

namespace msbvh {
namespace {

// The cosine and its density cancel. False where the shading normal leads the ray below the surface.
bool bounce(const SurfaceHit& surface, const Sampler& sampler, std::uint32_t depth, Ray& ray) {
  const Point2 random = sampler.pair(Dimension::kBounce, depth);
  const Vec3f direction = Basis(surface.shading_normal)(sample_cosine_hemisphere(random));
  if (dot(direction, surface.geometric_normal) <= 0.0f) return false;
  ray = leave(surface, direction, ray.time);
  return true;
}

void bounce_all(PathBatch& batch) {
  std::size_t count = 0;
  for (const std::uint32_t place : batch.shaded) {
    const PathIndex path = batch.active[place];
    Ray ray = batch.rays[place];
    if (!bounce(batch.surfaces[place], batch.sampler[path], batch.depth, ray)) continue;
    batch.active[count] = path;  // a place that has been read: the queue only moves up
    batch.rays[count] = ray;
    ++count;
  }
  batch.active.resize(count);
  batch.rays.resize(count);
}

// What the last bounce gathers.
void add_dome(const Frame& frame, EffectSet effects, PathBatch& batch) {
  for (std::size_t place = 0; place < batch.active.size(); ++place) {
    const PathIndex path = batch.active[place];
    const Ray& ray = batch.rays[place];
    batch.shadows.add(ray, path, batch.throughput[path] * frame.lights.dome_radiance(ray.time));
  }
  trace_shadows(frame, effects, batch);
}

}  // namespace

void scatter(const Frame& frame, EffectSet effects, PathBatch& batch) {
  const bool last = !effects.has(Effect::kIndirectLight) || batch.depth == frame.max_bounces;
  if (last && !frame.lights.has_dome) {
    batch.active.clear();
    return;
  }
  bounce_all(batch);
  ++batch.depth;
  if (!last) return;
  add_dome(frame, effects, batch);
  batch.active.clear();
}

}  // namespace msbvh
