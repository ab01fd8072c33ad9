// A triangle mesh and what is on it.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "core/base/vec.h"
#include "core/geometry/triangle_mesh.h"
#include "core/scene/primvar.h"

namespace msbvh {

inline constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

struct Mesh {
  TriangleMesh shape;  // with its guard: accelerators share it as it stands
  // Shading normals, need not be unit length; not authored: the triangle's own. In the mesh's time; the other
  // primvars are in the shutter's.
  Primvar<Vec3f> normals;
  Primvar<Vec3f> display_color;
  Primvar<float> display_opacity;
  std::uint32_t material = kNone;  // kNone: diffuse in display_color (0.18 grey where not authored)
  // Empty, or one a triangle in place of `material`: parts with materials of their own stay one mesh, with
  // one tree and no edges that could leak.
  std::vector<std::uint32_t> triangle_materials{};
  // How far vertices lie off the surface that displacement has moved them from, at most; 0: none has.
  float displaced_by = 0.0f;
  // For AOVs: the prim's id, kNone for the mesh's index, and the face that each triangle is of; empty: each
  // is one.
  std::uint32_t prim_id = kNone;
  std::vector<std::uint32_t> triangle_faces{};
};

}  // namespace msbvh
