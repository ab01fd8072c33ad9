// Closed meshes, and points inside of them: from there no ray gets out without a hit.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/probe/probe_random.h"
#include "core/probe/shown.h"

namespace msbvh {

// Whether every edge is used as often in one direction as in the other, vertices that lie in one place at
// every control counting as one: then the surface has no boundary at any time.
bool is_closed(const TriangleMesh& mesh);

// Those of all that are.
std::vector<const ShownMesh*> closed_meshes(const ShownMeshes& all);

// Whether the mesh surrounds a point of the world at this pose, and is farther from it than what a kernel
// rounds. Takes time proportional to the triangles.
bool is_inside(const ShownMesh& shown, const MeshPose& pose, const Vec3d& point);

// A point of the world that the mesh surrounds at this pose, exact in single precision and farther from the
// surface than what a kernel rounds; none where several tries find none. Takes time proportional to the
// triangles.
std::optional<Vec3f> point_inside(const ShownMesh& shown, const MeshPose& pose, ProbeRandom& random);

}  // namespace msbvh
