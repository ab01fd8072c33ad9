// Stage 5: the directions in which paths go on; and stage 7: to go there.
#pragma once

#include "core/integrate/frame.h"
#include "core/integrate/stages.h"

namespace msbvh {

// Draws a direction for each path that is on a surface, where anything reads it.
PathStage choose_scatter(EffectSet effects);

// Leaves under way the paths that go on, on their new rays. After the last vertex none does: the rays only
// ask whether the dome is seen.
PathStage choose_go_on(EffectSet effects);

}  // namespace msbvh
