// Whether the boxes of a tree hold what they bound, at given times, by exact arithmetic: no tolerance.
//
// What is judged is what traversal sees: boxes, vertices and matrices interpolated in single precision as the
// kernels do, with and without fused operations. On floats that makes a comparison exact. A triangle that is
// in several leaves is in their boxes together (tests/stability/exact_parts.h). Of curves, balls at dyadic
// places along the centre line are judged; what instances show, by the corners of the object's box under the
// matrix.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/bvh/bvh.h"

namespace msbvh::stability {

struct BoxVerdict {
  std::uint64_t comparisons = 0;  // of something with the boxes that must hold it, at one time
  std::uint64_t cut = 0;          // of them with several boxes: of fragments
  std::uint64_t outside = 0;
  std::string first{};  // of those outside, for people

  BoxVerdict& operator+=(const BoxVerdict& b);
};

BoxVerdict judge_boxes(const Bvh& bvh, std::span<const float> times);

// 0 and 1, the keys of so many segments, the floats beside each, the middles between them, and as many random
// times.
std::vector<float> hard_times(std::uint32_t segments, std::uint64_t seed);

}  // namespace msbvh::stability
