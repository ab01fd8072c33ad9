#include "core/integrate/shadow.h"

#include "core/integrate/opacity.h"

namespace msbvh {
namespace {

void trace_opaque(const Frame& frame, PathBatch& batch) {
  const ShadowQueue& queue = batch.shadows;
  frame.tracer.occluded(queue.rays(), batch.occluded.get(), batch.traced);
  for (std::size_t i = 0; i < queue.size(); ++i) {
    if (!batch.occluded[i]) batch.radiance[queue.path(i)] += queue.contribution(i);
  }
}

// The rays that still carry light after a layer go on from there together.
void trace_dimmed(const Frame& frame, PathBatch& batch) {
  ShadowQueue& queue = batch.shadows;
  std::vector<Hit>& hits = batch.retraced_hits;
  while (queue.size() > 0) {
    hits.resize(queue.size());
    frame.tracer.intersect(queue.rays(), hits.data(), batch.traced);
    std::size_t left = 0;
    for (std::size_t i = 0; i < hits.size(); ++i) {
      if (!hits[i].found()) {
        batch.radiance[queue.path(i)] += queue.contribution(i);
        continue;
      }
      Ray ray = queue.rays()[i];
      const HitSource source = frame.index.resolve(hits[i]);
      const Vec3f light =
          queue.contribution(i) * (1.0f - opacity_at(frame.scene(), source, hits[i], ray.time));
      if (light == Vec3f{}) continue;
      step_past(hits[i], ray);
      queue.set(left++, ray, queue.path(i), light);
    }
    queue.resize(left);
  }
}

}  // namespace

template <bool kOpacity>
void trace_shadows(const Frame& frame, PathBatch& batch) {
  batch.mark.trace(true);
  if (batch.shadows.size() > 0) kOpacity ? trace_dimmed(frame, batch) : trace_opaque(frame, batch);
  batch.shadows.clear();
  batch.mark.trace(false);
}

template void trace_shadows<false>(const Frame&, PathBatch&);
template void trace_shadows<true>(const Frame&, PathBatch&);

}  // namespace msbvh
