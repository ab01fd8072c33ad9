// THE linear interpolation of this renderer: (1 - w) * a + w * b, both weights >= 0. Vertices, node boxes and
// transforms are interpolated in this form and no other. Its SIMD twin, core/trace/simd_lerp-inl.h, fuses the
// last two operations where the instruction set can.
//
// Why this form: it is a composition of monotone roundings, fused or not, hence monotone in a and in b. If lo
// <= v holds at both keys, lerp(lo) <= lerp(v) holds bit-exactly between them, as long as box and vertex take
// the same routine: a box that encloses a vertex at its keys encloses it in flight without any padding. The
// form a + w * (b - a) does not have this property. At w = 0 and at w = 1 the result is exactly a or b.
//
// Error: |lerp - exact| <= kLerpError * max(|a|, |b|): one rounding each (2^-24) of 1 - w, the products and
// the sum.
#pragma once

#include "core/base/affine.h"
#include "core/base/box.h"
#include "core/base/vec.h"

namespace msbvh {

// Relative to the larger key. 3 roundings of 2^-24 each, rounded up to 2^-22.
inline constexpr float kLerpError = 0x1p-22f;

constexpr float lerp(float a, float b, float w) { return (1.0f - w) * a + w * b; }
constexpr double lerp(double a, double b, double w) { return (1.0 - w) * a + w * b; }

template <typename T>
constexpr Vec3<T> lerp(const Vec3<T>& a, const Vec3<T>& b, T w) {
  return {lerp(a.x, b.x, w), lerp(a.y, b.y, w), lerp(a.z, b.z, w)};
}
template <typename T>
constexpr Box3<T> lerp(const Box3<T>& a, const Box3<T>& b, T w) {
  return {lerp(a.lo, b.lo, w), lerp(a.hi, b.hi, w)};
}
template <typename T>
constexpr Affine3<T> lerp(const Affine3<T>& a, const Affine3<T>& b, T w) {
  return {lerp(a.x, b.x, w), lerp(a.y, b.y, w), lerp(a.z, b.z, w), lerp(a.t, b.t, w)};
}

}  // namespace msbvh
