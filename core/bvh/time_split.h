// A tree for each segment of the finest track, and the one that a ray descends chosen by its time: what
// renderers do that know linear boxes between two keys only. For comparison (Builder::kTimeSplit).
#pragma once

#include <span>

#include "core/build/settings.h"
#include "core/bvh/bvh.h"
#include "core/bvh/rebraid.h"

namespace msbvh {

// Of what the tree is built over; 0 where nothing moves.
std::uint32_t finest_segments(const Bvh& bvh, std::span<const InstanceBounds> instances);

// Fills what flatten() does of `bvh`, and its slice_roots; the SAH cost is the mean over the slices. Returns
// the number of references. Topologies are chosen at the slices' middles, boxes are linear (or Bezier) within
// each, leaves read the vertex tracks that all trees share.
std::uint64_t build_time_split(Bvh& bvh, const InstanceParts& instances, std::uint32_t slices,
                               const BuildSettings& settings);

}  // namespace msbvh
