// Builds a subtree on the calling thread, in memory that it has for itself.
#pragma once

#include "core/build/splitter.h"
#include "core/build/topology_slots.h"

namespace msbvh {

class SubtreeBuilder {
 public:
  SubtreeBuilder(const Splitter& splitter, TopologySlots& slots) : splitter_(splitter), slots_(slots) {}
  // Copies the set's references first; those of leaves are final.
  void run(std::uint32_t node, const WorkSet& set);

 private:
  void build(std::uint32_t node, const WorkSet& set, NodeTaker& nodes);
  void make_leaf(std::uint32_t node, std::span<const Reference> references);

  const Splitter& splitter_;
  TopologySlots& slots_;
  Reference* leaves_ = nullptr;  // the lowest of those made so far
  std::uint64_t leaf_references_ = 0;
};

}  // namespace msbvh
