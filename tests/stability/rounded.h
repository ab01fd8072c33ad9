// Tracks as the kernels evaluate them, to the bit: THE linear interpolation (core/base/lerp.h) with the last
// two operations fused (AVX2, AVX-512) or not (SSE4, and core/base/lerp.h itself).
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "core/base/affine.h"
#include "core/base/box.h"
#include "core/base/vec.h"
#include "core/bvh/verify_slot.h"
#include "core/geometry/round_vertex.h"
#include "core/motion/track.h"

namespace msbvh::stability {

enum class Rounding : std::uint8_t { kPlain, kFused };
inline constexpr Rounding kRoundings[] = {Rounding::kPlain, Rounding::kFused};

inline float lerp_as(Rounding r, float a, float b, float w) {
  return r == Rounding::kFused ? std::fma(w, b, (1.0f - w) * a) : (1.0f - w) * a + w * b;
}
inline Vec3f lerp_as(Rounding r, const Vec3f& a, const Vec3f& b, float w) {
  return {lerp_as(r, a.x, b.x, w), lerp_as(r, a.y, b.y, w), lerp_as(r, a.z, b.z, w)};
}
inline Box3f lerp_as(Rounding r, const Box3f& a, const Box3f& b, float w) {
  return {lerp_as(r, a.lo, b.lo, w), lerp_as(r, a.hi, b.hi, w)};
}
inline Affine3f lerp_as(Rounding r, const Affine3f& a, const Affine3f& b, float w) {
  return {lerp_as(r, a.x, b.x, w), lerp_as(r, a.y, b.y, w), lerp_as(r, a.z, b.z, w), lerp_as(r, a.t, b.t, w)};
}
inline RoundVertex lerp_as(Rounding r, const RoundVertex& a, const RoundVertex& b, float w) {
  RoundVertex v = a;
  v.p = lerp_as(r, a.p, b.p, w);
  v.radius = lerp_as(r, a.radius, b.radius, w);
  return v;
}

// De Casteljau's algorithm, as core/motion/bezier.h; `control(i)` of the segment.
template <class Controls>
auto bezier_as(Rounding r, const Controls& control, std::uint32_t degree, float w) {
  std::array<std::decay_t<decltype(control(0u))>, kMaxDegree + 1> c;
  for (std::uint32_t i = 0; i <= degree; ++i) c[i] = control(i);
  for (std::uint32_t last = degree; last > 0; --last) {
    for (std::uint32_t i = 0; i < last; ++i) c[i] = lerp_as(r, c[i], c[i + 1], w);
  }
  return c[0];
}

// A track at a place in it; `control(i)` of the whole track.
template <class Controls>
auto track_as(Rounding r, const Controls& control, const TrackForm& form, const SegmentTime& at) {
  if (!form.moving()) return control(0u);
  return bezier_as(
      r, [&](std::uint32_t i) { return control(at.key * form.degree + i); }, form.degree, at.w);
}

// The box that a node tells of a child, at a time of the shutter.
inline Box3f box_as(Rounding r, const Slot& slot, float u) {
  const SegmentTime at = slot.slice.whole() || !slot.form.moving()
                             ? locate(u, slot.form.segments)
                             : SegmentTime{0, locate(u, slot.slice.count).w};
  return track_as(
      r, [&](std::uint32_t i) { return slot.controls[i]; }, slot.form, at);
}

}  // namespace msbvh::stability
