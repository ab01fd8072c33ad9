#include "core/build/subtree.h"

#include <cstring>

namespace msbvh {
// The sets that wait are a stack at the low end of the memory, leaves are piled up at its high end. A set on
// top of the stack, hence with all the space behind it that splits below it may need, is always the next one.
// Together they never hold more references than the set and its room.
void SubtreeBuilder::run(std::uint32_t node, const WorkSet& set) {
  const std::size_t capacity = set.size() + set.room;
  Reference* const memory = slots_.topology.references.data() + slots_.next_reference.fetch_add(capacity);
  std::memcpy(memory, set.references.data(), set.size() * sizeof(Reference));
  leaves_ = memory + capacity;
  WorkSet mine = set;
  mine.references = {memory, set.size()};
  NodeTaker nodes(slots_, capacity);
  build(node, mine, nodes);
  slots_.leaf_references += leaf_references_;
}

void SubtreeBuilder::build(std::uint32_t node, const WorkSet& set, NodeTaker& nodes) {
  BinaryNode& out = slots_.topology.nodes[node];
  write_node(out, set.bounds.box, half_area(set.bounds.box));
  WorkSet left, right;
  {
    const SplitChoice choice = splitter_.choose(set);
    if (choice.kind == SplitKind::kLeaf) return make_leaf(node, set.references);
    splitter_.divide(set, choice, left, right);
  }
  const std::uint32_t children = nodes.take_two();
  out.first = children;
  out.count = 0;
  build(children + 1, right, nodes);
  build(children, left, nodes);
}

void SubtreeBuilder::make_leaf(std::uint32_t node, std::span<const Reference> references) {
  leaves_ -= references.size();
  std::memmove(leaves_, references.data(), references.size() * sizeof(Reference));
  leaf_references_ += references.size();
  BinaryNode& out = slots_.topology.nodes[node];
  out.first = static_cast<std::uint32_t>(leaves_ - slots_.topology.references.data());
  out.count = static_cast<std::uint32_t>(references.size());
}

}  // namespace msbvh
