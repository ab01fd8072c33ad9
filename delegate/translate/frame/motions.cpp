#include "delegate/translate/frame/motions.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <string>

#include "core/base/error.h"
#include "core/base/lerp.h"
#include "delegate/translate/frame/held_values.h"
#include "delegate/translate/sample/even_times.h"

namespace msbvh::translate {
namespace {

bool inside(double time01) { return time01 > 0.0 && time01 < 1.0; }

Matrix4d unknown() {
  Matrix4d matrix;
  matrix.fill(std::numeric_limits<double>::quiet_NaN());
  return matrix;
}

}  // namespace

Matrix4d product(const Matrix4d& a, const Matrix4d& b) {
  Matrix4d result{};
  for (std::size_t row = 0; row < 4; ++row) {
    for (std::size_t column = 0; column < 4; ++column) {
      for (std::size_t k = 0; k < 4; ++k) result[row * 4 + column] += a[row * 4 + k] * b[k * 4 + column];
    }
  }
  return result;
}

std::vector<Matrix4d> matrices_at(const MotionSource& motion, std::span<const double> times01) {
  std::vector<std::uint32_t> every(motion.count());
  std::iota(every.begin(), every.end(), 0u);
  std::vector<Matrix4d> matrices(times01.size() * every.size());
  motion.evaluate(times01, every, matrices);
  return matrices;
}

std::vector<double> few_times01(const MotionSource& motion) {
  if (motion.still()) return {0.0};
  double fastest = 0.0;
  for (std::uint32_t i = 0; i < motion.count(); ++i) fastest = std::max(fastest, motion.turns(i).rate());
  return dense_times01(Density::kGlance, fastest, motion.breakpoints01(), motion.held());
}

SampledMotion::SampledMotion(std::vector<double> times01, std::vector<Matrix4d> matrices, std::size_t count,
                             bool held)
    : times01_(std::move(times01)), matrices_(std::move(matrices)), count_(count), held_(held) {
  if (times01_.empty() || matrices_.size() != times01_.size() * count_) {
    throw Error("matrices: found " + std::to_string(matrices_.size()) + "; expected " +
                std::to_string(count_) + " at each of " + std::to_string(times01_.size()) + " times");
  }
}

MotionPointer SampledMotion::still(const Matrix4d& matrix) {
  return std::make_shared<SampledMotion>(std::vector{0.0}, std::vector{matrix});
}

bool SampledMotion::still() const {
  for (std::size_t i = count_; i < matrices_.size(); ++i) {
    if (matrices_[i] != matrices_[i - count_]) return false;
  }
  return true;
}

std::vector<double> SampledMotion::breakpoints01() const {
  std::vector<double> found;
  std::ranges::copy_if(times01_, std::back_inserter(found), inside);
  return found;
}

void SampledMotion::evaluate(std::span<const double> times01, std::span<const std::uint32_t> which,
                             std::span<Matrix4d> out) const {
  for (std::size_t t = 0; t < times01.size(); ++t) {
    const auto after = std::size_t(std::ranges::upper_bound(times01_, times01[t]) - times01_.begin());
    const std::size_t first = after == 0 ? 0 : after - 1, second = std::min(after, times01_.size() - 1);
    const double length = times01_[second] - times01_[first];
    const double w = length > 0.0 && !held_ ? (times01[t] - times01_[first]) / length : 0.0;
    for (std::size_t i = 0; i < which.size(); ++i) {
      const Matrix4d& a = matrices_[first * count_ + which[i]];
      const Matrix4d& b = matrices_[second * count_ + which[i]];
      Matrix4d& mixed = out[t * which.size() + i];
      for (std::size_t k = 0; k < mixed.size(); ++k) mixed[k] = w == 0.0 ? a[k] : lerp(a[k], b[k], w);
    }
  }
}

EvaluatedMotion::EvaluatedMotion(std::size_t count, bool still, std::vector<double> times01,
                                 Evaluate evaluate, Turns turns)
    : count_(count), still_(still), evaluate_(std::move(evaluate)), turns_(std::move(turns)) {
  std::ranges::sort(times01);
  if (!still_ && holds_between(times01, evaluate_))
    breakpoints01_ = jumps01([&](double a, double b) { return evaluate_(a) == evaluate_(b); });
  held_ = !breakpoints01_.empty();
  if (held_) {
    turns_ = {};
  } else {
    std::ranges::copy_if(times01, std::back_inserter(breakpoints01_), inside);
  }
}

void EvaluatedMotion::evaluate(std::span<const double> times01, std::span<const std::uint32_t> which,
                               std::span<Matrix4d> out) const {
  for (std::size_t t = 0; t < times01.size(); ++t) {
    const std::vector<Matrix4d> every = evaluate_(times01[t]);
    for (std::size_t i = 0; i < which.size(); ++i)
      out[t * which.size() + i] = which[i] < every.size() ? every[which[i]] : unknown();
  }
}

std::vector<double> NestedMotion::breakpoints01() const {
  std::vector<double> both = inner_->breakpoints01();
  const std::vector<double> outer = outer_->breakpoints01();
  both.insert(both.end(), outer.begin(), outer.end());
  std::ranges::sort(both);
  both.erase(std::unique(both.begin(), both.end()), both.end());
  return both;
}

// Of one stage, whatever moves is held or not. What does not move is either.
bool NestedMotion::held() const {
  const auto follows = [](const MotionSource& each) { return each.held() || each.still(); };
  return (inner_->held() || outer_->held()) && follows(*inner_) && follows(*outer_);
}

Turns NestedMotion::turns(std::uint32_t which) const {
  const auto inner = std::uint32_t(inner_->count());
  return inner_->turns(which % inner) + outer_->turns(which / inner);
}

void NestedMotion::evaluate(std::span<const double> times01, std::span<const std::uint32_t> which,
                            std::span<Matrix4d> out) const {
  const std::size_t inner_count = inner_->count(), outer_count = outer_->count();
  const std::vector<Matrix4d> inner = matrices_at(*inner_, times01), outer = matrices_at(*outer_, times01);
  for (std::size_t t = 0; t < times01.size(); ++t) {
    for (std::size_t i = 0; i < which.size(); ++i) {
      out[t * which.size() + i] = product(inner[t * inner_count + which[i] % inner_count],
                                          outer[t * outer_count + which[i] / inner_count]);
    }
  }
}

SelectedMotion::SelectedMotion(MotionPointer every, std::vector<std::uint32_t> selected)
    : every_(std::move(every)), selected_(std::move(selected)) {
  for (const std::uint32_t number : selected_) {
    if (number >= every_->count()) {
      throw Error("instance indices: found " + std::to_string(number) + "; expected less than " +
                  std::to_string(every_->count()));
    }
  }
}

void SelectedMotion::evaluate(std::span<const double> times01, std::span<const std::uint32_t> which,
                              std::span<Matrix4d> out) const {
  std::vector<std::uint32_t> numbers;
  for (const std::uint32_t each : which) numbers.push_back(selected_[each]);
  every_->evaluate(times01, numbers, out);
}

}  // namespace msbvh::translate
