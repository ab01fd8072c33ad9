// Stage 6: light that comes straight from the lights that have a place or a direction.
#pragma once

#include "core/integrate/frame.h"
#include "core/integrate/path_batch.h"
#include "core/plan/effect_plan.h"

namespace msbvh {

// From each surface a shadow ray to each light that it picks; where the scattered ray meets that light,
// another one. The two share the light by multiple importance sampling.
PathStage choose_direct(EffectSet effects);

}  // namespace msbvh
