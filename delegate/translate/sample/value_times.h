// When values are read that may jump: what a light gives over the shutter.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace msbvh::translate {

struct ValueTime {
  double time01;     // of the sample
  double read_at01;  // when the stage is read for it: an instant earlier at the closing
  // Which of the authored times this is. The front-end reads there at the authored time code itself, since
  // one that is computed from `read_at01` may be rounded to before it.
  std::optional<std::size_t> authored{};
};

// 2^kFinestLevel even intervals of the shutter, which catch splines and products of what is linear; the
// authored times and those of switches, inside the shutter, in any order; and an instant before each, since
// values may jump there. Increasing, from 0 to 1. The closing stands for the instant before it: what begins
// then is not seen.
std::vector<ValueTime> value_times(std::span<const double> authored01, std::span<const double> switched01);

}  // namespace msbvh::translate
