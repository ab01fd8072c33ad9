// Traces the shadow rays that wait and adds the light of those that nothing stops.
#pragma once

#include "core/integrate/frame.h"
#include "core/integrate/path_batch.h"
#include "core/plan/effect_variant.h"

namespace msbvh {

// Where all is opaque one question a ray; where not, what a ray passes dims it. No path may wait for two rays
// at once.
// kOn: of kOpacity, and of kTextures where something is textured or reflects.
template <EffectSet kOn>
void trace_shadows(const Frame& frame, PathBatch& batch);

// Those of a stage's effects that change how shadow rays are traced.
constexpr EffectSet shadow_effects(EffectSet on) {
  EffectSet shadow;
  if (on.has(Effect::kOpacity)) shadow = shadow.with(Effect::kOpacity);
  if (on.has(Effect::kTextures) || on.has(Effect::kSpecular)) shadow = shadow.with(Effect::kTextures);
  return shadow;
}

}  // namespace msbvh
