#include "core/integrate/closest.h"

namespace msbvh {

void find_closest(const Frame& frame, PathBatch& batch) {
  frame.tracer.intersect(batch.rays, batch.hits.data(), batch.traced);
}

}  // namespace msbvh
