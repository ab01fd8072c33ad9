#include "core/geometry/grid_mesh.h"

#include <algorithm>

#include "core/base/error.h"

namespace msbvh {
namespace {

void cut_grid(const GridMesh& mesh, std::uint32_t g, std::vector<GridPatch>& out) {
  const Grid& grid = mesh.grids[g];
  for (std::uint32_t row = 0; row < grid.rows; row += kPatchQuads) {
    for (std::uint32_t column = 0; column < grid.columns; column += kPatchQuads) {
      out.push_back({g, static_cast<std::uint16_t>(row), static_cast<std::uint16_t>(column),
                     static_cast<std::uint16_t>(std::min(kPatchQuads, grid.rows - row)),
                     static_cast<std::uint16_t>(std::min(kPatchQuads, grid.columns - column))});
    }
  }
}

}  // namespace

GridTriangle GridMesh::triangle(std::uint32_t id) const {
  const std::uint32_t quad = id / 2;
  const auto next = std::upper_bound(grids.begin(), grids.end(), quad,
                                     [](std::uint32_t q, const Grid& g) { return q < g.first_quad; });
  const auto g = static_cast<std::uint32_t>(next - grids.begin() - 1);
  const std::uint32_t local = quad - grids[g].first_quad;
  return {g, local / grids[g].columns, local % grids[g].columns, id % 2};
}

Box3f GridMesh::bounds(const GridPatch& patch, std::uint32_t control) const {
  const Grid& grid = grids[patch.grid];
  const float* first = control_values(grid, control) + patch.row * grid.row_stride() + patch.column;
  Box3f box;
  for (int axis = 0; axis < 3; ++axis) {
    const float* plane = first + std::size_t(axis) * grid.points();
    float lo = plane[0], hi = plane[0];
    for (std::uint32_t r = 0; r <= patch.rows; ++r) {
      for (std::uint32_t c = 0; c <= patch.columns; ++c) {
        lo = std::min(lo, plane[r * grid.row_stride() + c]);
        hi = std::max(hi, plane[r * grid.row_stride() + c]);
      }
    }
    box.lo[axis] = lo;
    box.hi[axis] = hi;
  }
  return box;
}

void cut_into_patches(GridMesh& mesh) {
  std::uint64_t quads = 0;
  for (std::uint32_t g = 0; g < mesh.grids.size(); ++g) {
    mesh.grids[g].first_quad = static_cast<std::uint32_t>(quads);
    quads += std::uint64_t(mesh.grids[g].columns) * mesh.grids[g].rows;
    if (quads >= std::uint64_t(1) << 31)
      throw Error((mesh.name.empty() ? std::string("grids") : mesh.name) +
                  ": found 2^31 quads or more; expected fewer");
    cut_grid(mesh, g, mesh.patches);
  }
  mesh.quad_count = static_cast<std::uint32_t>(quads);
}

}  // namespace msbvh
