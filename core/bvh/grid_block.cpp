#include "core/bvh/grid_block.h"

#include <algorithm>
#include <new>

#include "core/build/grid_clip.h"

namespace msbvh {
namespace {

void write_tiles(const GridMesh& mesh, const GridPatch& window, std::uint32_t control, NodeBounds& out) {
  for (std::uint32_t i = 0; i < kWidth; ++i) {
    const std::uint32_t row = i / 2 * kTileRows, column = i % 2 * kTileColumns;
    Box3f box{{kAbsent, kAbsent, kAbsent}, {-kAbsent, -kAbsent, -kAbsent}};
    if (row < window.rows && column < window.columns) {
      box = mesh.bounds({window.grid, static_cast<std::uint16_t>(window.row + row),
                         static_cast<std::uint16_t>(window.column + column),
                         static_cast<std::uint16_t>(std::min(kTileRows, window.rows - row)),
                         static_cast<std::uint16_t>(std::min(kTileColumns, window.columns - column))},
                        control);
    }
    out.set_box(i, box);
  }
}

}  // namespace

GridPatch window_of(const GridMesh& mesh, const GridBlock& block) {
  const GridTriangle first = mesh.triangle(block.first_triangle);
  return {first.grid, static_cast<std::uint16_t>(first.row), static_cast<std::uint16_t>(first.column),
          block.rows, block.columns};
}

void write_grid_block(const Primitives& primitives, const Reference& reference, BlockHeader& block) {
  const GridMesh& mesh = *primitives.grids[reference.grid_mesh()];
  const GridPatch window = reference.is_clipped() ? centre_patch(primitives, reference).window(reference.box)
                                                  : mesh.patches[reference.index];
  const Grid& grid = mesh.grids[window.grid];
  GridBlock& out = *new (&block + 1) GridBlock{};
  out.first_value = grid.first_value + window.row * grid.row_stride() + window.column;
  out.patch = reference.index;
  out.row_stride = grid.row_stride();
  out.plane_stride = grid.points();
  out.first_triangle = mesh.triangle_id({window.grid, window.row, window.column, 0});
  out.grid_columns = grid.columns;
  out.rows = window.rows;
  out.columns = window.columns;
  for (std::uint32_t c = 0; c < mesh.form().controls(); ++c)
    write_tiles(mesh, window, c, *new (out.tiles() + c) NodeBounds);
}

}  // namespace msbvh
