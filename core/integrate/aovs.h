// Where AOVs are asked for: what the camera's rays saw.
#pragma once

#include "core/integrate/frame.h"
#include "core/integrate/path_batch.h"

namespace msbvh {

// Before the first rays are traced, where light is sorted by its way, or rays' costs are counted: those of
// camera rays, each traced by itself.
void begin_aovs(const Frame& frame, PathBatch& batch);

// After find_surfaces() of the first vertex.
void record_aovs(const Frame& frame, PathBatch& batch);

// `hit` of a ray from the camera at the surface.
AovSample aov_sample(const Frame& frame, const Hit& hit, const SurfaceHit& surface, float time);

}  // namespace msbvh
