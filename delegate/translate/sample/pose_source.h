// How a skeleton poses a mesh, as a front-end evaluates it: the translator says when.
#pragma once

#include <span>
#include <vector>

#include "delegate/translate/inputs.h"
#include "delegate/translate/sample/turns.h"

namespace msbvh::translate {

// What moves a mesh at T times, in the layout of SkinningInput.
struct PoseValues {
  std::vector<Matrix4d> joints;  // [T][joint_count]; empty: blend shapes act alone
  std::vector<float> weights;    // [T][sub-shapes]; empty: there are none
  std::vector<Vec3f> rest;       // N points of the one time; empty: those of the frame
};

class PoseSource {
 public:
  virtual ~PoseSource() = default;

  // Nothing that acts on the mesh changes over the shutter.
  virtual bool still() const = 0;
  // Authored times of what acts on it, inside the shutter, increasing.
  virtual std::vector<double> breakpoints01() const = 0;
  // How far a joint turns at most, with all that it hangs on.
  virtual Turns turns() const = 0;
  // Whether the rest points change: then it is evaluated at one time after the other.
  virtual bool moves_rest() const = 0;
  // False where the values cannot be used, which the front-end has said.
  virtual bool evaluate(std::span<const double> times01, PoseValues& out) const = 0;
};

}  // namespace msbvh::translate
