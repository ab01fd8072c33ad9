#include "tests/stability/exact_parts.h"

#include <algorithm>
#include <utility>

namespace msbvh::stability {
namespace {

Line opposite(const Line& line) {
  Line out = line;
  for (test::TwoDoubles& entry : out) entry = {-entry.hi, -entry.lo};
  return out;
}

}  // namespace

Line above_plane(const Corners& triangle, int axis, float plane) {
  return {test::difference(triangle[0][axis], plane), test::difference(triangle[1][axis], plane),
          test::difference(triangle[2][axis], plane)};
}

Line below_plane(const Corners& triangle, int axis, float plane) {
  return opposite(above_plane(triangle, axis, plane));
}

std::array<Line, 6> sides_of(const Corners& triangle, const Box3f& box) {
  std::array<Line, 6> sides;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int a = static_cast<int>(axis);
    sides[2 * axis] = above_plane(triangle, a, box.lo[a]);
    sides[2 * axis + 1] = below_plane(triangle, a, box.hi[a]);
  }
  return sides;
}

TrianglePart TrianglePart::whole() {
  TrianglePart part;
  for (std::size_t i = 0; i < 3; ++i) {
    Line edge{};
    edge[i].hi = 1.0;
    part.edges_.push_back(edge);
  }
  return part;
}

int TrianglePart::side(std::size_t corner, const Line& line) const {
  const Line &before = edges_[(corner + edges_.size() - 1) % edges_.size()], &after = edges_[corner];
  // The corner is the cross product of both, up to its length and its sign: barycentrics sum to 1.
  return test::sign_of_determinant(before, after, line) *
         test::sign_of_determinant(before, after, test::kOnes);
}

TrianglePart TrianglePart::cut(const Line& line) const {
  const std::size_t n = edges_.size();
  std::vector<int> sides(n);
  for (std::size_t i = 0; i < n; ++i) sides[i] = side(i, line);
  if (std::ranges::none_of(sides, [](int s) { return s < 0; })) return *this;
  TrianglePart part;
  for (std::size_t i = 0; i < n; ++i) {
    const int begin = sides[i], end = sides[(i + 1) % n];
    if (begin > 0 || end > 0) part.edges_.push_back(edges_[i]);
    if (begin > 0 && end <= 0) part.edges_.push_back(line);  // once: it is convex
  }
  return part;
}

bool covers(std::span<const Box3f> boxes, const Corners& triangle) {
  const auto holds_all = [&](const Box3f& box) {
    return box.contains(triangle[0]) && box.contains(triangle[1]) && box.contains(triangle[2]);
  };
  if (std::ranges::any_of(boxes, holds_all)) return true;
  std::vector<TrianglePart> left{TrianglePart::whole()}, next;
  for (const Box3f& box : boxes) {
    const std::array<Line, 6> sides = sides_of(triangle, box);
    next.clear();
    for (TrianglePart part : left) {
      for (const Line& side : sides) {
        TrianglePart outside = part.cut(opposite(side));
        if (!outside.empty()) next.push_back(std::move(outside));
        part = part.cut(side);
        if (part.empty()) break;
      }
    }
    left.swap(next);
  }
  return left.empty();
}

}  // namespace msbvh::stability
