#include "core/integrate/trace_paths.h"

#include "core/integrate/closest.h"

namespace msbvh {

void meet_surfaces(const Frame& frame, PathBatch& batch) {
  if (batch.depth == 0) frame.stages.begin_looks(frame, batch);
  find_closest(frame, batch);
  frame.stages.see_through(frame, batch);
  frame.stages.find_surfaces(frame, batch);
}

void light_surfaces(const Frame& frame, PathBatch& batch) {
  if (batch.depth == 0) frame.stages.record_aovs(frame, batch);
  frame.stages.scatter(frame, batch);
  frame.stages.add_direct(frame, batch);
  frame.stages.go_on(frame, batch);
}

void trace_paths(const Frame& frame, PathBatch& batch) {
  while (!batch.active.empty()) {
    meet_surfaces(frame, batch);
    light_surfaces(frame, batch);
  }
}

}  // namespace msbvh
