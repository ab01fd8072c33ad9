// Stages that have code for glass and fibres (core/shade/bsdf/special_lobe.h), compiled beside the others.
#pragma once

#include "core/plan/effect_variant.h"
#include "core/shade/bsdf/special_lobe.h"
#include "core/shade/surface_hit.h"

namespace msbvh {

// That of the two stands for both: one variant for either, with specular lobes.
inline constexpr Effect kSpecialLobes = Effect::kRefraction;

// As variant_for<kEffects..., kSpecular>; where something is of glass or a fibre, make.operator()<kOn>() with
// kSpecular and kSpecialLobes on as well.
template <Effect... kEffects, typename Make>
auto special_variant_for(EffectSet on, const Make& make) {
  if constexpr (kKnownEffects.has(Effect::kSpecular) &&
                (kKnownEffects.has(Effect::kRefraction) || kKnownEffects.has(Effect::kFibre))) {
    if (on.has(Effect::kRefraction) || on.has(Effect::kFibre)) {
      return variant_for<kEffects...>(on, [&]<EffectSet kOn>() {
        return make.template operator()<kOn.with(Effect::kSpecular).with(kSpecialLobes)>();
      });
    }
  }
  return variant_for<kEffects..., Effect::kSpecular>(on, make);
}

// Whether light may take a direction from the surface, by both of its normals.
inline bool leads_on(const SpecialLobe& special, const SurfaceHit& surface, const Vec3f& direction) {
  if (!is_special(special)) return dot(direction, surface.geometric_normal) > 0.0f;
  return takes_light(special, dot(direction, surface.shading_normal),
                     dot(direction, surface.geometric_normal));
}

}  // namespace msbvh
