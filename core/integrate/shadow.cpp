#include "core/integrate/shadow.h"

#include "core/integrate/covers.h"
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
// kLooks: something is textured, or reflects.
template <bool kLooks>
void trace_dimmed(const Frame& frame, PathBatch& batch) {
  ShadowQueue& queue = batch.shadows;
  std::vector<Hit>& hits = batch.retraced_hits;
  while (queue.size() > 0) {
    hits.resize(queue.size());
    frame.tracer.intersect(queue.rays(), hits.data(), batch.traced);
    if constexpr (kLooks) {
      batch.retraced_widths.clear();
      for (std::size_t i = 0; i < hits.size(); ++i)
        batch.retraced_widths.push_back(frame.textures ? batch.widths[queue.path(i)] : 0.0f);
      find_covers(frame, queue.rays(), hits, batch.retraced_widths, batch.reads, batch.by_material,
                  batch.found_covers);
    }
    std::size_t left = 0;
    for (std::size_t i = 0; i < hits.size(); ++i) {
      if (!hits[i].found()) {
        batch.radiance[queue.path(i)] += queue.contribution(i);
        continue;
      }
      Ray ray = queue.rays()[i];
      const float share = kLooks ? shadow_share(batch.found_covers[i])
                                 : opacity_at(frame.scene(), frame.index.resolve(hits[i]), hits[i], ray.time);
      const Vec3f light = queue.contribution(i) * (1.0f - share);
      if (light == Vec3f{}) continue;
      step_past(hits[i], ray);
      queue.set(left++, ray, queue.path(i), light);
    }
    queue.resize(left);
  }
}

}  // namespace

template <EffectSet kOn>
void trace_shadows(const Frame& frame, PathBatch& batch) {
  batch.mark.trace(true);
  if (batch.shadows.size() > 0) {
    if constexpr (kOn.has(Effect::kOpacity))
      trace_dimmed<kOn.has(Effect::kTextures)>(frame, batch);
    else
      trace_opaque(frame, batch);
  }
  batch.shadows.clear();
  batch.mark.trace(false);
}

template void trace_shadows<kPlain>(const Frame&, PathBatch&);
template void trace_shadows<kPlain.with(Effect::kOpacity)>(const Frame&, PathBatch&);
template void trace_shadows<kPlain.with(Effect::kTextures)>(const Frame&, PathBatch&);
template void trace_shadows<kPlain.with(Effect::kOpacity).with(Effect::kTextures)>(const Frame&, PathBatch&);

}  // namespace msbvh
