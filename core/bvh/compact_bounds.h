// The boxes of a node's children in 16 bits a plane: BuildSettings::layout. docs/design/compact.md.
//
// A plane is origin + q * 2^exponent of its axis, q an integer of 16 bits. q * 2^exponent is exact, so that
// the sum has one rounding, with a fused multiply-add and without: every decoder finds the same float. Planes
// are rounded outwards, and decoded before they are interpolated: what holds for boxes of floats at two keys
// holds for these in between.
#pragma once

#include <bit>
#include <cstdint>
#include <span>

#include "core/base/box.h"

namespace msbvh {

// Of all planes of a node, at all of its controls.
struct NodeFrame {
  float origin[3];
  std::uint8_t exponent[3];  // as in a float: 127 is 2^0

  float scale(int axis) const { return std::bit_cast<float>(std::uint32_t(exponent[axis]) << 23); }
  float plane(int axis, std::uint16_t q) const { return origin[axis] + static_cast<float>(q) * scale(axis); }
};

// The boxes of 8 children at one control. An absent child's are inside out; its bit is masked out of a test.
struct CompactBounds {
  struct Axis {
    std::uint16_t lo[8], hi[8];
  };
  Axis axis[3];

  Box3f box(const NodeFrame& frame, std::uint32_t child) const {
    Box3f box;
    for (int a = 0; a < 3; ++a) {
      box.lo[a] = frame.plane(a, axis[a].lo[child]);
      box.hi[a] = frame.plane(a, axis[a].hi[child]);
    }
    return box;
  }
  // The smallest box of this frame around `box`, which lies in what the frame is around.
  void set_box(const NodeFrame& frame, std::uint32_t child, const Box3f& box);
  void set_absent(std::uint32_t child);
};
static_assert(sizeof(CompactBounds) == 96);

// The finest frame around boxes, none of them empty. It is that of the same boxes rounded outwards in it.
NodeFrame frame_around(std::span<const Box3f> boxes);

// Each box, rounded outwards to planes of their common frame.
void round_outwards(std::span<Box3f> boxes);

}  // namespace msbvh
