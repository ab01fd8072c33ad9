// Random numbers for many paths at once, as fast as the machine's vectors allow.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/integrate/sampler.h"

namespace msbvh {

// Sampler::pair(), to the bit, for each of a number of paths. Memory is kept from call to call.
class DrawnPairs {
 public:
  // `samplers`: by path.
  void draw(std::span<const Sampler> samplers, std::span<const std::uint32_t> paths, const Draw& draw);
  Point2 operator[](std::size_t i) const { return {x_[i], y_[i]}; }

 private:
  std::vector<std::uint32_t> pixels_, samples_;
  std::vector<float> x_, y_;
};

}  // namespace msbvh
