// A mesh where it is at one time, and points inside of it: from there no ray gets out without a hit if the
// mesh is closed.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/probe/probe_random.h"
#include "core/probe/shown.h"

namespace msbvh {

class PosedMesh {
 public:
  // Copies what it needs of the mesh's vertices; the mesh must outlive it.
  PosedMesh(const ShownMesh& shown, const MeshPose& pose);

  const ShownMesh& shown() const { return shown_; }
  const MeshPose& pose() const { return pose_; }
  std::uint32_t triangle_count() const { return static_cast<std::uint32_t>(shown_.mesh->triangles.size()); }
  // In the world.
  std::array<Vec3d, 3> corners(std::uint32_t triangle) const;
  std::uint32_t random_triangle(ProbeRandom& random) const {
    return static_cast<std::uint32_t>(random.below(triangle_count()));
  }

  // Whether the mesh surrounds a point of the world, and is farther from it than what a kernel rounds. Takes
  // time proportional to the triangles.
  bool surrounds(const Vec3d& point) const;
  // One that it surrounds, exact in single precision; none where several tries find none.
  std::optional<Vec3f> point_inside(ProbeRandom& random) const;

 private:
  double rounded_size(const Vec3d& point) const;

  const ShownMesh shown_;
  const MeshPose pose_;
  std::vector<Vec3d> places_;  // of the vertices, in the world
  double control_size_ = 0.0;  // the largest coordinate of a control in force, in the mesh's space
};

}  // namespace msbvh
