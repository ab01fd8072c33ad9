// How long something has taken, for statistics.
#pragma once

#include <chrono>

namespace msbvh {

// Runs from its construction.
class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(TimeRemap::now() - start_).count(); }

 private:
  using TimeRemap = std::chrono::steady_clock;
  TimeRemap::time_point start_ = TimeRemap::now();
};

}  // namespace msbvh
