// Curves and what is on them.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/vec.h"
#include "core/geometry/curve_set.h"
#include "core/scene/mesh.h"
#include "core/scene/primvar.h"

namespace msbvh {

struct Curves {
  CurveSet shape;
  // kConstant; kTriangle: one a span; kVertex: one a control vertex, blended as the positions are (Bernstein).
  // USD's `uniform` is expanded to spans, `varying` to vertices, both without loss.
  Primvar<Vec3f> display_color;
  Primvar<float> display_opacity;
  std::uint32_t material = kNone;  // kNone: diffuse in display_color (0.18 grey where not authored)
  // For AOVs: the prim's id, kNone for the geometry's index, and the curve that each span is of; empty: each
  // is one.
  std::uint32_t prim_id = kNone;
  std::vector<std::uint32_t> span_curves{};
};

}  // namespace msbvh
