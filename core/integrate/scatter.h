// Stage 5: the directions in which paths go on; and stage 7: to go there.
#pragma once

#include "core/integrate/frame.h"
#include "core/integrate/path_batch.h"
#include "core/plan/effect_plan.h"

namespace msbvh {

// Whether this vertex is the last one of its path.
bool is_last_vertex(const Frame& frame, EffectSet effects, const PathBatch& batch);

// Draws a direction for each path that is on a surface.
void scatter(PathBatch& batch);

// Leaves under way the paths that go on, on their new rays. After the last vertex none does: the rays only
// ask whether the dome is seen.
void go_on(const Frame& frame, EffectSet effects, PathBatch& batch);

}  // namespace msbvh
