#include "delegate/translate/instance_chain.h"

#include <algorithm>

#include "core/base/lerp.h"
#include "delegate/translate/smooth_times.h"
#include "delegate/translate/time_samples.h"
#include "delegate/translate/transform_samples.h"

namespace msbvh::translate {
namespace {

constexpr const char* kMatrices = "instance transforms";

// Matrices that the front-end evaluated.
class MatrixLevel final : public ChainLevel {
 public:
  explicit MatrixLevel(const InstanceLevel& level)
      : level_(level),
        count_(level.matrices.size() / level.times01.size()),
        range_(samples_of_shutter(level.times01, level.held)),
        smooth_(std::span(level.times01).subspan(range_.first, range_.count()), level.breakpoints01,
                level.held),
        still_(compare()) {}

  std::size_t count() const override { return count_; }
  bool is_still() const override { return still_; }
  std::vector<Breakpoint> breakpoints() const override {
    std::vector<Breakpoint> result;
    if (still_) return result;
    for (const double time01 : level_.breakpoints01 ? *level_.breakpoints01 : level_.times01) {
      result.push_back({time01, level_.held});
    }
    return normalized_breakpoints(std::move(result));
  }
  std::vector<double> dense_times01() const override {
    if (still_) return {};
    const auto first = level_.times01.begin() + std::ptrdiff_t(range_.first);
    return {first, first + std::ptrdiff_t(range_.count())};
  }
  bool has_dense_times() const override { return !still_; }
  std::vector<double> periods01() const override { return still_ ? std::vector<double>{} : level_.periods01; }
  std::unique_ptr<LevelInstant> at(double time01, double within) const override {
    return std::make_unique<Instant>(level_.matrices.subspan(range_.first * count_), count_,
                                     smooth_.at(time01, within));
  }
  std::string rule() const override {
    if (still_) return "still";
    return level_.held ? "transforms held from sample to sample" : "transforms of the stage's own evaluation";
  }

 private:
  class Instant final : public LevelInstant {
   public:
    Instant(std::span<const Matrix4d> matrices, std::size_t count, const SmoothTimes::Mix& mix)
        : matrices_(matrices), count_(count), mix_(mix) {}
    Affine3d map(std::size_t index) const override {
      return mixed(mix_, [&](std::size_t sample) { return affine_from(matrices_[sample * count_ + index]); });
    }

   private:
    std::span<const Matrix4d> matrices_;
    std::size_t count_;
    SmoothTimes::Mix mix_;
  };

  // Compares values: matrices that do not change over many samples are still.
  bool compare() const {
    const Matrix4d* first = level_.matrices.data() + range_.first * count_;
    for (std::size_t i = range_.first + 1; i <= range_.last; ++i) {
      if (!std::equal(first, first + count_, level_.matrices.data() + i * count_)) return false;
    }
    return true;
  }

  const InstanceLevel& level_;
  std::size_t count_;
  SampleRange range_;
  SmoothTimes smooth_;
  bool still_;
};

}  // namespace

std::unique_ptr<ChainLevel> make_matrix_level(const InstanceLevel& level, PrimLog& log) {
  if (!check_times(level.times01, kMatrices, log)) return nullptr;
  if (level.matrices.size() % level.times01.size() != 0) {
    log.reject(kMatrices, message("found ", level.matrices.size(), " matrices; expected a multiple of ",
                                  level.times01.size(), ", the number of times"));
    return nullptr;
  }
  return std::make_unique<MatrixLevel>(level);
}

std::optional<InstanceChain> InstanceChain::make(const std::vector<InstanceLevel>& levels, PrimLog& log) {
  InstanceChain chain;
  for (const InstanceLevel& level : levels) {
    PrimLog own = log.of_prim(level.points ? level.points->path : std::string());
    chain.levels_.push_back(level.points ? make_point_level(level, own) : make_matrix_level(level, own));
    if (!chain.levels_.back()) return std::nullopt;
    chain.count_ *= chain.levels_.back()->count();
  }
  return chain;
}

bool InstanceChain::is_still() const {
  return std::ranges::all_of(levels_, [](const auto& level) { return level->is_still(); });
}

std::vector<Breakpoint> InstanceChain::breakpoints() const {
  std::vector<Breakpoint> result;
  for (const auto& level : levels_) {
    const std::vector<Breakpoint> more = level->breakpoints();
    result.insert(result.end(), more.begin(), more.end());
  }
  return normalized_breakpoints(std::move(result));
}

std::vector<double> InstanceChain::dense_times01() const {
  std::vector<double> result;
  for (const auto& level : levels_) {
    const std::vector<double> more = level->dense_times01();
    result.insert(result.end(), more.begin(), more.end());
  }
  std::erase_if(result, [](double time01) { return time01 < 0.0 || time01 > 1.0; });
  std::ranges::sort(result);
  result.erase(std::ranges::unique(result).begin(), result.end());
  return result;
}

std::size_t InstanceChain::dense_stride(std::size_t instance) const {
  // Merged times have no stride in common.
  std::size_t stride = 1, dense_levels = 0;
  for (const auto& level : levels_) {
    if (level->has_dense_times() && ++dense_levels > 1) return 1;
    if (level->has_dense_times()) stride = level->dense_stride(instance % level->count());
    instance /= level->count();
  }
  return stride;
}

std::vector<double> InstanceChain::periods01() const {
  std::vector<double> result;
  for (const auto& level : levels_) {
    const std::vector<double> more = level->periods01();
    result.insert(result.end(), more.begin(), more.end());
  }
  std::erase_if(result, [](double period01) { return !is_period(period01); });
  std::ranges::sort(result);
  result.erase(std::ranges::unique(result).begin(), result.end());
  return result.size() > kMostPeriods ? std::vector<double>{} : result;
}

std::string InstanceChain::rule() const {
  std::string rule;
  for (const auto& level : levels_) {
    const std::string next = level->rule();
    if (next == "still" || rule.find(next) != std::string::npos) continue;
    rule += (rule.empty() ? "" : "; ") + next;
  }
  return rule.empty() ? "still" : rule;
}

std::optional<Blame> InstanceChain::blame(std::size_t instance) const {
  for (const auto& level : levels_) {
    if (std::optional<Blame> found = level->blame(instance % level->count())) return found;
    instance /= level->count();
  }
  return std::nullopt;
}

InstanceChain::Instant InstanceChain::at(double time01, double within) const {
  Instant instant;
  for (const auto& level : levels_) {
    instant.levels_.push_back(level->at(time01, within));
    instant.counts_.push_back(level->count());
  }
  return instant;
}

Affine3d InstanceChain::Instant::map(std::size_t instance) const {
  Affine3d result;
  for (std::size_t i = 0; i < levels_.size(); ++i) {
    const Affine3d own = levels_[i]->map(instance % counts_[i]);
    result = i == 0 ? own : own * result;
    instance /= counts_[i];
  }
  return result;
}

}  // namespace msbvh::translate
