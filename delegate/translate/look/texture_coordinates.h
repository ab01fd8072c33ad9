// Where a UsdUVTexture is read: a primvar's values, mapped by UsdTransform2d nodes.
#pragma once

#include <array>
#include <string>

#include "delegate/translate/diagnostics.h"
#include "delegate/translate/look/shader_network.h"

namespace msbvh::translate {

struct TextureCoordinates {
  std::string primvar{};                             // empty: the same everywhere
  std::array<double, 2> fallback{};                  // what counts where a mesh has no such primvar
  std::array<double, 4> matrix{1.0, 0.0, 0.0, 1.0};  // row by row
  std::array<double, 2> offset{};

  std::array<double, 2> mapped(double s, double t) const {
    return {matrix[0] * s + matrix[1] * t + offset[0], matrix[2] * s + matrix[3] * t + offset[1]};
  }
};

// What the texture's `st` is connected to, through any number of UsdTransform2d: scaled, then turned about
// the origin, then moved. What cannot be evaluated is reported and counts as (0, 0).
TextureCoordinates coordinates_of(const ShaderNode& texture, const ShaderNetwork& network,
                                  const PrimLog& log);

}  // namespace msbvh::translate
