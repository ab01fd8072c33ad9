#include "delegate/translate/frame/array_motion.h"

#include <utility>

#include "delegate/translate/instance_chain.h"
#include "delegate/translate/sample/turns.h"

namespace msbvh::translate {
namespace {

Matrix4d matrix_from(const Affine3d& a) {
  return {a.x.x, a.x.y, a.x.z, 0, a.y.x, a.y.y, a.y.z, 0, a.z.x, a.z.y, a.z.z, 0, a.t.x, a.t.y, a.t.z, 1};
}

class ArrayMotion : public MotionSource {
 public:
  // Keeps what the chain borrows.
  ArrayMotion(PlacedLevel level, std::unique_ptr<ChainLevel> chain)
      : level_(std::move(level)), chain_(std::move(chain)) {}

  std::size_t count() const override { return chain_->count(); }
  bool still() const override { return chain_->is_still(); }
  std::vector<double> breakpoints01() const override {
    std::vector<double> times01;
    for (const Breakpoint& breakpoint : chain_->breakpoints()) {
      if (breakpoint.time01 > 0.0 && breakpoint.time01 < 1.0) times01.push_back(breakpoint.time01);
    }
    return times01;
  }
  // Between dense times nothing turns by more than their share of a turn.
  Turns turns(std::uint32_t) const override {
    return chain_->has_dense_times() ? uniform_turns(double(chain_->dense_times01().size()) / kTimesATurn)
                                     : Turns();
  }
  void evaluate(std::span<const double> times01, std::span<const std::uint32_t> which,
                std::span<Matrix4d> out) const override {
    for (std::size_t t = 0; t < times01.size(); ++t) {
      const std::unique_ptr<LevelInstant> instant = chain_->at(times01[t], times01[t]);
      for (std::size_t i = 0; i < which.size(); ++i)
        out[t * which.size() + i] = matrix_from(instant->map(which[i]));
    }
  }

 private:
  PlacedLevel level_;
  std::unique_ptr<ChainLevel> chain_;
};

}  // namespace

MotionPointer motion_of(const PlacedLevel& level, PrimLog& log) {
  if (level.motion) return level.motion;
  auto kept = std::make_unique<PlacedLevel>(level);
  InstanceLevel arrays;
  arrays.points = kept->arrays.get();
  arrays.selected = kept->selected;
  std::unique_ptr<ChainLevel> chain = make_point_level(arrays, log);
  if (!chain) return nullptr;
  // The vector's elements stay where they are.
  return std::make_shared<ArrayMotion>(std::move(*kept), std::move(chain));
}

}  // namespace msbvh::translate
