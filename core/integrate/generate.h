// Stage 1: rays from the camera, for some samples of every pixel of a tile.
#pragma once

#include "core/integrate/frame.h"
#include "core/integrate/stages.h"
#include "core/plan/effect_plan.h"

namespace msbvh {

// A Generate fills the batch: samples.count * tile.pixels() paths, all under way.
// Without any code for a lens, or for a camera that moves, where `effects` has none, and for filters and
// shutters where nothing is `shaped` by them.
Generate choose_generate(EffectSet effects, Sampling sampling, bool shaped);

}  // namespace msbvh
