// Boxes around what is drawn: of all controls of the motion, with widths, in the space of the geometry.
#pragma once

#include <vector>

#include "core/base/box.h"
#include "core/geometry/grid_mesh.h"
#include "core/geometry/round_vertex.h"
#include "core/geometry/triangle_mesh.h"

namespace msbvh::translate {

inline void grow(Box3d& box, const Box3f& part) {
  box.grow(Vec3d(part.lo));
  box.grow(Vec3d(part.hi));
}

inline Box3d drawn_box(const TriangleMesh& mesh) {
  Box3d box;
  for (std::size_t i = 0; i < mesh.position_count(); ++i) box.grow(Vec3d(mesh.positions[i]));
  return box;
}

inline Box3d drawn_box(const GridMesh& mesh) {
  Box3d box;
  for (const GridPatch& patch : mesh.patches) {
    for (std::uint32_t c = 0; c < mesh.form().controls(); ++c) grow(box, mesh.bounds(patch, c));
  }
  return box;
}

inline Box3d drawn_box(const std::vector<RoundVertex>& vertices) {
  Box3d box;
  for (const RoundVertex& v : vertices) {
    const Vec3f r{v.radius, v.radius, v.radius};
    grow(box, {v.p - r, v.p + r});
  }
  return box;
}

}  // namespace msbvh::translate
