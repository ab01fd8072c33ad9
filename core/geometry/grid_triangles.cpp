#include "core/geometry/grid_triangles.h"

#include <utility>

namespace msbvh {

TriangleMesh triangles_of(const GridMesh& grids) {
  TriangleMesh out;
  out.name = grids.name;
  out.segments = grids.segments;
  out.degree = grids.degree;
  for (const Grid& g : grids.grids) out.vertex_count += g.points();
  for (std::uint32_t c = 0; c < grids.form().controls(); ++c) {
    for (const Grid& g : grids.grids) {
      for (std::uint32_t r = 0; r <= g.rows; ++r) {
        for (std::uint32_t k = 0; k <= g.columns; ++k)
          out.positions.push_back(grids.control_point(g, r, k, c));
      }
    }
  }
  std::uint32_t first = 0;
  for (std::uint32_t g = 0; g < grids.grids.size(); first += grids.grids[g++].points()) {
    const Grid& grid = grids.grids[g];
    for (std::uint32_t i = 0; i < 2 * grid.columns * grid.rows; ++i) {
      const auto v = vertices_of({g, i / 2 / grid.columns, i / 2 % grid.columns, i % 2});
      Triangle t;
      for (int k = 0; k < 3; ++k) t[k] = first + v[k].row * grid.row_stride() + v[k].column;
      out.triangles.push_back(t);
    }
  }
  return validated(std::move(out));
}

}  // namespace msbvh
