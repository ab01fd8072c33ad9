// Builds the subtree over a set whose motion is incoherent: object splits alone, weighed over the shutter.
#pragma once

#include "core/build/moving_set.h"
#include "core/build/settings.h"
#include "core/build/topology_slots.h"

namespace msbvh {

class MovingBuilder {
 public:
  MovingBuilder(const ShutterPose& pose, const BuildSettings& settings, TopologySlots& slots)
      : pose_(pose), settings_(settings), slots_(slots) {}
  void run(std::uint32_t node, std::span<const Reference> references, std::uint32_t depth);

 private:
  struct Set {
    std::span<MovingReference> references;
    MovingBounds bounds;
    std::uint32_t depth;
  };
  void build(std::uint32_t node, const Set& set);
  void build_alone(std::uint32_t node, const Set& set, NodeTaker& nodes);
  bool divide(std::uint32_t node, const Set& set, Set& left, Set& right);
  bool split(const Set& set, Set& left, Set& right) const;
  void make_leaf(std::uint32_t node, std::span<const MovingReference> references);

  const ShutterPose& pose_;
  const BuildSettings& settings_;
  TopologySlots& slots_;
  const MovingReference* first_ = nullptr;  // of all, and the place of its copy in the topology
  std::uint64_t first_place_ = 0;
};

}  // namespace msbvh
