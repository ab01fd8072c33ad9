// A shape whose held values change within the shutter, as shapes that are each visible for a part of it.
#pragma once

#include <deque>
#include <vector>

#include "delegate/translate/diagnostics.h"
#include "delegate/translate/frame/frame_input.h"

namespace msbvh::translate {

struct ShapeParts {
  std::vector<FrameShape> shapes;  // borrow from the whole, and from what follows
  std::deque<std::vector<Vec3f>> colors{};
  std::deque<std::vector<float>> opacities{};
};

// Whether anything of a shape is held and may change within the shutter.
bool holds_values(const FrameShape& shape);

// One part for each set of values. What changes too often, and what changes together with the topology, stays
// as at the frame, with a warning. What does not change within the shutter is taken from its opening: the
// frame may lie outside of it.
ShapeParts parts_of(const FrameShape& shape, PrimLog& log);

}  // namespace msbvh::translate
