// The stages of a frame's paths, chosen once by the effects that are on: a stage that is off does nothing,
// and one that is on has no code for effects that are off.
#pragma once

#include <cstdint>

#include "core/film/film_settings.h"
#include "core/film/sum_tree.h"
#include "core/film/tile.h"
#include "core/integrate/path_batch.h"
#include "core/integrate/sampler.h"
#include "core/plan/effect_set.h"

namespace msbvh {

class Bvh;
struct Frame;

using Generate = void (*)(const Frame& frame, const Tile& tile, SampleRange samples, PathBatch& batch);
using PathStage = void (*)(const Frame& frame, PathBatch& batch);
using SortLight = void (*)(PathBatch& batch, LightPath way);
using AccumulateAovs = void (*)(PathBatch& batch, std::uint32_t pixels, std::uint32_t first, AovSums& sums);

struct Stages {
  Generate generate;          // generate.h
  PathStage begin_looks;      // looks.h
  PathStage see_through;      // opacity.h
  PathStage find_surfaces;    // surface.h
  PathStage begin_aovs;       // aovs.h
  PathStage record_aovs;      // aovs.h
  SortLight sort_light;       // light_parts.h
  PathStage scatter;          // scatter.h
  PathStage add_direct;       // direct.h
  PathStage go_on;            // scatter.h
  AccumulateAovs accumulate;  // accumulate.h
};

// Does nothing: a stage that is off.
void no_stage(const Frame& frame, PathBatch& batch);

// `effects` are those of the scene that `world` is the tree of.
Stages choose_stages(EffectSet effects, Sampling sampling, const Bvh& world, const FilmSettings& film = {},
                     const AovSet& aovs = {});

}  // namespace msbvh
