// The shutter kept in equal slices: each sample's light goes to the slice that its time lies in.
#pragma once

#include <cstdint>

#include "core/film/sum_tree.h"
#include "core/integrate/path_batch.h"

namespace msbvh {

// Behind generate(): remembers the slice of each path, of `slices`.
void begin_slices(std::uint32_t slices, PathBatch& batch);

// Behind accumulate(): the batch's samples to [pixel][slice] of `sums`, in the order of their numbers. Each
// of these counts all of the pixel's samples, so that a pixel's slices sum up to it.
void accumulate_slices(const PathBatch& batch, std::uint32_t pixels, std::uint32_t slices,
                       SumTrees<FilmSum>& sums);

}  // namespace msbvh
