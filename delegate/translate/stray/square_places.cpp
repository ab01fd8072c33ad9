#include "delegate/translate/stray/square_places.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/triangle_distance.h"

namespace msbvh::translate {
namespace {

// Of the square of its longest edge: a triangle of less area has no plane to speak of.
constexpr double kFlatShare = 1e-9;

// In the parameters of a face. Two places of a lattice lie in one of the face's squares, but for the end of
// an edge of a single segment: that is the next square's own corner.
FacePoint halfway(const FacePoint& a, const FacePoint& b, std::uint32_t own) {
  if (a.square == b.square) return {0, a.square, 0.5 * (a.s + b.s), 0.5 * (a.t + b.t)};
  const FacePoint &here = a.square == own ? a : b, &next = a.square == own ? b : a;
  // From (1, t) of this square, which is (t, 1) of the next, to (0, 0) there.
  if (here.t > 0.0) return {0, next.square, 0.5 * here.t, 0.5};
  // Along the edge: its middle is at s = 1 of this square and t = 1 of the next.
  if (here.s == 0.0) return {0, own, 1.0, 0.0};
  return {0, next.square, 0.0, 1.0 - 0.5 * here.s};
}

FacePoint middle(const FacePoint& a, const FacePoint& b, const FacePoint& c, std::uint32_t own) {
  if (a.square == own && b.square == own && c.square == own)
    return {0, own, (a.s + b.s + c.s) / 3.0, (a.t + b.t + c.t) / 3.0};
  return halfway(halfway(a, b, own), c, own);
}

double distance_to_plane(const Vec3d& point, const TriangleCorners& v) {
  const Vec3d ab = v[1] - v[0], ac = v[2] - v[0], bc = v[2] - v[1], normal = cross(ab, ac);
  const double size = length(normal), longest = std::max({dot(ab, ab), dot(ac, ac), dot(bc, bc)});
  if (!(size > kFlatShare * longest)) return distance_to_triangle(point, v);
  return std::abs(dot(point - v[0], normal)) / size;
}

std::array<bool, 4> sharp_sides(const LimitSurface& surface, std::uint32_t face, std::uint32_t square) {
  const std::span<const int> edges = surface.face_edges(face);
  const auto sharp = [&](std::size_t i) { return surface.is_sharp(std::uint32_t(edges[i % edges.size()])); };
  if (surface.is_quad(face)) return {sharp(0), sharp(1), sharp(2), sharp(3)};
  return {sharp(square), false, false, sharp(square + edges.size() - 1)};
}

}  // namespace

SquarePlaces::SquarePlaces(const LimitSurface& surface, std::uint32_t face, const SquareLattice& square,
                           std::uint32_t own)
    : square_(square),
      sharp_(sharp_sides(surface, face, own)),
      halves_{2 * square.columns, 2 * square.rows, {}} {
  const auto point = [&](std::uint32_t r, std::uint32_t c) -> const FacePoint& {
    return square.points[r * (square.columns + 1) + c];
  };
  for (std::uint32_t r = 0; r <= halves_.rows; ++r) {
    for (std::uint32_t c = 0; c <= halves_.columns; ++c) {
      const FacePoint &a = point(r / 2, c / 2), &b = point((r + 1) / 2, (c + 1) / 2);
      halves_.points.push_back(r % 2 == 0 && c % 2 == 0 ? a : halfway(a, b, own));
    }
  }
  square.for_triangles([&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    middles_.push_back(middle(square.points[a], square.points[b], square.points[c], own));
  });
}

std::vector<Vec3d> SquarePlaces::points_of(const std::vector<Vec3d>& halves) const {
  std::vector<Vec3d> result;
  result.reserve(square_.points.size());
  for (std::uint32_t i = 0; i < square_.points.size(); ++i) result.push_back(halves[half(i, i)]);
  return result;
}

std::optional<bool> SquarePlaces::side_is_sharp(std::uint32_t a, std::uint32_t b) const {
  const auto both = [](std::uint32_t x, std::uint32_t y, std::uint32_t end) { return x == end && y == end; };
  if (both(row(a), row(b), 0)) return sharp_[0];
  if (both(column(a), column(b), square_.columns)) return sharp_[1];
  if (both(row(a), row(b), square_.rows)) return sharp_[2];
  if (both(column(a), column(b), 0)) return sharp_[3];
  return std::nullopt;
}

// `visit(corners, drawn)` of each triangle: which of the square's points they are, and where.
template <typename Visit>
void SquarePlaces::for_drawn(const std::vector<Vec3d>& points, const Visit& visit) const {
  square_.for_triangles([&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    visit(std::array<std::uint32_t, 3>{a, b, c}, TriangleCorners{points[a], points[b], points[c]});
  });
}

std::vector<double> SquarePlaces::off_edges(const Positions& at) const {
  std::vector<double> nearest(at.halves.size(), std::numeric_limits<double>::infinity());
  std::vector<double> off_planes(at.halves.size(), 0.0);
  for_drawn(at.drawn, [&](const auto& corners, const TriangleCorners& drawn) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t from = corners[i], to = corners[(i + 1) % 3];
      const std::size_t place = half(from, to);
      const Vec3d& p = at.halves[place];
      nearest[place] = std::min(nearest[place], distance_to_triangle(p, drawn));
      const double off_plane =
          side_is_sharp(from, to).value_or(false) ? nearest[place] : distance_to_plane(p, drawn);
      off_planes[place] = std::max(off_planes[place], off_plane);
    }
  });
  for (std::size_t i = 0; i < nearest.size(); ++i) nearest[i] = std::min(nearest[i], off_planes[i]);
  return nearest;
}

void SquarePlaces::add_to(WorstStray& worst, const ScreenInstant& screen, const Positions& at) const {
  const std::vector<double> off = off_edges(at);
  std::size_t triangle = 0;
  for_drawn(at.drawn, [&](const auto& corners, const TriangleCorners& drawn) {
    const auto in_picture = [&] { return may_be_in_picture(screen, drawn); };
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t edge = half(corners[i], corners[(i + 1) % 3]);
      worst.add(off[edge], at.halves[edge], in_picture);
      const Vec3d& corner = at.halves[half(corners[i], corners[i])];
      worst.add(distance_to_plane(corner, drawn), corner, in_picture);
    }
    if (!at.middles.empty()) {
      const Vec3d& middle = at.middles[triangle];
      worst.add(distance_to_plane(middle, drawn), middle, in_picture);
    }
    ++triangle;
  });
}

}  // namespace msbvh::translate
