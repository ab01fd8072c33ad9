// Traces the shadow rays that wait and adds the light of those that nothing stops.
#pragma once

#include "core/integrate/frame.h"
#include "core/integrate/path_batch.h"

namespace msbvh {

// Where all is opaque one question a ray; where not, what a ray passes dims it. No path may wait for two rays
// at once.
template <bool kOpacity>
void trace_shadows(const Frame& frame, PathBatch& batch);

}  // namespace msbvh
