// Stage 7: what the paths found, to their pixels.
#pragma once

#include <cstdint>

#include "core/film/sum_tree.h"
#include "core/integrate/path_batch.h"

namespace msbvh {

// The batch's samples of each of a tile's pixels, in the order of their numbers whatever order they were
// traced in.
void accumulate(PathBatch& batch, std::uint32_t pixels, SumTrees<FilmSum>& sums);
// Likewise of AOVs, after it. `first`: number of the batch's first sample.
void accumulate_aovs(PathBatch& batch, std::uint32_t pixels, std::uint32_t first, AovSums& sums);

}  // namespace msbvh
