// How things move, as a front-end evaluates it: the translator says when.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "delegate/translate/inputs.h"
#include "delegate/translate/sample/turns.h"

namespace msbvh::translate {

// The transforms of things that move together over the shutter: prims, or a point instancer's instances.
class MotionSource {
 public:
  virtual ~MotionSource() = default;

  virtual std::size_t count() const = 0;
  // It is the same at any time.
  virtual bool still() const = 0;
  // Authored times inside the shutter, increasing: where the motion may change its course or, on a held
  // stage, its place.
  virtual std::vector<double> breakpoints01() const = 0;
  // Matrices jump at the breakpoints, and are the same in between: a held stage, where the front-end does not
  // know it of all that it reads.
  virtual bool held() const { return false; }
  // How far thing number `which` turns at most.
  virtual Turns turns(std::uint32_t which) const = 0;
  // `out` is [time][which]. Elements may be anything, NaN included.
  virtual void evaluate(std::span<const double> times01, std::span<const std::uint32_t> which,
                        std::span<Matrix4d> out) const = 0;
};

}  // namespace msbvh::translate
