// Stage 4: what was hit, and the light that it gives off; where nothing was, the light behind the scene.
#pragma once

#include "core/integrate/frame.h"
#include "core/integrate/stages.h"

namespace msbvh {

// The stage fills batch.surfaces and batch.shaded. Paths that met nothing, or that reflect nothing, end
// there. `plain_geometry`: all that can be hit is still triangles, without instances.
PathStage choose_surfaces(EffectSet effects, bool plain_geometry);

}  // namespace msbvh
