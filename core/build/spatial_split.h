// Spatial splits: a plane that cuts primitives in two. M. Stich, H. Friedrich, A. Dietrich, "Spatial Splits
// in Bounding Volume Hierarchies", HPG 2009, section 4; at the shutter's centre, as the MSBVH has them.
#pragma once

#include <limits>
#include <span>

#include "core/build/reference.h"

namespace msbvh {

struct SpatialSplit {
  float cost = std::numeric_limits<float>::infinity();  // as ObjectSplit::cost
  int axis = 0;
  float plane = 0.0f;
  Box3f left, right;  // estimates from the bins
  std::size_t left_count = 0, right_count = 0;
};

// The best of equally spaced planes over the box of the set. Cut triangles are bounded exactly within each
// bin that they span; instances are never cut and count on the side of their centre.
SpatialSplit find_spatial_split(const Primitives& primitives, std::span<const Reference> references,
                                const Box3f& box);

// Where a reference goes. Both sides hold something if and only if the reference is cut (clipped flags set).
struct DividedReference {
  bool in_left = false, in_right = false;
  Reference left, right;
};
DividedReference divide(const Primitives& primitives, const Reference& reference, const SpatialSplit& split);

}  // namespace msbvh
