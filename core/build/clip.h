// Sutherland-Hodgman clipping of triangles to boxes, in barycentric coordinates: a partial primitive as the
// paper has it (section 3.2). I. Sutherland, G. Hodgman, "Reentrant Polygon Clipping", CACM 17(1), 1974.
#pragma once

#include <array>

#include "core/base/box.h"
#include "core/base/lerp.h"
#include "core/base/vec.h"

namespace msbvh {

// A convex polygon on a triangle: corner = b[0] * v0 + b[1] * v1 + b[2] * v2, for the triangle's vertices at
// any time.
struct BarycentricPolygon {
  // A convex polygon has at most 9: 3, and one more for each of a box's 6 planes. The rest is room for
  // corners so close to a plane that rounding makes the outline cross it more than twice.
  static constexpr int kMaxCorners = 16;
  std::array<Vec3d, kMaxCorners> corners;
  int count = 0;
};

// The part of the triangle inside `box`. The box is grown by the error of this computation (kClipError below)
// first, so that fragments on both sides of a split overlap by a hair rather than part by one, at every time,
// also where the triangle is next to degenerate at the centre and large at other times, or in the frames that
// a refit moves it to: what parts and overlaps are barycentric coordinates, which no pose changes. (Across an
// extent D the error moves a cut by error / D of the edge, and the hair is wider by the same factor. Where D
// is within the hair, no cut is left.) Empty (count 0) if nothing is inside.
BarycentricPolygon clip_to_box(const std::array<Vec3d, 3>& triangle, const Box3f& box);

// Relative to the triangle's largest coordinate. A plane's distance is a sum of three products in double
// (error below 4 * 2^-53); 2^-46 leaves room for six planes, one after the other.
inline constexpr double kClipError = 0x1p-46;

// Tight boxes, in single precision rounded outwards, of the part of the triangle inside `box` on either side
// of a plane: axis coordinate <= plane (below) or >= plane. Empty if nothing is.
struct CutBounds {
  Box3f below, above;
};
CutBounds cut_bounds(const std::array<Vec3d, 3>& triangle, const Box3f& box, int axis, float plane);

// The floats next to a double, below and above (or equal to) it.
float round_down(double value);
float round_up(double value);
Box3f round_outwards(const Box3d& box);

}  // namespace msbvh
