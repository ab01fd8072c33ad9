#include "core/build/grid_clip.h"

#include <algorithm>

namespace msbvh {
namespace {

enum class Side { kOutside, kInside, kAcross };

// Of a triangle's box to a box that is grown by the error of clipping.
Side side_of(const Box3d& triangle, const Box3f& box) {
  const Vec3d m = max(abs(triangle.lo), abs(triangle.hi));
  const double error = kClipError * std::max({m.x, m.y, m.z});
  bool inside = true;
  for (int axis = 0; axis < 3; ++axis) {
    if (triangle.lo[axis] > double(box.hi[axis]) + error || triangle.hi[axis] < double(box.lo[axis]) - error)
      return Side::kOutside;
    inside &= triangle.lo[axis] >= double(box.lo[axis]) && triangle.hi[axis] <= double(box.hi[axis]);
  }
  return inside ? Side::kInside : Side::kAcross;
}

// The tight box of the part of the patch inside `box`.
Box3f part_bounds(const CentrePatch& patch, const Box3f& box) {
  Box3d bounds;
  patch.visit(box, [&](const GridTriangle& triangle, const BarycentricPolygon* polygon) {
    const std::array<Vec3d, 3> c = patch.corners(triangle);
    if (!polygon) {
      for (const Vec3d& p : c) bounds.grow(p);
      return;
    }
    for (int i = 0; i < polygon->count; ++i) {
      const Vec3d& b = polygon->corners[i];
      bounds.grow(c[0] * b.x + c[1] * b.y + c[2] * b.z);
    }
  });
  return bounds.empty() ? Box3f{} : intersect(round_outwards(bounds), box);
}

}  // namespace

CentrePatch::CentrePatch(const GridMesh& mesh, const GridPatch& patch, float centre) : patch_(patch) {
  const Grid& grid = mesh.grids[patch.grid];
  for (std::uint32_t r = 0; r <= patch.rows; ++r) {
    for (std::uint32_t c = 0; c <= patch.columns; ++c)
      points_[r * (kPatchQuads + 1) + c] = mesh.point(grid, patch.row + r, patch.column + c, centre);
  }
}

Box3f CentrePatch::quad_box(std::uint32_t quad) const {
  const std::uint32_t r = quad / patch_.columns, c = quad % patch_.columns;
  Box3f box;
  for (const auto& p : {point(r, c), point(r, c + 1), point(r + 1, c), point(r + 1, c + 1)}) box.grow(p);
  return box;
}

std::array<Vec3d, 3> CentrePatch::corners(const GridTriangle& triangle) const {
  std::array<Vec3d, 3> out;
  const auto v = vertices_of(triangle);
  for (int i = 0; i < 3; ++i) out[i] = Vec3d(point(v[i].row - patch_.row, v[i].column - patch_.column));
  return out;
}

void CentrePatch::visit(const Box3f& box, const Visitor& visit) const {
  for (std::uint32_t i = 0; i < 2 * quads(); ++i) {
    const GridTriangle triangle{patch_.grid, patch_.row + i / 2 / patch_.columns,
                                patch_.column + i / 2 % patch_.columns, i % 2};
    const std::array<Vec3d, 3> c = corners(triangle);
    const Side side = side_of({min(min(c[0], c[1]), c[2]), max(max(c[0], c[1]), c[2])}, box);
    if (side == Side::kOutside) continue;
    if (side == Side::kInside) {
      visit(triangle, nullptr);
      continue;
    }
    const BarycentricPolygon polygon = clip_to_box(c, box);
    if (polygon.count > 0) visit(triangle, &polygon);
  }
}

GridPatch CentrePatch::window(const Box3f& box) const {
  std::uint32_t row = ~0u, column = ~0u, row_end = 0, column_end = 0;
  visit(box, [&](const GridTriangle& t, const BarycentricPolygon*) {
    row = std::min(row, t.row);
    column = std::min(column, t.column);
    row_end = std::max(row_end, t.row + 1);
    column_end = std::max(column_end, t.column + 1);
  });
  if (row_end == 0) return patch_;
  return {patch_.grid, static_cast<std::uint16_t>(row), static_cast<std::uint16_t>(column),
          static_cast<std::uint16_t>(row_end - row), static_cast<std::uint16_t>(column_end - column)};
}

CentrePatch centre_patch(const Primitives& primitives, const Reference& reference) {
  const std::uint32_t id = reference.grid_mesh();
  const GridMesh& mesh = primitives.rest_grids.empty() ? *primitives.grids[id] : *primitives.rest_grids[id];
  return {mesh, mesh.patches[reference.index], primitives.slice.time(0.5f)};
}

CutBounds cut_bounds(const CentrePatch& patch, const Box3f& box, int axis, float plane) {
  Box3f low = box, high = box;
  low.hi[axis] = plane;
  high.lo[axis] = plane;
  return {part_bounds(patch, low), part_bounds(patch, high)};
}

}  // namespace msbvh
