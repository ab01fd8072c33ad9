// From the binary topology to 8-wide nodes with boxes at every key, bottom-up.
#pragma once

#include "core/build/topology.h"
#include "core/bvh/bvh.h"

namespace msbvh {

// Fills arena, root, root_bounds, max_level and the statistics' counts of `out`. Reorders the references
// within leaves of `topology`. The same bytes for any number of threads. Throws Cancelled when asked to stop.
void flatten(const Primitives& primitives, Topology& topology, const BuildSettings& settings, Bvh& out);

}  // namespace msbvh
