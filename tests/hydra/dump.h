// What a host has handed over: a line for each value of each prim that a renderer of motion reads.
#pragma once

#include <iosfwd>
#include <pxr/imaging/hd/sceneIndex.h>

namespace msbvh::testing {

// `PRIM TYPE LOCATOR: times [...]: value at the opening | at the frame | at the closing`, sorted by prim and
// locator; times in frames from the frame, those that the host names for [open, close]; long arrays by their
// count and first elements.
void dump(const PXR_NS::HdSceneIndexBase& scene, float open_frames, float close_frames, std::ostream& out);

}  // namespace msbvh::testing
