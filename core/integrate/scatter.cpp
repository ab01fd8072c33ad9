#include "core/integrate/scatter.h"

#include "core/integrate/shadow.h"
#include "core/shade/warp.h"

namespace msbvh {
namespace {

// What the last vertex gathers.
void add_dome(const Frame& frame, EffectSet effects, PathBatch& batch) {
  for (const std::uint32_t place : batch.shaded) {
    if (!(batch.scatter_pdf[place] > 0.0f)) continue;
    const PathIndex path = batch.active[place];
    const Ray& ray = batch.scattered[place];
    batch.shadows.add(ray, path, batch.throughput[path] * frame.lights.dome_radiance(ray.time));
  }
  trace_shadows(frame, effects, batch);
}

}  // namespace

bool is_last_vertex(const Frame& frame, EffectSet effects, const PathBatch& batch) {
  return !effects.has(Effect::kIndirectLight) || batch.depth == frame.max_bounces;
}

void scatter(PathBatch& batch) {
  batch.drawn.draw(batch.sampler, batch.shaded_paths, Draw(Dimension::kBounce, batch.depth));
  for (std::size_t i = 0; i < batch.shaded.size(); ++i) {
    const std::uint32_t place = batch.shaded[i];
    const SurfaceHit& surface = batch.surfaces[place];
    const Vec3f local = sample_cosine_hemisphere(batch.drawn[i]);
    const Vec3f direction = Basis(surface.shading_normal)(local);
    // A shading normal may lead it below the surface.
    const bool above = dot(direction, surface.geometric_normal) > 0.0f;
    batch.scatter_pdf[place] = above ? local.z * (1.0f / kPi) : 0.0f;
    batch.scattered[place] = leave(surface, direction, batch.rays[place].time);
  }
}

void go_on(const Frame& frame, EffectSet effects, PathBatch& batch) {
  std::size_t count = 0;
  if (!is_last_vertex(frame, effects, batch)) {
    for (const std::uint32_t place : batch.shaded) {
      if (!(batch.scatter_pdf[place] > 0.0f)) continue;
      batch.active[count] = batch.active[place];  // a place that has been read: the queue only moves up
      batch.rays[count] = batch.scattered[place];
      ++count;
    }
    ++batch.depth;
  } else if (frame.lights.has_dome()) {
    add_dome(frame, effects, batch);
  }
  batch.active.resize(count);
  batch.rays.resize(count);
}

}  // namespace msbvh
