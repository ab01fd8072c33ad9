// Stage 2: the closest hit of every ray under way.
#pragma once

#include "core/integrate/frame.h"
#include "core/integrate/path_batch.h"

namespace msbvh {

void find_closest(const Frame& frame, PathBatch& batch);

}  // namespace msbvh
