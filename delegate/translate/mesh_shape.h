// A mesh's shape, and what is seen on it: normals, primvars and materials.
#pragma once

#include <string>
#include <vector>

#include "delegate/translate/fit.h"
#include "delegate/translate/mesh.h"
#include "delegate/translate/moving_array.h"
#include "delegate/translate/normals.h"
#include "delegate/translate/tessellation.h"

namespace msbvh::translate {

// A mesh's shape and, of a refined one that is not displaced, its cage's points at the same controls.
struct Shape {
  TriangleMesh mesh;
  std::vector<Vec3f> cage{};
  double displaced_by = 0.0;
};

// All but the positions.
Shape empty_shape(const Candidate& track, const Tessellation& faces, const std::string& name);
// Of points that keep `track`.
Shape shape_of(const MovingArray& points, const Candidate& track, const Tessellation& faces,
               const std::string& name);

// The shape with all that is seen on it, as the result's mesh or grids.
void add_shape(const MeshInput& input, Tessellation& topology, const NormalMotion& motion,
               const MeshTarget& target, Shape shape, TranslatedMesh& result, PrimLog& log);

// The prim's material, or none and a warning where there is no such material.
std::uint32_t material_of(const MeshInput& input, const MeshTarget& target, PrimLog& optional);

}  // namespace msbvh::translate
