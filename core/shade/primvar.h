// The value of a primvar where something was hit, at a time.
#pragma once

#include "core/base/lerp.h"
#include "core/motion/bezier.h"
#include "core/scene/scene.h"

namespace msbvh {

// Weights of a triangle's vertices, summing to 1.
struct Barycentrics {
  float b0, b1, b2;
  static Barycentrics of(float u, float v) { return {1.0f - u - v, u, v}; }
};

namespace detail {

template <typename T>
T value_at_key(const Primvar<T>& primvar, const TriangleMesh& shape, std::uint32_t triangle,
               const Barycentrics& b, std::uint32_t key) {
  const T* values = primvar.values.data();
  if (key != 0) values += key * value_count(primvar.interpolation, shape);
  const auto blend = [&](std::size_t i0, std::size_t i1, std::size_t i2) {
    return values[i0] * b.b0 + values[i1] * b.b1 + values[i2] * b.b2;
  };
  switch (primvar.interpolation) {
    case Interpolation::kConstant:
      break;
    case Interpolation::kTriangle:
      return values[triangle];
    case Interpolation::kVertex: {
      const Triangle& v = shape.triangles[triangle];
      return blend(v[0], v[1], v[2]);
    }
    case Interpolation::kFaceVarying: {
      const std::size_t corner = 3 * std::size_t(triangle);
      return blend(corner, corner + 1, corner + 2);
    }
  }
  return values[0];
}

// `at_key(key)`: the value there.
template <typename T, typename AtKey>
T over_time(const Primvar<T>& primvar, float time, const AtKey& at_key) {
  const SegmentTime at = locate(time, primvar.segments);
  const T first = at_key(at.key);
  if (primvar.segments == 0) return first;
  return lerp(first, at_key(at.key + 1), at.w);
}

}  // namespace detail

// `primvar` must be authored.
template <typename T>
T interpolate(const Primvar<T>& primvar, const TriangleMesh& shape, std::uint32_t triangle,
              const Barycentrics& b, float time) {
  return detail::over_time(primvar, time, [&](std::uint32_t key) {
    return detail::value_at_key(primvar, shape, triangle, b, key);
  });
}

// On grids.
template <typename T>
T interpolate(const Primvar<T>& primvar, const GridMesh& shape, const GridTriangle& triangle,
              const Barycentrics& b, float time) {
  return detail::over_time(primvar, time, [&](std::uint32_t key) {
    const T* values = primvar.values.data() + key * value_count(primvar.interpolation, shape);
    if (primvar.interpolation == Interpolation::kConstant) return values[0];
    if (primvar.interpolation == Interpolation::kTriangle) return values[triangle.grid];
    const Grid& grid = shape.grids[triangle.grid];
    const T* first = values + first_point(shape, grid);
    const auto at = [&](const GridVertex& v) { return first[v.row * grid.row_stride() + v.column]; };
    const auto v = vertices_of(triangle);
    return at(v[0]) * b.b0 + at(v[1]) * b.b1 + at(v[2]) * b.b2;
  });
}

// On a curve: `u` in [0, 1] along the span.
template <typename T>
T interpolate(const Primvar<T>& primvar, const CurveSet& shape, std::uint32_t span, float u, float time) {
  return detail::over_time(primvar, time, [&](std::uint32_t key) {
    const T* values = primvar.values.data() + key * value_count(primvar.interpolation, shape);
    if (primvar.interpolation == Interpolation::kConstant) return values[0];
    if (primvar.interpolation == Interpolation::kTriangle) return values[span];
    const T* vertices = values + shape.spans[span];
    return bezier([&](std::uint32_t i) { return vertices[i]; }, kSpanVertices - 1, u);
  });
}

// On a point.
template <typename T>
T interpolate(const Primvar<T>& primvar, const PointSet& shape, std::uint32_t point, float time) {
  return detail::over_time(primvar, time, [&](std::uint32_t key) {
    const T* values = primvar.values.data() + key * value_count(primvar.interpolation, shape);
    return values[primvar.interpolation == Interpolation::kConstant ? 0 : point];
  });
}

}  // namespace msbvh
