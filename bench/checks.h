// Whether answers are right: against the oracle, against a peer, and where nothing may leak.
#pragma once

#include <vector>

#include "bench/sides.h"
#include "core/bvh/bvh.h"

namespace msbvh::bench {

struct OracleCheck {
  std::size_t rays = 0, wrong = 0;
};
// As many of the rays, evenly spread, as the oracle judges in so many triangle tests; 4 at least.
OracleCheck check_oracle(const Bvh& bvh, RayKind kind, const std::vector<Ray>& rays, double triangle_tests);

// Rays that one side hits and the other does not, or at distances in the scene that differ by more than
// `tolerance`.
std::size_t count_differences(const std::vector<Ray>& rays, const std::vector<float>& a,
                              const std::vector<float>& b, double tolerance);

// The most of any mode of the side.
std::size_t count_misses(Side& side, const std::vector<Ray>& rays);

// Nodes and tests of every 16th ray.
TraceCounts count_work(const Bvh& bvh, RayKind kind, const std::vector<Ray>& rays);

}  // namespace msbvh::bench
