// A triangle mesh and what is on it.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/vec.h"
#include "core/geometry/triangle_mesh.h"
#include "core/scene/appearance.h"

namespace msbvh {

struct Mesh : Appearance {
  TriangleMesh shape;  // with its guard: accelerators share it as it stands
  // Shading normals, need not be unit length; not authored: the triangle's own. In the mesh's time.
  Primvar<Vec3f> normals;
  // Empty, or one a triangle in place of `material`: parts with materials of their own stay one mesh, with
  // one tree and no edges that could leak.
  std::vector<std::uint32_t> triangle_materials{};
  // How far vertices lie off the surface that displacement has moved them from, at most; 0: none has.
  float displaced_by = 0.0f;
  // For AOVs: the face that each triangle is of; empty: each is one.
  std::vector<std::uint32_t> triangle_faces{};
  // For the plan: of the cage whose limit surface this is; 0: it is what the scene has.
  std::uint32_t cage_faces = 0;
};

}  // namespace msbvh
