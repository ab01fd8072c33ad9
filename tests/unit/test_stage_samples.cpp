// Sampling what threads do: what a thread was marked at is what it is found at.
#include <atomic>
#include <chrono>
#include <doctest/doctest.h>
#include <set>
#include <string>
#include <thread>

#include "core/integrate/stage_samples.h"

namespace msbvh {
namespace {

TEST_CASE("stages: every place has a code of its own, and every stage a name of its own") {
  std::set<std::string> names;
  for (std::size_t code = 0; code < StageNow::kValues; ++code) {
    CHECK(StageNow::of(code).code() == code);
    names.insert(stage_name(StageNow::of(code).stage));
  }
  CHECK(names.size() == kStageCount);
}

TEST_CASE("stages: a thread is found where it is marked, and nowhere where it is idle") {
  StageSampler sampler;
  StageMark busy = sampler.mark();
  sampler.mark();  // of a thread that never begins
  busy.enter(Stage::kDome, 1, true);
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  const StageCounts counts = sampler.stop();
  const StageNow expected{Stage::kDome, true, true};
  CHECK(counts.total() > 0);
  CHECK(counts.of_code[expected.code()] == counts.total());
}

TEST_CASE("stages: a mark says when its stage begins to trace and when it has ended") {
  std::atomic<std::uint8_t> seen{};
  StageMark mark(&seen);
  mark.enter(Stage::kDirect, 0);
  CHECK(seen == StageNow{Stage::kDirect, false, false}.code());
  mark.trace(true);
  CHECK(seen == StageNow{Stage::kDirect, true, false}.code());
  mark.trace(false);
  CHECK(seen == StageNow{Stage::kDirect, false, false}.code());
}

TEST_CASE("stages: nobody is looked at after the end, and a mark without a sampler is of no matter") {
  StageSampler sampler;
  StageMark mark = sampler.mark();
  const StageCounts counts = sampler.stop();
  mark.enter(Stage::kClosest, 0, true);
  std::this_thread::sleep_for(std::chrono::milliseconds(5));
  CHECK(sampler.stop().total() == counts.total());
  StageMark unseen;
  unseen.enter(Stage::kClosest, 0);
  unseen.trace(true);
}

}  // namespace
}  // namespace msbvh
