// The next free places of a topology that several threads build.
#pragma once

#include <algorithm>
#include <atomic>

#include "core/build/topology.h"

namespace msbvh {

struct TopologySlots {
  Topology& topology;
  std::atomic<std::uint32_t> next_node{1};
  std::atomic<std::uint64_t> next_reference{0};
  std::atomic<std::uint64_t> leaf_references{0};
};

// Takes nodes by the run, so that threads do not wait for each other's counter.
class NodeTaker {
 public:
  // Below the root of a subtree over so many references there are two nodes fewer than two a reference, where
  // each is a leaf. No more are taken: a node that is not used here may be one too few elsewhere.
  NodeTaker(TopologySlots& slots, std::size_t references)
      : slots_(slots), left_(static_cast<std::uint32_t>(2 * references - 2)) {}
  std::uint32_t take_two() {
    if (next_ == end_) {
      const std::uint32_t run = std::min(kRun, left_);
      left_ -= run;
      next_ = slots_.next_node.fetch_add(run);
      end_ = next_ + run;
    }
    next_ += 2;
    return next_ - 2;
  }

 private:
  static constexpr std::uint32_t kRun = 64;
  TopologySlots& slots_;
  std::uint32_t next_ = 0, end_ = 0, left_;
};

// `area`: what it is to the SAH.
inline void write_node(BinaryNode& node, const Box4& box, float area) {
  const Box3f b = box.box();
  for (int axis = 0; axis < 3; ++axis) {
    node.lo[axis] = b.lo[axis];
    node.hi[axis] = b.hi[axis];
  }
  node.area = area;
}

}  // namespace msbvh
