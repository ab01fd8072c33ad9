#include "delegate/translate/displace/as_grids.h"

#include <utility>

namespace msbvh::translate {
namespace {

GridMesh grid_mesh(const TriangleMesh& mesh, const GridLayout& layout) {
  const std::size_t controls = mesh.form().controls();
  GridMesh grids{mesh.name, mesh.segments, mesh.degree, layout.grids, {}, 0, {}};
  for (Grid& grid : grids.grids) grid.first_value *= controls;
  grids.values.reserve(3 * controls * layout.points.size() + GridMesh::kGuard);
  const std::uint32_t* points = layout.points.data();
  for (const Grid& grid : grids.grids) {
    for (std::uint32_t c = 0; c < controls; ++c) {
      const Vec3f* positions = mesh.control_positions(c);
      for (int axis = 0; axis < 3; ++axis) {
        for (std::uint32_t p = 0; p < grid.points(); ++p) grids.values.push_back(positions[points[p]][axis]);
      }
    }
    points += grid.points();
  }
  grids.values.resize(grids.values.size() + GridMesh::kGuard);
  cut_into_patches(grids);
  return grids;
}

Primvar<Vec3f> at_points(const Primvar<Vec3f>& of_vertices, std::size_t vertex_count,
                         const std::vector<std::uint32_t>& points) {
  Primvar<Vec3f> result{Interpolation::kVertex, of_vertices.segments, {}};
  result.values.reserve(points.size() * key_count(of_vertices.segments));
  for (std::uint32_t key = 0; key < key_count(of_vertices.segments); ++key) {
    const Vec3f* values = of_vertices.values.data() + key * vertex_count;
    for (const std::uint32_t point : points) result.values.push_back(values[point]);
  }
  return result;
}

}  // namespace

Grids as_grids(Mesh mesh, const GridLayout& layout) {
  Grids grids;
  static_cast<Appearance&>(grids) = std::move(static_cast<Appearance&>(mesh));
  grids.shape = grid_mesh(mesh.shape, layout);
  grids.normals = at_points(mesh.normals, mesh.shape.vertex_count, layout.points);
  grids.grid_materials = std::move(mesh.triangle_materials);
  grids.grid_faces = std::move(mesh.triangle_faces);
  grids.displaced_by = mesh.displaced_by;
  return grids;
}

}  // namespace msbvh::translate
