// The stages between a batch's camera rays and its sums.
#pragma once

#include "core/integrate/frame.h"
#include "core/integrate/path_batch.h"

namespace msbvh {

// Stages 2 to 4: what the rays under way meet. Traces them alone, and on through what is seen through.
void meet_surfaces(const Frame& frame, PathBatch& batch);
// Stages 5 to 7: the light there, and where paths go on. Traces shadow rays alone.
void light_surfaces(const Frame& frame, PathBatch& batch);

// Both, until no path is under way.
void trace_paths(const Frame& frame, PathBatch& batch);

}  // namespace msbvh
