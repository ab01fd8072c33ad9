// What a scene calls for, and why. "Simulate only the effects that a scene calls for": whatever is not in the
// set costs no instruction in the inner loop, no bytes in the nodes, and does not change the noise of the
// rest.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/scene/scene.h"

namespace msbvh {

enum class Effect : std::uint32_t {
  kDeformingKeys = 1u << 0,    // a geometry has more than one key
  kInstances = 1u << 1,        // a two-level hierarchy is needed
  kMovingInstances = 1u << 2,  // an instance has more than one key
  kCameraMotion = 1u << 3,
  kMovingLights = 1u << 4,
  kOpacity = 1u << 5,  // some surface lets light through
  kAreaLights = 1u << 6,
  kDomeLight = 1u << 7,
  kIndirectLight = 1u << 8,
  kLens = 1u << 9,               // depth of field
  kPolynomialMotion = 1u << 10,  // a geometry or an instance moves on curves of degree 2 or 3
  kTimeRemaps = 1u << 11,        // breakpoints, jumps or visibility at times between even keys
  kAovs = 1u << 12,              // more than colour and alpha is asked for
  kCurves = 1u << 13,            // leaves of their own
  kPoints = 1u << 14,            // likewise
  kDisplacement = 1u << 15,      // of surfaces along their normals
  kSubdivision = 1u << 16        // a cage's limit surface is drawn, as triangles
};

constexpr std::size_t kEffectCount = 17;
constexpr Effect effect_at(std::size_t index) { return static_cast<Effect>(1u << index); }

// A set of effects; usable as a template argument.
struct EffectSet {
  std::uint32_t bits = 0;
  constexpr bool has(Effect e) const { return (bits & static_cast<std::uint32_t>(e)) != 0; }
  constexpr EffectSet with(Effect e) const { return {bits | static_cast<std::uint32_t>(e)}; }
  constexpr EffectSet without(Effect e) const { return {bits & ~static_cast<std::uint32_t>(e)}; }
  constexpr bool operator==(const EffectSet&) const = default;
};

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
};

const char* effect_name(Effect effect);  // "deforming keys", "moving instances", ...

// Pure: the same scene and settings give the same plan.
EffectPlan plan_effects(const Scene& scene, const PlanSettings& settings);

// All that ask, not just the first: each prim once an effect, in the order of the enum, then of the scene.
// For people: reads the opacity of every prim, which plan_effects does until it finds one.
std::vector<Reason> all_reasons(const Scene& scene, const PlanSettings& settings);

}  // namespace msbvh
