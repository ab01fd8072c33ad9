// Builds a subtree on the calling thread, in memory that it has for itself.
#pragma once

#include "core/build/splitter.h"
#include "core/build/topology.h"

namespace msbvh {

// The next free places of a topology that several threads build.
struct TopologySlots {
  Topology& topology;
  std::atomic<std::uint32_t> next_node{1};
  std::atomic<std::uint64_t> next_reference{0};
  std::atomic<std::uint64_t> leaf_references{0};
};

void set_box(BinaryNode& node, const Box4& box);

class SubtreeBuilder {
 public:
  SubtreeBuilder(const Splitter& splitter, TopologySlots& slots) : splitter_(splitter), slots_(slots) {}
  // Copies the set's references first; those of leaves are final.
  void run(std::uint32_t node, const WorkSet& set);

 private:
  void build(std::uint32_t node, const WorkSet& set);
  void make_leaf(std::uint32_t node, std::span<const Reference> references);
  std::uint32_t take_two_nodes();

  const Splitter& splitter_;
  TopologySlots& slots_;
  Reference* leaves_ = nullptr;  // the lowest of those made so far
  std::uint64_t leaf_references_ = 0;
  std::uint32_t next_node_ = 0, nodes_end_ = 0;
  std::uint32_t nodes_left_ = 0;  // that may be needed beyond these: two a reference, in all
};

}  // namespace msbvh
