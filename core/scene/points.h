// Points and what is on them.
#pragma once

#include <cstdint>

#include "core/base/vec.h"
#include "core/geometry/point_set.h"
#include "core/scene/mesh.h"
#include "core/scene/primvar.h"

namespace msbvh {

struct Points {
  PointSet shape;
  // kConstant or kTriangle: one a point.
  Primvar<Vec3f> display_color;
  Primvar<float> display_opacity;
  std::uint32_t material = kNone;  // kNone: diffuse in display_color (0.18 grey where not authored)
  std::uint32_t prim_id = kNone;   // for AOVs; kNone: the geometry's index
};

}  // namespace msbvh
