// Shading normals: authored ones brought onto the triangle mesh, or smooth ones computed from it.
#pragma once

#include <cstdint>

#include "core/geometry/subdivision/refined_mesh.h"
#include "core/geometry/triangle_mesh.h"
#include "core/scene/scene.h"
#include "delegate/translate/diagnostics.h"
#include "delegate/translate/inputs.h"
#include "delegate/translate/time_layout.h"
#include "delegate/translate/transform_samples.h"
#include "delegate/translate/triangulate.h"

namespace msbvh::translate {

// At all keys of a curved track together, 400 MB: its surface has its points at a few controls alone.
inline constexpr std::size_t kMostNormals = std::size_t(1) << 25;

// One a vertex at keys of the mesh's time: the sum of its triangles' normals, weighted by their areas. Zero
// where they cancel. A linear mesh takes its own keys, a curved one as many as follow to kNormalTolerance,
// or, with a warning, as many as make no more than so many normals.
Primvar<Vec3f> smooth_normals(const TriangleMesh& mesh, std::uint32_t max_segments, PrimLog& log,
                              std::size_t most_normals = kMostNormals);

// Of the limit surface, likewise: `cage` are its points' controls in the form of the refined mesh's track.
// One a vertex, or one a corner where the surface has creases.
Primvar<Vec3f> limit_normals(const RefinedMesh& refined, const std::vector<Vec3f>& cage,
                             const TrackForm& form, std::uint32_t max_segments, PrimLog& log);

// With the fewest segments that follow the stage to kNormalTolerance. Not authored, where there are none or
// where they do not fit the mesh (with a warning).
inline constexpr double kNormalTolerance = 0.01;  // radians
struct NormalMotion {
  const TransformTrack& transform;
  const TimeLayout& layout;  // of the points
  bool frame_only = false;   // the points are carried or held: so are their normals
};
Primvar<Vec3f> authored_normals(const MeshInput& input, const Triangulation& mesh, const NormalMotion& motion,
                                std::uint32_t max_segments, PrimLog& log);

}  // namespace msbvh::translate
