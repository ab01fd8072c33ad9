// Curves and what is on them.
#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/curve_set.h"
#include "core/scene/appearance.h"

namespace msbvh {

// Primvars: kConstant; kTriangle: one a span; kVertex: one a control vertex, blended as the positions are
// (Bernstein). USD's `uniform` is expanded to spans, `varying` to vertices, both without loss.
struct Curves : Appearance {
  CurveSet shape;
  bool fibre = false;                        // scatters light as hair does (core/shade/bsdf/fibre.h)
  std::vector<std::uint32_t> span_curves{};  // for AOVs: the curve that each span is of; empty: each is one
};

}  // namespace msbvh
