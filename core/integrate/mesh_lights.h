// Stage 6, where meshes shine: light that scattered rays meet. And stage 4: what they show of it themselves.
#pragma once

#include "core/integrate/frame.h"
#include "core/integrate/path_batch.h"

namespace msbvh {

// From each surface along its scattered ray, to all mesh lights that it meets. Shares their light with the
// samples of them by multiple importance sampling. The ray's own surface is found anew where the path goes
// on. `transparent`: what it meets before them may be; `specular`: surfaces reflect by lobes.
void add_met_meshes(const Frame& frame, PathBatch& batch, bool transparent, bool specular);

// Behind the first surface, what the material of a mesh light gives off: rays have found it as a light.
void hide_met_meshes(const Frame& frame, PathBatch& batch);

}  // namespace msbvh
