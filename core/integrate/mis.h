// Multiple importance sampling: what a sample counts where another way of sampling could have found the same
// direction. E. Veach, "Robust Monte Carlo Methods for Light Transport Simulation", 1997, section 9.2.
#pragma once

namespace msbvh {

// The power heuristic with exponent 2. `pdf`: of the way that found it, times how many samples that way
// takes; `other`: likewise of the other way.
inline float power_heuristic(float pdf, float other) {
  const float a = pdf * pdf, b = other * other;
  return a / (a + b);
}

}  // namespace msbvh
