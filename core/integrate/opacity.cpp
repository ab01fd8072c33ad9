#include "core/integrate/opacity.h"

#include <cmath>
#include <limits>

#include "core/integrate/covers.h"
#include "core/plan/effect_variant.h"

namespace msbvh {
namespace {

bool sees_through(float opacity, const Sampler& sampler, std::uint32_t depth, std::uint32_t layer) {
  return opacity < 1.0f && sampler.pair(Dimension::kOpacity, depth, layer).x >= opacity;
}

// How light meets what the rays at those places have hit: batch.found_covers, in their order.
void find_looked_at(const Frame& frame, std::span<const std::uint32_t> places, PathBatch& batch) {
  batch.retraced_rays.clear();
  batch.retraced_hits.clear();
  batch.retraced_widths.clear();
  for (const std::uint32_t place : places) {
    const Hit& hit = batch.hits[place];
    batch.retraced_rays.push_back(batch.rays[place]);
    batch.retraced_hits.push_back(hit);
    batch.retraced_widths.push_back(frame.textures ? batch.cones[batch.active[place]].width_at(hit.t) : 0.0f);
  }
  find_covers(frame, batch.retraced_rays, batch.retraced_hits, batch.retraced_widths, batch.reads,
              batch.by_material, batch.found_covers);
}

// kLooks: something is textured, or reflects.
template <bool kLooks>
void see_through(const Frame& frame, PathBatch& batch) {
  batch.mark.enter(Stage::kOpacity, batch.depth);
  std::vector<std::uint32_t>& places = batch.retraced;
  places.resize(batch.active.size());
  for (std::uint32_t i = 0; i < places.size(); ++i) places[i] = i;
  if constexpr (kLooks) batch.covers.assign(batch.active.size(), {});
  for (std::uint32_t layer = 0;; ++layer) {
    std::size_t count = 0;
    if constexpr (kLooks) find_looked_at(frame, places, batch);
    batch.retraced_rays.clear();
    for (std::size_t i = 0; i < places.size(); ++i) {
      const std::uint32_t place = places[i];
      const Hit& hit = batch.hits[place];
      Ray& ray = batch.rays[place];
      if (!hit.found()) continue;
      const float chance = kLooks ? batch.found_covers[i].chance
                                  : opacity_at(frame.scene(), frame.index.resolve(hit), hit, ray.time);
      const bool passes = sees_through(chance, batch.sampler[batch.active[place]], batch.depth, layer);
      if constexpr (kLooks) {
        if (ends_there(batch.found_covers[i], passes, batch.covers[place])) continue;
      } else if (!passes) {
        continue;
      }
      step_past(hit, ray);
      batch.retraced_rays.push_back(ray);
      places[count++] = place;
    }
    places.resize(count);
    if (count == 0) return;
    batch.retraced_hits.resize(count);
    batch.mark.trace(true);
    frame.tracer.intersect(batch.retraced_rays, batch.retraced_hits.data(), batch.traced);
    batch.mark.trace(false);
    for (std::size_t i = 0; i < count; ++i) batch.hits[places[i]] = batch.retraced_hits[i];
  }
}

}  // namespace

void step_past(const Hit& hit, Ray& ray) {
  ray.tnear = std::nextafter(hit.t, std::numeric_limits<float>::infinity());
}

PathStage choose_see_through(EffectSet effects) {
  if constexpr (!kKnownEffects.has(Effect::kOpacity)) return no_stage;
  if (!effects.has(Effect::kOpacity)) return no_stage;
  return effects.has(Effect::kTextures) || effects.has(Effect::kSpecular) ? see_through<true>
                                                                          : see_through<false>;
}

}  // namespace msbvh
