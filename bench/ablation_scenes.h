// A base scene of still triangles under one light, and the same with effects that it must then be rendered
// with.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/film/aov.h"
#include "core/plan/effect_set.h"
#include "core/scene/scene.h"

namespace msbvh::bench {

// As it is to be rendered.
struct CallingScene {
  std::shared_ptr<const Scene> scene;
  std::uint32_t max_bounces = 0;
  bool refraction = false;
  std::vector<Aov> aovs;
};

// Effects that a scene with `effect` has too, at the least: instances move only where there are instances.
EffectSet needed_by(Effect effect);

// Calls for `effects` and for no others. About so many triangles; some effects add geometry. Throws Error
// where the plan says otherwise, as for effects without those that they need.
CallingScene scene_calling_for(EffectSet effects, std::uint32_t triangles);

}  // namespace msbvh::bench
