// A point of the unit square, from which directions and places are sampled.
#pragma once

namespace msbvh {

struct Point2 {
  float x, y;  // in [0, 1)
};

}  // namespace msbvh
