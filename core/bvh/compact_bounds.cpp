#include "core/bvh/compact_bounds.h"

#include <algorithm>
#include <cmath>

namespace msbvh {
namespace {

constexpr std::uint16_t kMost = 0xffff;

// Where x lies in units of the axis's scale, to within one unit.
double units(const NodeFrame& frame, int axis, float x) {
  return (double(x) - double(frame.origin[axis])) / double(frame.scale(axis));
}
std::uint16_t clamped(double q) { return static_cast<std::uint16_t>(std::clamp(q, 0.0, double(kMost))); }

// The highest plane that is not above x.
std::uint16_t below(const NodeFrame& frame, int axis, float x) {
  std::uint16_t q = clamped(std::floor(units(frame, axis, x)));
  while (q > 0 && frame.plane(axis, q) > x) --q;
  if (q < kMost && frame.plane(axis, static_cast<std::uint16_t>(q + 1)) <= x) ++q;
  return q;
}
// The lowest plane that is not below x.
std::uint16_t above(const NodeFrame& frame, int axis, float x) {
  std::uint16_t q = clamped(std::ceil(units(frame, axis, x)));
  while (q < kMost && frame.plane(axis, q) < x) ++q;
  if (q > 0 && frame.plane(axis, static_cast<std::uint16_t>(q - 1)) >= x) --q;
  return q;
}

}  // namespace

void CompactBounds::set_box(const NodeFrame& frame, std::uint32_t child, const Box3f& box) {
  for (int a = 0; a < 3; ++a) {
    axis[a].lo[child] = below(frame, a, box.lo[a]);
    axis[a].hi[child] = above(frame, a, box.hi[a]);
  }
}

void CompactBounds::set_absent(std::uint32_t child) {
  for (Axis& a : axis) {
    a.lo[child] = kMost;
    a.hi[child] = 0;
  }
}

NodeFrame frame_around(std::span<const Box3f> boxes) {
  Box3f all;
  for (const Box3f& box : boxes) all.grow(box);
  NodeFrame frame{};
  for (int a = 0; a < 3; ++a) {
    frame.origin[a] = all.lo[a];
    const double extent = double(all.hi[a]) - double(all.lo[a]);
    // The least that may do: 2^16 units must reach across.
    const int least = extent > 0.0 ? std::ilogb(extent) - 17 + 127 : 1;
    frame.exponent[a] = static_cast<std::uint8_t>(std::clamp(least, 1, 254));
    while (frame.plane(a, kMost) < all.hi[a]) ++frame.exponent[a];
  }
  return frame;
}

void round_outwards(std::span<Box3f> boxes) {
  const NodeFrame frame = frame_around(boxes);
  CompactBounds rounded{};
  for (Box3f& box : boxes) {
    rounded.set_box(frame, 0, box);
    box = rounded.box(frame, 0);
  }
}

}  // namespace msbvh
