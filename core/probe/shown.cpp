#include "core/probe/shown.h"

#include <algorithm>

#include "core/geometry/grid_triangles.h"
#include "core/trace/pose.h"

namespace msbvh {

ShownMeshes::ShownMeshes(const Bvh& world) : world_(world) {
  add(world, kNoInstance);
  for (std::uint32_t i = 0; i < world.instances.size(); ++i) add(*world.instances[i].object, i);
}

void ShownMeshes::add(const Bvh& bvh, std::uint32_t instance) {
  for (const auto& mesh : bvh.meshes) add(*mesh, instance);
  for (const auto& grids : bvh.grids) {
    const auto [at, is_new] = of_grids_.try_emplace(grids.get());
    if (is_new) at->second = triangles_of(*grids);
    add(at->second, instance);
  }
}

void ShownMeshes::add(const TriangleMesh& mesh, std::uint32_t instance) {
  if (mesh.triangles.empty()) return;
  meshes_.push_back({&mesh, instance});
  first_.push_back(first_.back() + mesh.triangles.size());
}

std::pair<const ShownMesh*, std::uint32_t> ShownMeshes::triangle(std::size_t i) const {
  const auto after = std::ranges::upper_bound(first_, i);
  const auto mesh = static_cast<std::size_t>(after - first_.begin()) - 1;
  return {&meshes_[mesh], static_cast<std::uint32_t>(i - first_[mesh])};
}

std::optional<MeshPose> ShownMeshes::pose(const ShownMesh& shown, double u) const {
  if (shown.instance == kNoInstance) return MeshPose{u, {}, 0.0};
  const Instance& instance = world_.instances[shown.instance];
  const std::optional<double> own = local_time(world_.time_remap_of(instance), u);
  const std::optional<double> inside = local_time(&instance.object->time_remap, u);
  if (!own || !inside) return std::nullopt;
  const Affine3f* controls = world_.controls_of(instance);
  const double size = largest_control(instance.form, *own, [&](std::uint32_t c) {
    double most = 0.0;
    for (const auto column : {&Affine3f::x, &Affine3f::y, &Affine3f::z, &Affine3f::t})
      most = std::max(most, largest_coordinate(Vec3d(controls[c].*column)));
    return most;
  });
  return MeshPose{*inside, map_at(world_, instance, *own), size};
}

std::array<Vec3d, 3> corners(const ShownMesh& shown, const MeshPose& pose, std::uint32_t triangle) {
  std::array<Vec3d, 3> result;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t vertex = shown.mesh->triangles[triangle][k];
    result[k] = pose.world_from_mesh.point(vertex_at(*shown.mesh, vertex, pose.time01));
  }
  return result;
}

}  // namespace msbvh
