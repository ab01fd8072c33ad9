// One thing that a ray tested on its way.
#pragma once

#include <cstdint>

#include "core/bvh/layout.h"
#include "core/trace/ray.h"

namespace msbvh {

struct TraceVisit {
  std::uint32_t instance = kNoInstance;  // in whose object's tree; kNoInstance: the tree itself
  ChildRef at{};                         // a node of that tree, or a block of a leaf
  // What was done there: figures of TraceCounts, that add up to them.
  std::uint32_t nodes = 0, blocks = 0, primitives = 0, instances = 0;
};

}  // namespace msbvh
