// The triangles that a tree shows, its instances' among them, and where they are at a time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/base/affine.h"
#include "core/bvh/bvh.h"
#include "core/trace/ray.h"

namespace msbvh {

// A mesh of the tree itself, or of an instance's object.
struct ShownMesh {
  const TriangleMesh* mesh;
  std::uint32_t instance = kNoInstance;
};

// Where a mesh is at a time of the shutter: in its own space, and from there to the world.
struct MeshPose {
  double time01;  // the mesh's own
  Affine3d world_from_mesh;
};

class ShownMeshes {
 public:
  // `world` must outlive it.
  explicit ShownMeshes(const Bvh& world);

  std::span<const ShownMesh> meshes() const { return meshes_; }
  std::size_t triangle_count() const { return first_.back(); }
  // The mesh that triangle `i` of all is of, and its number there; i < triangle_count().
  std::pair<const ShownMesh*, std::uint32_t> triangle(std::size_t i) const;
  // None where the mesh is not there at this time.
  std::optional<MeshPose> pose(const ShownMesh& shown, double u) const;

 private:
  void add(const Bvh& bvh, std::uint32_t instance);

  const Bvh& world_;
  std::vector<ShownMesh> meshes_;
  std::vector<std::size_t> first_{0};  // triangle of each mesh; and their number
};

// In the world.
std::array<Vec3d, 3> corners(const ShownMesh& shown, const MeshPose& pose, std::uint32_t triangle);

}  // namespace msbvh
