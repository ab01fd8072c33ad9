// Before a frame with many lights is drawn: which of them are seen from where.
#pragma once

#include "core/integrate/frame.h"

namespace msbvh {

// Rays from the camera, and from where they lead, ask some lights each. The same rays for any seed, number of
// samples and of threads. Nothing where there are few lights.
void learn_lights(Frame& frame);

}  // namespace msbvh
