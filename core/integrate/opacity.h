// Stage 3, where something is not opaque: by chance a surface is seen or seen through.
#pragma once

#include "core/integrate/frame.h"
#include "core/integrate/path_batch.h"
#include "core/integrate/stages.h"

namespace msbvh {

// The stage's rays that see through what they hit are traced on from there, until all have met what they see,
// or nothing.
PathStage choose_see_through(EffectSet effects);

// The same ray cannot find the same triangle at the same distance again.
void step_past(const Hit& hit, Ray& ray);

}  // namespace msbvh
