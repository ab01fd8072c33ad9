// Closed meshes: from inside of one no ray gets out without a hit.
#pragma once

#include <vector>

#include "core/probe/shown.h"

namespace msbvh {

// Whether every edge is used as often in one direction as in the other, vertices that lie in one place at
// every control counting as one: then the surface has no boundary at any time.
bool is_closed(const TriangleMesh& mesh);

// Those of all that are.
std::vector<const ShownMesh*> closed_meshes(const ShownMeshes& all);

}  // namespace msbvh
