// Which points a cage's faces are sampled at, numbered over the whole mesh: a point on an edge or at a vertex
// is one point, whatever face looks at it. Hence no cracks: neighbours do not agree on positions, they share
// them.
//
// Each edge has a rate of its own, 2^level segments. A face is as fine as its finest edge in either
// direction, one that is not a quad at least as 2 segments; at a coarser edge its outermost points are drawn
// to the edge's own points, which leaves triangles without area there and a border of exactly the edge's
// segments (the stitching of M. Fisher et al., "DiagSplit: Parallel, Crack-free, Adaptive Tessellation for
// Micropolygon Rendering", SIGGRAPH Asia 2009, for powers of two).
#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/subdivision/limit_surface.h"

namespace msbvh {

inline constexpr std::uint32_t kMaxEdgeLevel = 10;

// A point of the mesh where one face sees it.
struct FacePoint {
  std::uint32_t id = 0;
  std::uint32_t square = 0;
  double s = 0.0, t = 0.0;
};

struct SquareLattice {
  std::uint32_t columns = 0, rows = 0;
  std::vector<FacePoint> points;  // [row][column], of (rows + 1) x (columns + 1)

  // Two triangles a quad, but for those that stitching leaves without area. `visit(a, b, c)`: their places in
  // `points`.
  template <typename Visit>
  void for_triangles(const Visit& visit) const {
    const auto triangle = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      const std::uint32_t i = points[a].id, j = points[b].id, k = points[c].id;
      if (i != j && j != k && k != i) visit(a, b, c);
    };
    const std::uint32_t stride = columns + 1;
    for (std::uint32_t r = 0; r < rows; ++r) {
      for (std::uint32_t c = 0; c < columns; ++c) {
        const std::uint32_t a = r * stride + c;
        triangle(a, a + 1, a + stride + 1);
        triangle(a, a + stride + 1, a + stride);
      }
    }
  }
};

class FaceLattices {
 public:
  // `edge_levels`: one an edge, 0 to kMaxEdgeLevel. Borrows `surface`. Throws Error beyond 2^32 points.
  FaceLattices(const LimitSurface& surface, std::vector<std::uint32_t> edge_levels);

  std::uint32_t point_count() const { return point_count_; }
  // Points below this are the cage's vertices, by their number, and points on edges; the others are a face's
  // own.
  std::uint32_t border_count() const { return border_count_; }
  // One square for a quad, else one a vertex.
  std::vector<SquareLattice> squares(std::uint32_t face) const;
  // The points of a face, each once, by id.
  static std::vector<FacePoint> distinct(const std::vector<SquareLattice>& squares);

 private:
  struct EdgePoint {
    std::uint32_t id;
    double along;  // from the face's vertex i to the next, in [0, 1]
  };
  // The edge's own point next to k / n along the face's edge i; n at least the edge's rate, a power of two.
  EdgePoint on_edge(std::uint32_t face, std::uint32_t i, std::uint32_t k, std::uint32_t n) const;
  SquareLattice quad(std::uint32_t face) const;
  FacePoint quad_point(std::uint32_t face, std::uint32_t r, std::uint32_t c, std::uint32_t rows,
                       std::uint32_t columns) const;
  SquareLattice quarter(std::uint32_t face, std::uint32_t square) const;
  FacePoint quarter_point(std::uint32_t face, std::uint32_t square, std::uint32_t r, std::uint32_t c,
                          std::uint32_t n) const;
  std::uint32_t rate(std::uint32_t face, std::uint32_t i) const;  // segments of the face's edge i
  std::uint32_t finest(std::uint32_t face) const;
  std::uint64_t inner_points(std::uint32_t face) const;

  const LimitSurface& surface_;
  std::vector<std::uint32_t> edge_levels_, edge_first_, face_first_;
  std::uint32_t point_count_ = 0, border_count_ = 0;
};

}  // namespace msbvh
