// References to pieces of curves and to points.
#pragma once

#include <vector>

#include "core/build/reference.h"

namespace msbvh {

// All that have some width. Spans are cut to halves, quarters or eighths where that makes their boxes
// smaller by enough; not where the builder takes no partial primitives (Primitives::whole_spans).
std::vector<Reference> round_references(const Primitives& primitives);

}  // namespace msbvh
