// Values on a mesh: constant, or one a triangle, vertex or corner.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/geometry/triangle_mesh.h"

namespace msbvh {

// The number of values a primvar has on a triangle mesh. USD's `uniform` is expanded to one value a triangle
// and `varying` equals `vertex` on meshes.
enum class Interpolation : std::uint8_t {
  kConstant,    // 1
  kTriangle,    // one a triangle
  kVertex,      // one a vertex
  kFaceVarying  // three a triangle, in the order of its vertices
};

template <typename T>
struct Primvar {
  Interpolation interpolation = Interpolation::kConstant;
  std::uint32_t segments = 0;  // values are [key_count(segments)][count], key-major
  std::vector<T> values;       // empty: not authored
  bool authored() const { return !values.empty(); }
};

// Values of a primvar at one key.
std::size_t value_count(Interpolation interpolation, const TriangleMesh& shape);

}  // namespace msbvh
