#include "core/integrate/direct.h"

#include "core/integrate/shadow.h"
#include "core/shade/warp.h"

namespace msbvh {
namespace {

// What a light sends to a white surface and on along the path: irradiance over pi, times the path's
// throughput.
void light_surface(const Frame& frame, std::uint32_t light, std::uint32_t place, PathBatch& batch) {
  const SurfaceHit& surface = batch.surfaces[place];
  const PathIndex path = batch.active[place];
  const float time = batch.rays[place].time;
  const Point2 random = batch.sampler[path].pair(Dimension::kLight, batch.depth, light);
  LightSample sample;
  if (!sample_light(*frame.lights.sampled[light], frame.scene().camera, surface.position, time, random,
                    sample)) {
    return;
  }
  const float cosine = dot(sample.direction, surface.shading_normal);
  if (cosine <= 0.0f || dot(sample.direction, surface.geometric_normal) <= 0.0f) return;
  const Vec3f contribution = batch.throughput[path] * sample.irradiance * (cosine * (1.0f / kPi));
  if (!sample.casts_shadow) {
    batch.radiance[path] += contribution;
    return;
  }
  Ray shadow = leave(surface, sample.direction, time);
  shadow.tfar = sample.distance;
  batch.shadows.add(shadow, path, contribution);
}

}  // namespace

void add_direct_light(const Frame& frame, EffectSet effects, PathBatch& batch) {
  for (std::uint32_t light = 0; light < frame.lights.sampled.size(); ++light) {
    for (const std::uint32_t place : batch.shaded) light_surface(frame, light, place, batch);
    trace_shadows(frame, effects, batch);
  }
}

}  // namespace msbvh
