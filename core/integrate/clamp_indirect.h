// Paths whose indirect light is cut off at a most, against single bright pixels: an option that makes
// pictures darker than they are.
#pragma once

#include "core/integrate/frame.h"
#include "core/integrate/path_batch.h"

namespace msbvh {

// trace_paths(), after which no path has more indirect light (core/film/aov_sums.h: neither emission nor
// direct) than frame.clamp_indirect in its largest channel; its hue stays.
void trace_clamped(const Frame& frame, PathBatch& batch);

}  // namespace msbvh
