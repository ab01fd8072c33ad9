#include "core/integrate/controlled_shadow.h"

#include <algorithm>
#include <cmath>

#include "core/base/lerp.h"
#include "core/integrate/covers.h"
#include "core/integrate/frame.h"
#include "core/integrate/opacity.h"

namespace msbvh {
namespace {

// Whether a part of the ray goes on behind what it has hit.
bool goes_on(const Frame& frame, const Hit& hit, const Cover& cover, ShadowQueue::Dimmed& dimmed) {
  if (!hit.found()) return false;
  const HitSource source = frame.index.resolve(hit);
  if (!holds_group(dimmed.light->shadow_groups, source.light_group())) return true;
  const float absorbed = dimmed.left * shadow_share(cover);
  dimmed.shadowed += absorbed * shadow_strength(dimmed.light->shadow, hit.t);
  dimmed.left -= absorbed;
  return dimmed.left > 0.0f;
}

// How light meets what the rays have hit: batch.found_covers, in their order.
void find_all_covers(const Frame& frame, PathBatch& batch) {
  const ShadowQueue& queue = batch.shadows;
  batch.retraced_widths.clear();
  for (std::size_t i = 0; i < queue.size(); ++i)
    batch.retraced_widths.push_back(frame.textures ? batch.widths[queue.path(i)] : 0.0f);
  find_covers(frame, queue.rays(), batch.retraced_hits, batch.retraced_widths, batch.reads, batch.by_material,
              batch.found_covers);
}

}  // namespace

float shadow_strength(const LightShadow& shadow, float distance) {
  if (shadow.distance < 0.0f || !(shadow.falloff > 0.0f)) return 1.0f;
  const float zone = std::min(shadow.falloff, shadow.distance);
  if (!(zone > 0.0f)) return 1.0f;
  const float share = std::clamp((shadow.distance - distance) / zone, 0.0f, 1.0f);
  return shadow.falloff_gamma == 1.0f ? share : std::pow(share, shadow.falloff_gamma);
}

Vec3f shadowed_light(const LightShadow& shadow, const Vec3f& light, float share) {
  return light * lerp(Vec3f{1.0f, 1.0f, 1.0f}, shadow.color, std::min(share, 1.0f));
}

void add_controlled_shadow(const Light& light, const Ray& ray, PathIndex path, const Vec3f& contribution,
                           PathBatch& batch) {
  if (!light.shadow.enabled) {
    batch.radiance[path] += contribution;
    return;
  }
  Ray limited = ray;
  if (light.shadow.distance >= 0.0f) limited.tfar = std::min(ray.tfar, light.shadow.distance);
  batch.shadows.add_dimmed(limited, path, contribution, {&light});
}

void trace_controlled_shadows(const Frame& frame, PathBatch& batch) {
  ShadowQueue& queue = batch.shadows;
  std::vector<Hit>& hits = batch.retraced_hits;
  batch.mark.trace(true);
  while (queue.size() > 0) {
    hits.resize(queue.size());
    frame.tracer.intersect(queue.rays(), hits.data(), batch.traced);
    find_all_covers(frame, batch);
    std::size_t left = 0;
    for (std::size_t i = 0; i < hits.size(); ++i) {
      Ray ray = queue.rays()[i];
      ShadowQueue::Dimmed dimmed = queue.dimmed(i);
      const PathIndex path = queue.path(i);
      const Vec3f contribution = queue.contribution(i);
      if (goes_on(frame, hits[i], batch.found_covers[i], dimmed)) {
        step_past(hits[i], ray);
        queue.set_dimmed(left++, ray, path, contribution, dimmed);
      } else {
        batch.radiance[path] += shadowed_light(dimmed.light->shadow, contribution, dimmed.shadowed);
      }
    }
    queue.resize(left);
  }
  batch.shadows.clear();
  batch.mark.trace(false);
}

}  // namespace msbvh
