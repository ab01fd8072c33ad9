// Where AOVs are asked for: what the camera's rays saw.
#pragma once

#include "core/integrate/frame.h"
#include "core/integrate/path_batch.h"

namespace msbvh {

// After find_surfaces() of the first vertex.
void record_aovs(const Frame& frame, PathBatch& batch);

// `hit` of a ray from the camera at the surface.
AovSample aov_sample(const Frame& frame, const Hit& hit, const SurfaceHit& surface, float time);

}  // namespace msbvh
