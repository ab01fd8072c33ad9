// A displaced mesh as grids of points, for the patch leaves of the tree.
#pragma once

#include "core/geometry/subdivision/refined_mesh.h"
#include "core/scene/grids.h"
#include "core/scene/mesh.h"

namespace msbvh::translate {

// `mesh`: the refined one, whose vertices the layout's points are; its colours and opacities, materials and
// faces are of grids already (Tessellation::draw_as_grids()), its normals one a vertex.
Grids as_grids(Mesh mesh, const GridLayout& layout);

}  // namespace msbvh::translate
