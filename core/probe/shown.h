// The triangles that a tree shows, its grids' and its instances' among them, and where they are at a time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/base/affine.h"
#include "core/bvh/bvh.h"
#include "core/trace/ray.h"

namespace msbvh {

// A mesh of the tree itself, or of an instance's object; or the triangles of grids as one.
struct ShownMesh {
  const TriangleMesh* mesh;
  std::uint32_t instance = kNoInstance;
};

// Where a mesh is at a time of the shutter: in its own space, and from there to the world.
struct MeshPose {
  double time01;  // the mesh's own
  Affine3d world_from_mesh;
  double map_size = 0.0;  // of an instance: the largest element of the maps that it was interpolated from
};

class ShownMeshes {
 public:
  // `world` must outlive it. Copies the triangles of grids.
  explicit ShownMeshes(const Bvh& world);
  ShownMeshes(const ShownMeshes&) = delete;

  std::span<const ShownMesh> meshes() const { return meshes_; }
  std::size_t triangle_count() const { return first_.back(); }
  // The mesh that triangle `i` of all is of, and its number there; i < triangle_count().
  std::pair<const ShownMesh*, std::uint32_t> triangle(std::size_t i) const;
  // None where the mesh is not there at this time.
  std::optional<MeshPose> pose(const ShownMesh& shown, double u) const;

 private:
  void add(const Bvh& bvh, std::uint32_t instance);
  void add(const TriangleMesh& mesh, std::uint32_t instance);

  const Bvh& world_;
  std::unordered_map<const GridMesh*, TriangleMesh> of_grids_;
  std::vector<ShownMesh> meshes_;
  std::vector<std::size_t> first_{0};  // triangle of each mesh; and their number
};

// In the world.
std::array<Vec3d, 3> corners(const ShownMesh& shown, const MeshPose& pose, std::uint32_t triangle);

}  // namespace msbvh
