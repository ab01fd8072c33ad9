// Where the vertices are at the shutter's centre, or at that of the primitives' slice of it, evaluated once a
// vertex rather than once a corner.
#pragma once

#include <array>
#include <vector>

#include "core/build/reference.h"

namespace msbvh {

class CentrePose {
 public:
  explicit CentrePose(const Primitives& primitives);

  // Equal to TriangleMesh::position() at that time, and followed by the guard of TriangleMesh: 16 bytes can
  // be loaded.
  const Vec3f* positions(std::uint32_t mesh) const { return positions_[mesh]; }
  std::array<const Vec3f*, 3> corners(const Reference& r) const {
    const Triangle& t = primitives_.meshes[r.mesh()]->triangles[r.index];
    const Vec3f* p = positions_[r.mesh()];
    return {p + t[0], p + t[1], p + t[2]};
  }
  std::array<Vec3d, 3> triangle(const Reference& r) const {
    const auto c = corners(r);
    return {Vec3d(*c[0]), Vec3d(*c[1]), Vec3d(*c[2])};
  }
  const Primitives& primitives() const { return primitives_; }

 private:
  const Primitives& primitives_;
  std::vector<const Vec3f*> positions_;        // by mesh
  std::vector<std::vector<Vec3f>> evaluated_;  // of meshes that have no key at the centre
};

}  // namespace msbvh
