// Bezier curves of degree 1 to 3 on a track's segments, evaluated by de Casteljau's algorithm: nested calls
// of THE linear interpolation (core/base/lerp.h).
//
// Why de Casteljau and not the Bernstein sum: each step is monotone in both operands, rounding included, so
// that a box whose controls enclose a vertex's controls encloses the vertex in flight bit-exactly, as long as
// both take this routine. Error: |evaluated - exact| <= degree * kLerpError * max |control|.
// G. Farin, Curves and Surfaces for CAGD, 5th ed., chapters 4 (de Casteljau) and 6 (elevation, blossoms).
#pragma once

#include <cstdint>

#include "core/base/lerp.h"
#include "core/motion/track.h"

namespace msbvh {

// `control(i)` gives control i of the segment, i <= degree. `w` in [0, 1].
template <typename Controls, typename W>
constexpr auto bezier(const Controls& control, std::uint32_t degree, W w) {
  const auto a = lerp(control(0), control(1), w);
  if (degree == 1) return a;
  const auto b = lerp(control(1), control(2), w);
  const auto ab = lerp(a, b, w);
  if (degree == 2) return ab;
  const auto bc = lerp(b, lerp(control(2), control(3), w), w);
  return lerp(ab, bc, w);
}

// The value of a track of `controls` at a place of it; T is anything that lerp() takes.
template <typename T, typename W>
constexpr T track_value(const T* controls, const TrackForm& form, std::uint32_t key, W w) {
  if (!form.moving()) return controls[0];
  const T* first = controls + key * form.degree;
  return bezier([first](std::uint32_t i) { return first[i]; }, form.degree, w);
}

// The blossom (polar form) of a segment: symmetric and affine in each of its `degree` parameters, equal to
// the curve where all of them are the same. Control j of the curve's part over [a, b] is the blossom at
// (degree - j) times a and j times b. Exact up to rounding for any real a and b.
template <typename Controls, typename W>
constexpr auto blossom(const Controls& control, std::uint32_t degree, const W (&t)[kMaxDegree]) {
  const auto a = lerp(control(0), control(1), t[0]);
  if (degree == 1) return a;
  const auto b = lerp(control(1), control(2), t[0]);
  const auto ab = lerp(a, b, t[1]);
  if (degree == 2) return ab;
  const auto bc = lerp(b, lerp(control(2), control(3), t[0]), t[1]);
  return lerp(ab, bc, t[2]);
}

// Control j of the part [a, b] of a segment.
template <typename Controls, typename W>
constexpr auto part_control(const Controls& control, std::uint32_t degree, W a, W b, std::uint32_t j) {
  const W t[kMaxDegree] = {j > 0 ? b : a, j > 1 ? b : a, j > 2 ? b : a};
  return blossom(control, degree, t);
}

// Control j of the same curve at a higher degree (`degree` <= `to` <= kMaxDegree), one elevation at a time.
template <typename Controls>
constexpr auto elevated_control(const Controls& control, std::uint32_t degree, std::uint32_t to,
                                std::uint32_t j) {
  using T = decltype(control(0));
  T c[kMaxDegree + 1]{};
  for (std::uint32_t i = 0; i <= degree; ++i) c[i] = control(i);
  for (std::uint32_t d = degree; d < to; ++d) {
    c[d + 1] = c[d];
    for (std::uint32_t i = d; i >= 1; --i) c[i] = lerp(c[i], c[i - 1], double(i) / (d + 1));
  }
  return c[j];
}

}  // namespace msbvh
