#include "core/integrate/stages.h"

#include "core/bvh/bvh.h"
#include "core/integrate/accumulate.h"
#include "core/integrate/aovs.h"
#include "core/integrate/direct.h"
#include "core/integrate/generate.h"
#include "core/integrate/light_parts.h"
#include "core/integrate/looks.h"
#include "core/integrate/opacity.h"
#include "core/integrate/scatter.h"
#include "core/integrate/surface.h"
#include "core/plan/known_effects.h"

namespace msbvh {
namespace {

void accumulate_none(PathBatch&, std::uint32_t, std::uint32_t, AovSums&) {}
void leave_light(PathBatch&, LightPath) {}

template <Effect kEffect>
PathStage stage_of(EffectSet effects, PathStage stage) {
  return kKnownEffects.has(kEffect) && effects.has(kEffect) ? stage : no_stage;
}

// Whether all that can be hit is still triangles, without instances.
bool is_plain(EffectSet effects, const Bvh& world) {
  constexpr EffectSet kOthers = EffectSet{}
                                    .with(Effect::kDeformingKeys)
                                    .with(Effect::kInstances)
                                    .with(Effect::kPolynomialMotion)
                                    .with(Effect::kTimeRemaps)
                                    .with(Effect::kCurves)
                                    .with(Effect::kPoints)
                                    .with(Effect::kDisplacement);
  return (effects.bits & kOthers.bits) == 0 && world.movement == Movement::kStill &&
         world.slice_roots.empty() && kTrianglesAlone.with(LeafKind::kCompactTree).contains(world.leaf_kinds);
}

}  // namespace

void no_stage(const Frame&, PathBatch&) {}

Stages choose_stages(EffectSet effects, Sampling sampling, const Bvh& world, const FilmSettings& film,
                     const AovSet& asked) {
  const bool aovs = kKnownEffects.has(Effect::kAovs) && effects.has(Effect::kAovs);
  return {
      .generate = choose_generate(effects, sampling, film.shapes_samples()),
      .begin_looks = stage_of<Effect::kTextures>(effects, begin_cones),
      .see_through = choose_see_through(effects),
      .find_surfaces = choose_surfaces(effects, is_plain(effects, world)),
      .begin_aovs = aovs && (asked.light() || asked.cost()) ? begin_aovs : no_stage,
      .record_aovs = stage_of<Effect::kAovs>(effects, record_aovs),
      .sort_light = aovs && asked.light() ? sort_light : leave_light,
      .scatter = choose_scatter(effects),
      .add_direct = choose_direct(effects),
      .go_on = choose_go_on(effects),
      .accumulate = aovs ? accumulate_aovs : accumulate_none,
  };
}

}  // namespace msbvh
