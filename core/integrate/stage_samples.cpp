#include "core/integrate/stage_samples.h"

#include <chrono>
#include <random>

namespace msbvh {
namespace {

constexpr int kLeastMicroseconds = 500, kMostMicroseconds = 1500;

}  // namespace

std::uint64_t StageCounts::total() const {
  std::uint64_t sum = 0;
  for (std::size_t code = 0; code < of_code.size(); ++code)
    if (StageNow::of(code).stage != Stage::kNone) sum += of_code[code];
  return sum;
}

StageSampler::StageSampler() : thread_([this] { run(); }) {}

StageMark StageSampler::mark() {
  const std::scoped_lock lock(mutex_);
  return StageMark(&seen_.emplace_back(StageNow{}.code()));
}

const StageCounts& StageSampler::stop() {
  {
    const std::scoped_lock lock(mutex_);
    stopped_ = true;
  }
  stopping_.notify_all();
  if (thread_.joinable()) thread_.join();
  return counts_;
}

void StageSampler::run() {
  std::minstd_rand random;
  std::uniform_int_distribution<int> interval(kLeastMicroseconds, kMostMicroseconds);
  std::unique_lock lock(mutex_);
  while (
      !stopping_.wait_for(lock, std::chrono::microseconds(interval(random)), [this] { return stopped_; })) {
    for (const std::atomic<std::uint8_t>& seen : seen_) counts_.add(seen.load(std::memory_order_relaxed));
  }
}

}  // namespace msbvh
