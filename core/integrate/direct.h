// Stage 5: light that comes straight from the lights that have a place or a direction.
#pragma once

#include "core/integrate/frame.h"
#include "core/integrate/path_batch.h"
#include "core/plan/effect_plan.h"

namespace msbvh {

// A shadow ray from each surface to each light, a light at a time.
void add_direct_light(const Frame& frame, EffectSet effects, PathBatch& batch);

}  // namespace msbvh
