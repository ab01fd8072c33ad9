#include "core/integrate/scatter.h"

#include "core/integrate/light_parts.h"
#include "core/integrate/looks.h"
#include "core/integrate/shadow.h"
#include "core/integrate/special_variant.h"
#include "core/plan/effect_variant.h"
#include "core/shade/warp.h"

namespace msbvh {
namespace {

// What the last vertex gathers.
template <EffectSet kOn>
void add_dome(const Frame& frame, PathBatch& batch) {
  batch.mark.enter(Stage::kDome, batch.depth);
  for (const std::uint32_t place : batch.shaded) {
    if (!(batch.scatter_pdf[place] > 0.0f)) continue;
    const PathIndex path = batch.active[place];
    const Ray& ray = batch.scattered[place];
    Vec3f throughput = batch.throughput[path];
    if constexpr (kOn.has(Effect::kSpecular)) throughput = throughput * batch.scatter_weight[place];
    batch.shadows.add(ray, path, throughput * frame.lights.dome_radiance(ray.time));
  }
  trace_shadows<shadow_effects(kOn)>(frame, batch);
}

// Glass may lead a path into a body, or out of it.
void note_side(const SurfaceHit& surface, const Vec3f& direction, std::uint32_t place, PathBatch& batch) {
  if (!batch.within.empty() && std::holds_alternative<Glass>(batch.special[place]) &&
      dot(direction, surface.geometric_normal) < 0.0f)
    batch.within[batch.active[place]] ^= 1u;
}

// By the lobes of each surface. kSpecial: some of them are of glass, or fibres.
template <bool kSpecial>
void scatter_by_lobes(PathBatch& batch) {
  batch.lobes.draw(batch.sampler, batch.shaded_paths, Draw(Dimension::kLobe, batch.depth));
  for (std::size_t i = 0; i < batch.shaded.size(); ++i) {
    const std::uint32_t place = batch.shaded[i];
    const SurfaceHit& surface = batch.surfaces[place];
    BsdfSample sample;
    bool above;
    if constexpr (kSpecial) {
      const SpecialLobe& special = batch.special[place];
      sample =
          sample_of(special, batch.bsdfs[place], surface.shading_normal, batch.lobes[i].x, batch.drawn[i]);
      above = leads_on(special, surface, sample.direction);
      if (above && sample.pdf > 0.0f) note_side(surface, sample.direction, place, batch);
    } else {
      sample = batch.bsdfs[place].sample(surface.shading_normal, batch.lobes[i].x, batch.drawn[i]);
      above = dot(sample.direction, surface.geometric_normal) > 0.0f;
    }
    batch.scatter_pdf[place] = above ? sample.pdf : 0.0f;
    batch.scatter_weight[place] = sample.weight;
    if (batch.depth == 0 && !batch.light.empty())
      batch.scattered_share[batch.active[place]] = specular_share(sample.specular, sample.weight);
    batch.scattered[place] = leave(surface, sample.direction, batch.rays[place].time);
  }
}

template <EffectSet kOn>
void scatter(PathBatch& batch) {
  batch.mark.enter(Stage::kScatter, batch.depth);
  batch.drawn.draw(batch.sampler, batch.shaded_paths, Draw(Dimension::kBounce, batch.depth));
  if constexpr (kOn.has(Effect::kSpecular)) return scatter_by_lobes<kOn.has(kSpecialLobes)>(batch);
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
    scatter<kOn>(batch);
  } else if constexpr (kOn.has(Effect::kIndirectLight)) {
    if (batch.depth < frame.max_bounces) scatter<kOn>(batch);
  }
}

// Returns how many go on.
template <EffectSet kOn>
std::size_t move_on(const Frame& frame, PathBatch& batch) {
  std::size_t count = 0;
  for (const std::uint32_t place : batch.shaded) {
    if (!(batch.scatter_pdf[place] > 0.0f)) continue;
    const PathIndex path = batch.active[place];
    if constexpr (kOn.has(Effect::kTextures)) {
      batch.cones[path] =
          scattered_cone(frame, batch.cones[path], batch.hits[place].t, batch.scatter_pdf[place]);
    }
    if constexpr (kOn.has(Effect::kSpecular))
      batch.throughput[path] = batch.throughput[path] * batch.scatter_weight[place];
    batch.active[count] = path;  // a place that has been read: the queue only moves up
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
    count = move_on<kOn>(frame, batch);
  } else if constexpr (kOn.has(Effect::kDomeLight)) {
    add_dome<kOn>(frame, batch);
  }
  batch.active.resize(count);
  batch.rays.resize(count);
}

}  // namespace

PathStage choose_scatter(EffectSet effects) {
  return special_variant_for<Effect::kDomeLight, Effect::kAreaLights, Effect::kIndirectLight>(
      effects, []<EffectSet kOn>() -> PathStage {
        return kOn.without(Effect::kSpecular).without(kSpecialLobes) == kPlain ? no_stage
                                                                               : scatter_where_read<kOn>;
      });
}

PathStage choose_go_on(EffectSet effects) {
  return variant_for<Effect::kDomeLight, Effect::kIndirectLight, Effect::kOpacity, Effect::kSpecular,
                     Effect::kTextures>(effects, []<EffectSet kOn>() -> PathStage { return go_on<kOn>; });
}

}  // namespace msbvh
