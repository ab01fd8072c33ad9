// Parts of a triangle in barycentric coordinates, cut by planes without a rounding. A corner is never
// computed: it is where two lines cross, and on which side of a third one it lies is the sign of a
// determinant of what was given (tests/support/exact.h).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/base/box.h"
#include "core/base/vec.h"
#include "tests/support/exact.h"

namespace msbvh::stability {

using Corners = std::array<Vec3f, 3>;

// Its positive side is where a b0 + b b1 + c b2 > 0 for the barycentrics b.
using Line = test::Row;

// Where a triangle's points lie above, or below, a plane across an axis: those that a box's side keeps.
Line above_plane(const Corners& triangle, int axis, float plane);
Line below_plane(const Corners& triangle, int axis, float plane);
// The six sides of a box.
std::array<Line, 6> sides_of(const Corners& triangle, const Box3f& box);

// Convex, with an area (in barycentrics, where every triangle has one), or empty.
class TrianglePart {
 public:
  static TrianglePart whole();

  bool empty() const { return edges_.empty(); }
  std::size_t corners() const { return edges_.size(); }
  // Of a corner: 1 on the line's positive side, 0 on the line, else -1.
  int side(std::size_t corner, const Line& line) const;
  // What is on the line's positive side; empty where that has no area.
  TrianglePart cut(const Line& line) const;

 private:
  std::vector<Line> edges_;  // in order; corner i is where edges i - 1 and i meet
};

// Whether each point of the triangle lies in one of the boxes. What they leave out is open: where it has no
// area, there is nothing.
bool covers(std::span<const Box3f> boxes, const Corners& triangle);

}  // namespace msbvh::stability
