// Shading normals: authored ones brought onto the triangle mesh, or smooth ones computed from it.
#pragma once

#include <cstdint>

#include "core/geometry/triangle_mesh.h"
#include "core/scene/scene.h"
#include "delegate/translate/diagnostics.h"
#include "delegate/translate/inputs.h"
#include "delegate/translate/transform_samples.h"
#include "delegate/translate/triangulate.h"

namespace msbvh::translate {

// One a vertex at each of the mesh's keys: the sum of its triangles' normals, weighted by their areas. Zero
// where they cancel.
Primvar<Vec3f> smooth_normals(const TriangleMesh& mesh);

// With the fewest segments that follow the stage to kNormalTolerance. Not authored, where there are none or
// where they do not fit the mesh (with a warning).
inline constexpr double kNormalTolerance = 0.01;  // radians
Primvar<Vec3f> authored_normals(const MeshInput& input, const Triangulation& mesh,
                                const TransformTrack& transform, std::uint32_t max_segments, PrimLog& log);

}  // namespace msbvh::translate
