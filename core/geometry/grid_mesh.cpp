#include "core/geometry/grid_mesh.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/geometry/triangle_mesh.h"

namespace msbvh {
namespace {

[[noreturn]] void fail(const GridMesh& mesh, const std::string& what) {
  throw Error((mesh.name.empty() ? std::string("grids") : mesh.name) + ": " + what);
}

// The arrays that follow from the grids' sizes are what they say.
void check_layout(const GridMesh& mesh) {
  GridMesh expected{mesh.name, mesh.segments, mesh.degree, mesh.grids, {}, 0, {}};
  std::size_t values = 0;
  for (Grid& g : expected.grids) {
    if (g.rows < 1 || g.columns < 1 || g.rows > kMaxGridQuads || g.columns > kMaxGridQuads)
      fail(mesh, "grids: found " + std::to_string(g.rows) + " x " + std::to_string(g.columns) +
                     " quads; expected 1 to " + std::to_string(kMaxGridQuads) + " each");
    if (g.first_value != values) fail(mesh, "grids: values that do not follow one another");
    values += 3 * std::size_t(mesh.form().controls()) * g.points();
  }
  if (mesh.values.size() != values + GridMesh::kGuard)
    fail(mesh, "values: found " + std::to_string(mesh.values.size()) + "; expected " +
                   std::to_string(values) + ", and a guard of " + std::to_string(GridMesh::kGuard));
  cut_into_patches(expected);
  bool same = expected.patches == mesh.patches && expected.quad_count == mesh.quad_count;
  for (std::size_t i = 0; i < mesh.grids.size(); ++i)
    same &= expected.grids[i].first_quad == mesh.grids[i].first_quad;
  if (!same) fail(mesh, "patches: found others; expected those of cut_into_patches()");
}

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

GridMesh still_at(const GridMesh& mesh, float u) {
  GridMesh out;
  out.name = mesh.name;
  out.patches = mesh.patches;
  out.quad_count = mesh.quad_count;
  for (const Grid& from : mesh.grids) {
    Grid& grid = out.grids.emplace_back(from);
    grid.first_value = out.values.size();
    out.values.resize(grid.first_value + 3 * std::size_t(grid.points()));
    float* at = out.values.data() + grid.first_value;
    for (std::uint32_t r = 0; r <= grid.rows; ++r) {
      for (std::uint32_t c = 0; c <= grid.columns; ++c, ++at) {
        const Vec3f p = mesh.point(from, r, c, u);
        for (int axis = 0; axis < 3; ++axis) at[std::size_t(axis) * grid.points()] = p[axis];
      }
    }
  }
  out.values.resize(out.values.size() + GridMesh::kGuard);
  return out;
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

void validate(const GridMesh& mesh) {
  if (!is_valid_form(mesh.form()))
    fail(mesh, "segments, degree: found " + std::to_string(mesh.segments) + ", " +
                   std::to_string(mesh.degree) + "; expected 0 or a power of two up to " +
                   std::to_string(kMaxSegments) + ", and 1 to " + std::to_string(kMaxDegree));
  check_layout(mesh);
  for (const float x : mesh.values) {
    if (std::abs(x) <= kMaxCoordinate) continue;  // false for NaN too
    fail(mesh, "values: found the coordinate " + std::to_string(x) +
                   "; expected finite numbers of at most 2^60 in size");
  }
}

}  // namespace msbvh
