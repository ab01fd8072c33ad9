// Multiple importance sampling: what a sample counts where another way of sampling could have found the same
// direction. E. Veach, "Robust Monte Carlo Methods for Light Transport Simulation", 1997, section 9.2.
#pragma once

#include <limits>

namespace msbvh {

// The power heuristic with exponent 2. `pdf`: of the way that found it, times how many samples that way
// takes, above 0; `other`: likewise of the other way.
inline float power_heuristic(float pdf, float other) {
  const float a = pdf * pdf, b = other * other, sum = a + b;
  if (sum > 0.0f && sum < std::numeric_limits<float>::infinity()) return a / sum;
  // A light of 1e-20 sr has a density whose square is infinite: a centimetre seen from 1e5 km.
  const float ratio = other / pdf;
  return 1.0f / (1.0f + ratio * ratio);
}

}  // namespace msbvh
