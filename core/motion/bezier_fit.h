// Bezier controls from values: the curve on one segment that passes through the motion at given places.
//
// Exact (to rounding) for motion that is a polynomial of the curve's degree: velocities and accelerations
// give quadratics. Neighbouring segments share their ends, so that tracks are continuous.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/base/vec.h"
#include "core/motion/track.h"

namespace msbvh {

// Places within a segment, ends included: Chebyshev-Lobatto points, whose interpolation errs next to least.
inline std::span<const double> fit_nodes(std::uint32_t degree) {
  static constexpr std::array<double, 2> kLinear{0.0, 1.0};
  static constexpr std::array<double, 3> kQuadratic{0.0, 0.5, 1.0};
  static constexpr std::array<double, 4> kCubic{0.0, 0.25, 0.75, 1.0};
  if (degree == 1) return kLinear;
  return degree == 2 ? std::span<const double>(kQuadratic) : std::span<const double>(kCubic);
}

// In place: values at fit_nodes(degree) to controls. `at(i)` gives a reference to value i, then control i; T
// has sums and products with doubles.
template <typename At>
constexpr void controls_from_values(const At& at, std::uint32_t degree) {
  if (degree == 2) at(1) = at(1) * 2.0 - (at(0) + at(2)) * 0.5;
  if (degree != 3) return;
  // Bernstein weights at 1/4 are 27, 27, 9, 1 sixty-fourths, at 3/4 the same backwards.
  const auto near = at(1) - at(0) * (27.0 / 64.0) - at(3) * (1.0 / 64.0);
  const auto far = at(2) - at(0) * (1.0 / 64.0) - at(3) * (27.0 / 64.0);
  at(1) = (near * 3.0 - far) * (8.0 / 9.0);
  at(2) = (far * 3.0 - near) * (8.0 / 9.0);
}

}  // namespace msbvh
