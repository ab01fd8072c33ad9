// Stage 4: what was hit, and the light that it gives off; where nothing was, the light behind the scene.
#pragma once

#include "core/integrate/frame.h"
#include "core/integrate/path_batch.h"

namespace msbvh {

// Fills batch.surfaces and batch.shaded. Paths that met nothing, or that reflect nothing, end here.
void find_surfaces(const Frame& frame, PathBatch& batch);

}  // namespace msbvh
