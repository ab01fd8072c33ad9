// The triangles of grids as a mesh: for checks, and for renderers that know no grids.
#pragma once

#include "core/geometry/grid_mesh.h"
#include "core/geometry/triangle_mesh.h"

namespace msbvh {

// Triangle i is triangle i of the grids, on the same track. Each grid has vertices of its own: those of
// neighbours lie in one place. Throws Error for more vertices than 32 bits count.
TriangleMesh triangles_of(const GridMesh& grids);

}  // namespace msbvh
