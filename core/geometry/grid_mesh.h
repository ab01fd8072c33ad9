// Grids of points on a surface, two triangles a quad, that move along tracks: what displaced subdivision
// patches are intersected as. A patch, a window of at most kPatchQuads x kPatchQuads quads, is the primitive
// that a tree refers to; its triangles are never in the tree (paper, on displaced subdivision patches: they
// are subdivided along their parametrization).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/box.h"
#include "core/base/vec.h"
#include "core/motion/bezier.h"
#include "core/motion/track.h"

namespace msbvh {

// A lattice of (rows + 1) x (columns + 1) points: one square of a cage's face.
struct Grid {
  std::uint32_t face = 0, square = 0;   // see FaceSurface::evaluate: columns run along s, rows along t
  std::uint32_t columns = 0, rows = 0;  // quads
  std::uint32_t first_quad = 0;         // of the mesh
  std::size_t first_value = 0;          // in GridMesh::values

  std::uint32_t row_stride() const { return columns + 1; }
  std::uint32_t points() const { return (columns + 1) * (rows + 1); }
};

struct GridPatch {
  std::uint32_t grid = 0;
  std::uint16_t row = 0, column = 0;    // of its first quad
  std::uint16_t rows = 0, columns = 0;  // 1 to kPatchQuads
  bool operator==(const GridPatch&) const = default;
};
inline constexpr std::uint32_t kPatchQuads = 8;
inline constexpr std::uint32_t kMaxGridQuads = 65528;  // along a side: patches count in 16 bits

// One of the two triangles of a quad: with a b the lower and d c the upper row, a b c and a c d.
struct GridTriangle {
  std::uint32_t grid, row, column, half;
};

struct GridMesh {
  std::string name;  // in messages: the prim's path
  std::uint32_t segments = 0;
  std::uint32_t degree = 1;
  std::vector<Grid> grids;
  std::vector<GridPatch> patches;  // each quad is in exactly one
  std::uint32_t quad_count = 0;
  // Grid by grid [form().controls()][axis][row][column], then kGuard unused elements. Columns lie next to
  // each other, so that four quads are two loads.
  std::vector<float> values;

  // Elements behind the last one: a load of four columns may begin at the last.
  static constexpr std::size_t kGuard = 4;

  TrackForm form() const { return {segments, degree}; }
  const float* control_values(const Grid& grid, std::uint32_t control) const {
    return values.data() + grid.first_value + 3 * std::size_t(control) * grid.points();
  }
  Vec3f control_point(const Grid& grid, std::uint32_t row, std::uint32_t column,
                      std::uint32_t control) const {
    const float* p = control_values(grid, control) + row * grid.row_stride() + column;
    return {p[0], p[grid.points()], p[2 * std::size_t(grid.points())]};
  }
  Vec3f point(const Grid& grid, std::uint32_t row, std::uint32_t column, float u) const {
    const SegmentTime at = locate(u, segments);
    if (segments == 0) return control_point(grid, row, column, 0);
    const auto control = [&](std::uint32_t i) {
      return control_point(grid, row, column, at.key * degree + i);
    };
    return bezier(control, degree, at.w);
  }

  // Triangle ids count two a quad, grid by grid, row by row.
  std::uint32_t triangle_count() const { return 2 * quad_count; }
  std::uint32_t triangle_id(const GridTriangle& t) const {
    const Grid& g = grids[t.grid];
    return 2 * (g.first_quad + t.row * g.columns + t.column) + t.half;
  }
  GridTriangle triangle(std::uint32_t id) const;

  // The hull of a patch's points at a control: exactly what is intersected there, hence nothing is padded,
  // and interpolated boxes enclose interpolated points bit by bit (core/base/lerp.h).
  Box3f bounds(const GridPatch& patch, std::uint32_t control) const;
};

// Rows and columns of the triangle's vertices.
struct GridVertex {
  std::uint32_t row, column;
};
constexpr std::array<GridVertex, 3> vertices_of(const GridTriangle& t) {
  const GridVertex a{t.row, t.column}, b{t.row, t.column + 1}, c{t.row + 1, t.column + 1},
      d{t.row + 1, t.column};
  return t.half == 0 ? std::array{a, b, c} : std::array{a, c, d};
}

// The same grids and patches, still, as they are at u.
GridMesh still_at(const GridMesh& mesh, float u);

// Appends the patches of all grids and numbers the quads. Throws Error beyond 2^31 quads.
void cut_into_patches(GridMesh& mesh);

// The gate: checks the form, that `values` holds every point of every grid and the guard, that every
// coordinate is finite and at most kMaxCoordinate in size, and that patches tile the grids. Throws Error
// naming the mesh, the array, what was found and what is expected.
void validate(const GridMesh& mesh);

}  // namespace msbvh
