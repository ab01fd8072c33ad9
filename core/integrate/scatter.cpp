#include "core/integrate/scatter.h"

#include "core/integrate/shadow.h"
#include "core/plan/effect_variant.h"
#include "core/shade/warp.h"

namespace msbvh {
namespace {

// What the last vertex gathers.
template <bool kOpacity>
void add_dome(const Frame& frame, PathBatch& batch) {
  batch.mark.enter(Stage::kDome, batch.depth);
  for (const std::uint32_t place : batch.shaded) {
    if (!(batch.scatter_pdf[place] > 0.0f)) continue;
    const PathIndex path = batch.active[place];
    const Ray& ray = batch.scattered[place];
    batch.shadows.add(ray, path, batch.throughput[path] * frame.lights.dome_radiance(ray.time));
  }
  trace_shadows<kOpacity>(frame, batch);
}

void scatter(PathBatch& batch) {
  batch.mark.enter(Stage::kScatter, batch.depth);
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

// What is scattered: at the last vertex, where paths do not go on, only what finds light.
template <EffectSet kOn>
void scatter_where_read(const Frame& frame, PathBatch& batch) {
  constexpr bool kFindsLight = kOn.has(Effect::kDomeLight) || kOn.has(Effect::kAreaLights);
  if constexpr (kFindsLight) {
    scatter(batch);
  } else if constexpr (kOn.has(Effect::kIndirectLight)) {
    if (batch.depth < frame.max_bounces) scatter(batch);
  }
}

// Returns how many go on.
std::size_t move_on(PathBatch& batch) {
  std::size_t count = 0;
  for (const std::uint32_t place : batch.shaded) {
    if (!(batch.scatter_pdf[place] > 0.0f)) continue;
    batch.active[count] = batch.active[place];  // a place that has been read: the queue only moves up
    batch.rays[count] = batch.scattered[place];
    ++count;
  }
  ++batch.depth;
  return count;
}

template <EffectSet kOn>
void go_on(const Frame& frame, PathBatch& batch) {
  std::size_t count = 0;
  if (kOn.has(Effect::kIndirectLight) && batch.depth < frame.max_bounces) {
    count = move_on(batch);
  } else if constexpr (kOn.has(Effect::kDomeLight)) {
    add_dome<kOn.has(Effect::kOpacity)>(frame, batch);
  }
  batch.active.resize(count);
  batch.rays.resize(count);
}

}  // namespace

PathStage choose_scatter(EffectSet effects) {
  return variant_for<Effect::kDomeLight, Effect::kAreaLights, Effect::kIndirectLight>(
      effects,
      []<EffectSet kOn>() -> PathStage { return kOn == kPlain ? no_stage : scatter_where_read<kOn>; });
}

PathStage choose_go_on(EffectSet effects) {
  return variant_for<Effect::kDomeLight, Effect::kIndirectLight, Effect::kOpacity>(
      effects, []<EffectSet kOn>() -> PathStage { return go_on<kOn>; });
}

}  // namespace msbvh
