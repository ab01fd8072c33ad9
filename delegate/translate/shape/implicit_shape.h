// An implicit prim over the shutter.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/base/box.h"
#include "delegate/translate/diagnostics.h"
#include "delegate/translate/shape/implicit_type.h"
#include "delegate/translate/shape/surface.h"

namespace msbvh::translate {

// As a front-end has looked it up.
struct ImplicitInput {
  std::string path;  // of the prim, for messages
  ImplicitKind kind = ImplicitKind::kSphere;
  std::string axis = "Z";  // the token; it holds for all times
  // The type's parameters at some times: the frame's and those of the samples.
  std::vector<std::vector<double>> values;
};

// Whether parameters are numbers that a shape can be made of: finite, 2^60 in size at most. Negative ones
// are: they turn a shape inside out.
bool check_parameters(ImplicitKind kind, std::span<const double> values, PrimLog& log);

// A mesh at as many sides as its size calls for (sides.h).
class ImplicitShape {
 public:
  // Nothing, with an error, where check_parameters() fails. An unknown axis counts as z, with a warning.
  static std::optional<ImplicitShape> make(ImplicitInput input, PrimLog& log);

  ImplicitKind kind() const { return kind_; }
  std::size_t time_count() const { return values_.size(); }
  // The largest around the axis, at any of the times; 0 where there is none.
  double radius() const;
  // Over all of the times. The fewest sides that the policy knows reach as far along every axis as the true
  // shape does.
  Box3d box(int sides) const;
  // At time number `time`.
  Surface surface(std::size_t time, int sides) const;

 private:
  ImplicitShape(ImplicitKind kind, Axis axis, std::vector<std::vector<double>> values)
      : kind_(kind), axis_(axis), values_(std::move(values)) {}

  ImplicitKind kind_;
  Axis axis_;
  std::vector<std::vector<double>> values_;  // by time
};

}  // namespace msbvh::translate
