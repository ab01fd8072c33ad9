// The split at the root that parts what moves from what stands still.
//
// A node that has anything moving below it is interpolated for every ray, and rays at different times read
// different keys of it. Where little moves, in a small part of the scene, the nodes on the way there are many
// rays' way to everything else as well. Parted at the root, all of them are still, and a wide node's eight
// children hide the level that the split adds.
#pragma once

#include <span>

#include "core/build/reference.h"

namespace msbvh {

// Whether something moves that is few of the references and, over the whole shutter, in a small part of the
// root's box.
bool moves_in_a_corner(const Primitives& primitives, std::span<const Reference> references);

// The split's predicate: what stands still goes left.
class IsStill {
 public:
  explicit IsStill(const Primitives& primitives) : primitives_(&primitives) {}
  template <typename Box>
  bool operator()(const Box&, const Reference& reference) const {
    return !node_form_of(*primitives_, reference).moving();
  }

 private:
  const Primitives* primitives_;
};

}  // namespace msbvh
