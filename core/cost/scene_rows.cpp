#include "core/cost/scene_rows.h"

namespace msbvh {
namespace {

template <typename Geometry>
std::uint32_t index_in(const std::vector<Geometry>& list, const Geometry* geometry) {
  return static_cast<std::uint32_t>(geometry - list.data());
}

// What `use` says of the geometry's shape, whatever its kind.
template <typename Use>
decltype(auto) with_shape(const Scene& scene, GeometryId id, const Use& use) {
  switch (id.kind()) {
    case GeometryKind::kGridMesh:
      return use(scene.grids[id.index()].shape);
    case GeometryKind::kCurves:
      return use(scene.curves[id.index()].shape);
    case GeometryKind::kPoints:
      return use(scene.points[id.index()].shape);
    case GeometryKind::kTriangleMesh:
      break;
  }
  return use(scene.mesh(id).shape);
}

}  // namespace

SceneRows::SceneRows(const Scene& scene) : scene_(&scene) {
  const std::size_t counts[] = {scene.meshes.size(), scene.grids.size(), scene.curves.size(),
                                scene.points.size()};
  for (std::size_t kind = 0; kind < std::size(counts); ++kind)
    first_[kind + 1] = first_[kind] + static_cast<std::uint32_t>(counts[kind]);
}

std::uint32_t SceneRows::row(const HitSource& source) const {
  if (source.mesh) return row(mesh_id(index_in(scene_->meshes, source.mesh)));
  if (source.grids) return row(grids_id(index_in(scene_->grids, source.grids)));
  if (source.curves) return row(curves_id(index_in(scene_->curves, source.curves)));
  return row(points_id(index_in(scene_->points, source.points)));
}

GeometryId SceneRows::id(std::uint32_t row) const {
  std::size_t kind = 0;
  while (row >= first_[kind + 1]) ++kind;
  return {static_cast<GeometryKind>(kind), row - first_[kind]};
}

const std::string& SceneRows::name(std::uint32_t row) const {
  return with_shape(*scene_, id(row), [](const auto& shape) -> const std::string& { return shape.name; });
}

TrackForm SceneRows::form(std::uint32_t row) const {
  return with_shape(*scene_, id(row), [](const auto& shape) { return shape.form(); });
}

}  // namespace msbvh
