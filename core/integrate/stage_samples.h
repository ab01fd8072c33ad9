// Where the time of a frame goes, by looking now and then what each of its threads does:
// core/integrate/stage_mark.h.
#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <thread>

#include "core/integrate/stage_mark.h"

namespace msbvh {

// How often a thread was found at each place. Threads are found where they are by the clock, whether or not a
// busy machine lets them run.
struct StageCounts {
  std::array<std::uint64_t, StageNow::kValues> of_code{};  // by StageNow::code()

  void add(std::uint8_t code) { ++of_code[code]; }
  // Of all stages; threads between tiles are left out.
  std::uint64_t total() const;
};

// Looks about a thousand times a second, at odd intervals, so that what recurs evenly is not met at one phase
// alone.
class StageSampler {
 public:
  StageSampler();
  ~StageSampler() { stop(); }
  StageSampler(const StageSampler&) = delete;
  StageSampler& operator=(const StageSampler&) = delete;

  // For one thread at a time; looked at until stop(). Thread-safe. The mark must not outlive the sampler.
  StageMark mark();
  // What was found so far; looks no more.
  const StageCounts& stop();

 private:
  void run();

  std::mutex mutex_;
  std::condition_variable stopping_;
  bool stopped_ = false;
  std::deque<std::atomic<std::uint8_t>> seen_;  // whose places stay
  StageCounts counts_;
  std::thread thread_;  // last: starts when the rest is ready
};

}  // namespace msbvh
