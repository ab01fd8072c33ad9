// Values on a geometry: constant, or one a triangle, vertex or corner.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/geometry/curve_set.h"
#include "core/geometry/grid_mesh.h"
#include "core/geometry/point_set.h"
#include "core/geometry/triangle_mesh.h"

namespace msbvh {

// How many values a primvar has. USD's `uniform` is expanded to one value a triangle and `varying` equals
// `vertex` on meshes. On others: core/scene/{grids,curves,points}.h.
enum class Interpolation : std::uint8_t {
  kConstant,    // 1
  kTriangle,    // one a triangle, span or point
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
// Throw Error for an interpolation that there is not.
std::size_t value_count(Interpolation interpolation, const GridMesh& shape);
std::size_t value_count(Interpolation interpolation, const CurveSet& shape);
std::size_t value_count(Interpolation interpolation, const PointSet& shape);

}  // namespace msbvh
