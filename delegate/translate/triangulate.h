// Polygons to triangles, and where each triangle came from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/geometry/triangle_mesh.h"
#include "delegate/translate/diagnostics.h"
#include "delegate/translate/inputs.h"

namespace msbvh::translate {

struct Triangulation {
  // Vertex indices, counter-clockwise from outside whatever the orientation was.
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> faces;  // the face of each triangle
  std::vector<Triangle> corners;     // the face-vertices of each triangle: indices into faceVertexIndices
  std::size_t face_count = 0;        // of the input, for the sizes of primvars
  std::size_t face_vertex_count = 0;
  std::size_t point_count = 0;
};

// Face counts are not negative and add up to the indices; indices are in range.
bool check_topology(const MeshInput& mesh, std::size_t point_count, PrimLog& log);

// A fan from each face's first vertex, as Hydra's HdMeshUtil triangulates. Holes are left out; faces of fewer
// than three vertices too, with a warning, and hole indices out of range with another. The input must have
// passed check_topology().
Triangulation triangulate(const MeshInput& mesh, std::size_t point_count, PrimLog& log);

}  // namespace msbvh::translate
