#include "core/integrate/closest.h"

namespace msbvh {

void find_closest(const Frame& frame, PathBatch& batch) {
  batch.mark.enter(Stage::kClosest, batch.depth, true);
  frame.tracer.intersect(batch.rays, batch.hits.data(), batch.traced);
}

}  // namespace msbvh
