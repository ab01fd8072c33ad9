// Motions made of samples, and of other motions.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "delegate/translate/sample/motion_source.h"

namespace msbvh::translate {

using MotionPointer = std::shared_ptr<const MotionSource>;

// Matrices at a few times, linear by element between them (`held`: each until the next) and held outside:
// what a host gives that evaluates nothing in between.
class SampledMotion : public MotionSource {
 public:
  // `matrices` are [time][count] at increasing times. Throws Error for another number of them.
  SampledMotion(std::vector<double> times01, std::vector<Matrix4d> matrices, std::size_t count = 1,
                bool held = false);
  static MotionPointer still(const Matrix4d& matrix);

  std::size_t count() const override { return count_; }
  // Compares values.
  bool still() const override;
  std::vector<double> breakpoints01() const override;
  bool held() const override { return held_; }
  Turns turns(std::uint32_t) const override { return {}; }  // lines do not turn
  void evaluate(std::span<const double> times01, std::span<const std::uint32_t> which,
                std::span<Matrix4d> out) const override;

 private:
  std::vector<double> times01_;
  std::vector<Matrix4d> matrices_;
  std::size_t count_;
  bool held_;
};

// Matrices that can be had at any time.
class EvaluatedMotion : public MotionSource {
 public:
  // Of all things at a time; less than `count` of them are an element that is no number each.
  using Evaluate = std::function<std::vector<Matrix4d>(double time01)>;

  // `turns`: of each thing, where anybody knows. Where the values turn out to be held between `times01`, they
  // jump where jumps01() (held_values.h) finds it; else those of `times01` that lie inside the shutter are
  // breakpoints.
  EvaluatedMotion(std::size_t count, bool still, std::vector<double> times01, Evaluate evaluate,
                  Turns turns = {});

  std::size_t count() const override { return count_; }
  bool still() const override { return still_; }
  std::vector<double> breakpoints01() const override { return breakpoints01_; }
  bool held() const override { return held_; }
  Turns turns(std::uint32_t) const override { return turns_; }
  void evaluate(std::span<const double> times01, std::span<const std::uint32_t> which,
                std::span<Matrix4d> out) const override;

 private:
  std::size_t count_;
  bool still_;
  bool held_ = false;
  std::vector<double> breakpoints01_;
  Evaluate evaluate_;
  Turns turns_;
};

// Each of `inner` under each of `outer`, the outer index first.
class NestedMotion : public MotionSource {
 public:
  NestedMotion(MotionPointer inner, MotionPointer outer)
      : inner_(std::move(inner)), outer_(std::move(outer)) {}

  std::size_t count() const override { return inner_->count() * outer_->count(); }
  bool still() const override { return inner_->still() && outer_->still(); }
  std::vector<double> breakpoints01() const override;
  bool held() const override;
  Turns turns(std::uint32_t which) const override;
  void evaluate(std::span<const double> times01, std::span<const std::uint32_t> which,
                std::span<Matrix4d> out) const override;

 private:
  MotionPointer inner_, outer_;
};

// Some of a motion's things, by number.
class SelectedMotion : public MotionSource {
 public:
  // Throws Error for a number that there is not.
  SelectedMotion(MotionPointer every, std::vector<std::uint32_t> selected);

  std::size_t count() const override { return selected_.size(); }
  bool still() const override { return every_->still(); }
  std::vector<double> breakpoints01() const override { return every_->breakpoints01(); }
  bool held() const override { return every_->held(); }
  Turns turns(std::uint32_t which) const override { return every_->turns(selected_[which]); }
  void evaluate(std::span<const double> times01, std::span<const std::uint32_t> which,
                std::span<Matrix4d> out) const override;

 private:
  MotionPointer every_;
  std::vector<std::uint32_t> selected_;
};

// The first matrix, then the second (row vectors: p' = p a b).
Matrix4d product(const Matrix4d& a, const Matrix4d& b);

// All things at times: [time][count].
std::vector<Matrix4d> matrices_at(const MotionSource& motion, std::span<const double> times01);

// A few times that show where things are; one where they are still.
std::vector<double> few_times01(const MotionSource& motion);

}  // namespace msbvh::translate
