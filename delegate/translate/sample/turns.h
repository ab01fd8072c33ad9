// How far a motion turns within the shutter, bounded by what is known of its ops: the rate at which it must
// be sampled.
//
// A motion that is sampled at even times alone may be back where it was at each of them: a rotor that makes
// four whole turns looks still at halves and quarters of the shutter. The ops say how far they turn, whatever
// the samples show. The front-end hands down their values; nothing here reads a stage.
#pragma once

#include <span>
#include <vector>

#include "core/base/vec.h"

namespace msbvh::translate {

// What is sampled so densely at least cannot pass for something slower, or for rest.
inline constexpr double kTimesATurn = 8.0;

// An upper bound on the whole turns that a motion has made since the shutter opened: linear between times.
class Turns {
 public:
  Turns() = default;  // none
  // Equally many increasing times, from 0 to 1, and totals, from 0 on and not decreasing; shares of the
  // shutter after which the motion may repeat. Throws Error for others.
  Turns(std::vector<double> times01, std::vector<double> total, std::vector<double> periods01 = {});

  // Of a product of both motions.
  Turns operator+(const Turns& other) const;

  bool none() const { return total_.back() == 0.0 && periods01_.empty(); }
  const std::vector<double>& times01() const { return times01_; }
  const std::vector<double>& total() const { return total_; }
  const std::vector<double>& periods01() const { return periods01_; }
  // Turns made by then.
  double at(double time01) const;
  // Between neighbours of increasing times, as if each stretch had throughout the largest rate that occurs in
  // it: how fast it is to be sampled evenly.
  std::vector<double> within(std::span<const double> ends01) const;
  // Turns a shutter at the fastest.
  double rate() const;

 private:
  std::vector<double> times01_{0.0, 1.0}, total_{0.0, 0.0}, periods01_;
};

// At a constant rate; none for what is not a positive number.
Turns uniform_turns(double turns);

// Of angles in degrees about `axes` axes, [time][axis], linear between the times. `loop_periods01`: of
// splines that repeat.
Turns angle_turns(std::vector<double> times01, std::span<const double> degrees, std::size_t axes,
                  std::span<const double> loop_periods01);

// Of quaternions of any length, interpolated along the shorter arc: half a turn between two of them at most.
struct Quatd {
  double i, j, k, real;
};
Turns orientation_turns(std::vector<double> times01, std::span<const Quatd> orientations);

// The most that a joint of a skeleton turns together with all that it hangs on, which turns it too: rotations
// are [time][joint], along the shorter arc; `parents` are one a joint, negative for none. None where a
// rotation is not finite, which others report. Throws Error for parents that are no joints, or hang on each
// other.
Turns joint_turns(std::vector<double> times01, std::span<const Quatd> rotations,
                  std::span<const int> parents);

// Those of the periods that are worth a track of their own (is_period() in time_layout.h).
std::vector<double> usable_periods01(std::span<const double> periods01);

}  // namespace msbvh::translate
