// What a scene calls for, and why. "Simulate only the effects that a scene calls for": whatever is not in the
// set costs no instruction in the inner loop, no bytes in the nodes, and does not change the noise of the
// rest.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/plan/effect_set.h"
#include "core/scene/scene.h"

namespace msbvh {

struct Reason {
  Effect effect;
  std::string prim;  // the first prim that asks for the effect; empty where a setting does
  std::string why;   // one phrase, e.g. "4 segments"
};

struct EffectPlan {
  EffectSet set;
  std::vector<Reason> why;  // one for each effect in the set, in the order of the enum
};

struct PlanSettings {
  std::uint32_t max_bounces = 1;  // 0: direct light only
  std::string aovs{};             // names of those that are asked for
  bool refraction = false;        // what is transparent bends light
};

const char* effect_name(Effect effect);  // "deforming keys", "moving instances", ...

// Pure: the same scene and settings give the same plan.
EffectPlan plan_effects(const Scene& scene, const PlanSettings& settings);

// Throws Error for the first effect that is on and not among `known`, those that the build has code for
// (core/plan/known_effects.h): its prim, and why it is on.
void expect_known(const EffectPlan& plan, EffectSet known);

// All that ask, not just the first: each prim once an effect, in the order of the enum, then of the scene.
// For people: reads the opacity of every prim, which plan_effects does until it finds one.
std::vector<Reason> all_reasons(const Scene& scene, const PlanSettings& settings);

}  // namespace msbvh
