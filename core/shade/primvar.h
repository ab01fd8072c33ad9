// The value of a primvar at a point of a triangle and at a time.
#pragma once

#include "core/base/lerp.h"
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

}  // namespace detail

// `primvar` must be authored.
template <typename T>
T interpolate(const Primvar<T>& primvar, const TriangleMesh& shape, std::uint32_t triangle,
              const Barycentrics& b, float time) {
  const SegmentTime at = locate(time, primvar.segments);
  const T first = detail::value_at_key(primvar, shape, triangle, b, at.key);
  if (primvar.segments == 0) return first;
  return lerp(first, detail::value_at_key(primvar, shape, triangle, b, at.key + 1), at.w);
}

}  // namespace msbvh
