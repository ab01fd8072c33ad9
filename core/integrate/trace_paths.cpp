#include "core/integrate/trace_paths.h"

#include "core/integrate/closest.h"

namespace msbvh {
namespace {

// Of light that left its source for the eye by so many surfaces.
LightPath way_to_emitter(std::uint32_t surfaces) {
  if (surfaces == 0) return LightPath::kEmission;
  return surfaces == 1 ? LightPath::kDirect : LightPath::kIndirect;
}

}  // namespace

void meet_surfaces(const Frame& frame, PathBatch& batch) {
  if (batch.depth == 0) frame.stages.begin_looks(frame, batch);
  find_closest(frame, batch);
  frame.stages.see_through(frame, batch);
  frame.stages.find_surfaces(frame, batch);
  frame.stages.sort_light(batch, way_to_emitter(batch.depth));
}

void light_surfaces(const Frame& frame, PathBatch& batch) {
  const LightPath way = way_to_emitter(batch.depth + 1);
  if (batch.depth == 0) frame.stages.record_aovs(frame, batch);
  frame.stages.scatter(frame, batch);
  frame.stages.add_direct(frame, batch);
  frame.stages.go_on(frame, batch);
  frame.stages.sort_light(batch, way);
}

void trace_paths(const Frame& frame, PathBatch& batch) {
  while (!batch.active.empty()) {
    meet_surfaces(frame, batch);
    light_surfaces(frame, batch);
  }
}

}  // namespace msbvh
