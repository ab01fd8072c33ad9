// References to all primitives of a tree, whole.
#pragma once

#include <memory>

#include "core/build/centre_pose.h"
#include "core/build/raw_array.h"
#include "core/build/sah.h"

namespace msbvh {

// Where references lie while they are sorted: as long as a set in it is still to be built.
using Memory = std::shared_ptr<RawArray<Reference>>;

struct AllReferences {
  Memory memory;
  std::size_t count = 0;
  SetBounds bounds;
};

// Order: meshes' triangles, grids' patches, curves' pieces, points, instances. Curves and points of no width
// are left out. Instances with an empty box (nothing in them) are left out.
AllReferences make_references(const CentrePose& pose);

}  // namespace msbvh
