// Points and what is on them.
#pragma once

#include "core/geometry/point_set.h"
#include "core/scene/appearance.h"

namespace msbvh {

// Primvars: kConstant or kTriangle: one a point.
struct Points : Appearance {
  PointSet shape;
};

}  // namespace msbvh
