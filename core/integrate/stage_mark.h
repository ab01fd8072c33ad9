// What a thread is doing at the moment, for somebody who looks now and then: where time goes in a frame, by
// sampling (core/integrate/stage_samples.h).
//
// Stages mark where they begin, once for a whole batch of paths. Where nobody looks that is one branch, and
// nothing is written.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

#include "core/plan/known_effects.h"

namespace msbvh {

// Of trace_paths(), in its order; kNone: between tiles.
enum class Stage : std::uint8_t {
  kNone,
  kGenerate,
  kClosest,
  kOpacity,
  kSurface,
  kLooks,  // what materials say of surfaces
  kAovs,
  kScatter,
  kDirect,      // light that lights are sampled for
  kAreaLights,  // light that scattered rays find
  kDome,        // light that the last rays find
  kAccumulate
};
inline constexpr std::size_t kStageCount = 12;
const char* stage_name(Stage stage);  // "closest", "area lights", ...

// A stage of a thread, and where in it.
struct StageNow {
  Stage stage = Stage::kNone;
  bool tracing = false;  // rays go through the tree
  bool bounced = false;  // the paths have left their first surface

  static constexpr std::size_t kValues = kStageCount * 4;
  constexpr std::uint8_t code() const {
    return static_cast<std::uint8_t>(static_cast<unsigned>(stage) * 4 + (tracing ? 2 : 0) +
                                     (bounced ? 1 : 0));
  }
  static constexpr StageNow of(std::size_t code) {
    return {static_cast<Stage>(code / 4), (code & 2) != 0, (code & 1) != 0};
  }
};

class StageMark {
 public:
  StageMark() = default;
  // `seen` is what somebody else reads; null: nobody does.
  explicit StageMark(std::atomic<std::uint8_t>* seen) : seen_(seen) {}

  // That a stage begins, for paths that have `depth` surfaces behind them.
  void enter(Stage stage, std::uint32_t depth, bool tracing = false) {
    if (!kKnownStageMarks || !seen_) return;
    now_ = {stage, tracing, depth > 0};
    seen_->store(now_.code(), std::memory_order_relaxed);
  }
  // That the stage at hand begins to trace rays, or has ended.
  void trace(bool tracing) {
    if (!kKnownStageMarks || !seen_) return;
    now_.tracing = tracing;
    seen_->store(now_.code(), std::memory_order_relaxed);
  }

 private:
  std::atomic<std::uint8_t>* seen_ = nullptr;
  StageNow now_{};
};

}  // namespace msbvh
