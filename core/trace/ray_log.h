// The rays that a logging Tracer was asked, in the order of the calls.
#pragma once

#include <vector>

#include "core/trace/ray.h"

namespace msbvh {

struct RayLog {
  std::vector<Ray> closest;  // asked for their closest hit
  std::vector<Ray> any;      // asked whether there is any

  void clear() {
    closest.clear();
    any.clear();
  }
};

}  // namespace msbvh
