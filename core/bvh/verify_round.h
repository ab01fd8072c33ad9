// verify()'s part for curves and points (core/bvh/verify.h): all that has some width is in a leaf, and lies
// in its box.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <utility>

#include "core/bvh/bvh.h"
#include "core/bvh/verify_slot.h"

namespace msbvh {

class RoundVerifier {
 public:
  explicit RoundVerifier(const Bvh& bvh, const TimeSlice& slice = {}) : bvh_(bvh), slice_(slice) {}

  // A leaf's block, and what the tree says that bounds it: each piece of a curve, or point, moved as its
  // vertices are, must lie in it. Throws Error.
  void add(const BlockHeader& block, const Slot& slot);
  // After all leaves: each span is there with all its pieces once, and each point.
  void finish() const;

 private:
  void check_piece(const CurveSet& curves, std::uint32_t code, const Slot& slot) const;
  void check_point(const PointSet& points, std::uint32_t point, const Slot& slot) const;

  std::reference_wrapper<const Bvh> bvh_;
  TimeSlice slice_;                                    // of the tree that is looked at
  using Id = std::pair<std::uint32_t, std::uint32_t>;  // set, and span or point
  std::map<Id, std::uint32_t> spans_;                  // how many eighths of each are in leaves
  std::map<Id, std::uint32_t> points_;
};

}  // namespace msbvh
