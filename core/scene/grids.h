// Grids of points, as displaced surfaces become (core/geometry/grid_mesh.h), and what is on them.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/vec.h"
#include "core/geometry/grid_mesh.h"
#include "core/scene/appearance.h"

namespace msbvh {

// Points are counted grid by grid, row by row; those on borders once for each grid.
inline std::uint32_t first_point(const GridMesh& shape, const Grid& grid) {
  return std::uint32_t(grid.first_value / (3 * std::size_t(shape.form().controls())));
}

// Primvars are constant; kTriangle: one a grid; or kVertex: one a point, grid by grid, row by row. Points on
// borders belong to several grids, which may say different things there: hence nothing is kFaceVarying.
struct Grids : Appearance {
  GridMesh shape;  // trees share it as it stands
  // Shading normals, need not be unit length; not authored: the triangle's own. In the grids' time.
  Primvar<Vec3f> normals;
  // Empty, or one a grid in place of `material`.
  std::vector<std::uint32_t> grid_materials{};
  // How far points lie off the surface that displacement has moved them from, at most; 0: none has.
  float displaced_by = 0.0f;
  // For AOVs: the prim's face that each grid is of; empty: each is one.
  std::vector<std::uint32_t> grid_faces{};
};

}  // namespace msbvh
