// Stage 1: rays from the camera, for some samples of every pixel of a tile.
#pragma once

#include <cstdint>

#include "core/film/sum_tree.h"
#include "core/film/tile.h"
#include "core/integrate/frame.h"
#include "core/integrate/path_batch.h"
#include "core/plan/effect_plan.h"

namespace msbvh {

// Fills the batch: samples.count * tile.pixels() paths, all under way.
using Generate = void (*)(const Frame& frame, const Tile& tile, SampleRange samples, PathBatch& batch);

// Without any code for a lens where `effects` has none.
Generate choose_generate(EffectSet effects, Sampling sampling);

}  // namespace msbvh
