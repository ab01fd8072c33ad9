#include "core/integrate/trace_paths.h"

#include "core/integrate/aovs.h"
#include "core/integrate/closest.h"
#include "core/integrate/direct.h"
#include "core/integrate/opacity.h"
#include "core/integrate/scatter.h"
#include "core/integrate/surface.h"

namespace msbvh {
namespace {

// Whether anything reads where the paths go on to.
bool scatters(const Frame& frame, EffectSet effects, const PathBatch& batch) {
  return !is_last_vertex(frame, effects, batch) || frame.lights.has_dome() ||
         effects.has(Effect::kAreaLights);
}

}  // namespace

void meet_surfaces(const Frame& frame, EffectSet effects, PathBatch& batch) {
  find_closest(frame, batch);
  if (effects.has(Effect::kOpacity)) see_through(frame, batch);
  find_surfaces(frame, batch);
}

void light_surfaces(const Frame& frame, EffectSet effects, PathBatch& batch) {
  if (batch.depth == 0 && effects.has(Effect::kAovs)) record_aovs(frame, batch);
  if (scatters(frame, effects, batch)) scatter(batch);
  add_direct_light(frame, effects, batch);
  go_on(frame, effects, batch);
}

void trace_paths(const Frame& frame, EffectSet effects, PathBatch& batch) {
  while (!batch.active.empty()) {
    meet_surfaces(frame, effects, batch);
    light_surfaces(frame, effects, batch);
  }
}

}  // namespace msbvh
