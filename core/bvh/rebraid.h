// Partial re-braiding: C. Benthin, S. Woop, I. Wald, A. Afra, "Improved Two-Level BVHs using Partial
// Re-Braiding", HPG 2017. Where large instances overlap, the outer tree refers to parts of them, subtrees of
// their objects, so that it can tell apart what lies in front.
#pragma once

#include <vector>

#include "core/bvh/bvh.h"

namespace msbvh {

// What the outer tree refers to, and its boxes in that tree's space.
struct InstanceParts {
  std::vector<InstancePart> parts;
  std::vector<InstanceBounds> bounds;

  bool braided(const Bvh& bvh) const { return parts.size() > bvh.instances.size(); }
};

// Each instance as a whole, in their order.
InstanceParts whole_instances(const Bvh& bvh);

// The parts of an instance are a cut through its object's tree: each leaf below one of them. The largest that
// overlap other instances are opened first, until settings.rebraid_budget is spent. `all` are
// whole_instances(). The same for any number of threads. Not for time slices, neither the tree's own nor
// those of an object.
InstanceParts rebraided(const Bvh& bvh, InstanceParts all, const BuildSettings& settings);

// The boxes of the parts that a topology was kept with, at this frame's keys. The objects must be the very
// trees that they were parts of.
InstanceParts kept_parts(const Bvh& bvh, std::vector<InstancePart> parts);

// The object's box below child `slot` of a node, as the node has it.
struct SlotTrack {
  TrackForm form;
  std::vector<Box3f> controls;

  SlotTrack(const NodeHeader& node, std::uint32_t slot);
};

// M(u) times what the slot holds: conservative, as bound_instance() is, since the slot is.
InstanceBounds bound_slot(const Bvh& bvh, const Instance& instance, const SlotTrack& slot);

}  // namespace msbvh
