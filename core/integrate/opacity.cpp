#include "core/integrate/opacity.h"

#include <cmath>
#include <limits>

namespace msbvh {
namespace {

bool sees_through(const Frame& frame, const Sampler& sampler, const Hit& hit, float time, std::uint32_t depth,
                  std::uint32_t layer) {
  const float opacity = opacity_at(frame.scene(), frame.index.resolve(hit), hit, time);
  return opacity < 1.0f && sampler.pair(Dimension::kOpacity, depth, layer).x >= opacity;
}

}  // namespace

void step_past(const Hit& hit, Ray& ray) {
  ray.tnear = std::nextafter(hit.t, std::numeric_limits<float>::infinity());
}

void see_through(const Frame& frame, PathBatch& batch) {
  batch.mark.enter(Stage::kOpacity, batch.depth);
  std::vector<std::uint32_t>& places = batch.retraced;
  places.resize(batch.active.size());
  for (std::uint32_t i = 0; i < places.size(); ++i) places[i] = i;
  for (std::uint32_t layer = 0;; ++layer) {
    std::size_t count = 0;
    batch.retraced_rays.clear();
    for (const std::uint32_t place : places) {
      const Hit& hit = batch.hits[place];
      Ray& ray = batch.rays[place];
      const Sampler& sampler = batch.sampler[batch.active[place]];
      if (!hit.found() || !sees_through(frame, sampler, hit, ray.time, batch.depth, layer)) continue;
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

}  // namespace msbvh
