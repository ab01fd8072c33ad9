// Stage 6: the next ray of every path.
#pragma once

#include "core/integrate/frame.h"
#include "core/integrate/path_batch.h"
#include "core/plan/effect_plan.h"

namespace msbvh {

// Leaves the paths under way that go on. After the last bounce none does: their rays only ask whether the
// dome is seen.
void scatter(const Frame& frame, EffectSet effects, PathBatch& batch);

}  // namespace msbvh
