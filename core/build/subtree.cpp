#include "core/build/subtree.h"

#include <algorithm>
#include <cstring>

namespace msbvh {
namespace {

// Nodes are taken by the run, so that threads do not wait for each other's counter.
constexpr std::uint32_t kNodesPerRun = 64;

}  // namespace

void set_box(BinaryNode& node, const Box4& box) {
  const Box3f b = box.box();
  for (int axis = 0; axis < 3; ++axis) {
    node.lo[axis] = b.lo[axis];
    node.hi[axis] = b.hi[axis];
  }
}

// The sets that wait are a stack at the low end of the memory, leaves are piled up at its high end. A set on
// top of the stack, hence with all the space behind it that splits below it may need, is always the next one.
// Together they never hold more references than the set and its room.
void SubtreeBuilder::run(std::uint32_t node, const WorkSet& set) {
  const std::size_t capacity = set.size() + set.room;
  Reference* const memory = slots_.topology.references.data() + slots_.next_reference.fetch_add(capacity);
  std::memcpy(memory, set.references.data(), set.size() * sizeof(Reference));
  leaves_ = memory + capacity;
  nodes_left_ = static_cast<std::uint32_t>(2 * capacity);
  WorkSet mine = set;
  mine.references = {memory, set.size()};
  build(node, mine);
  slots_.leaf_references += leaf_references_;
}

void SubtreeBuilder::build(std::uint32_t node, const WorkSet& set) {
  BinaryNode& out = slots_.topology.nodes[node];
  set_box(out, set.bounds.box);
  WorkSet left, right;
  {
    const SplitChoice choice = splitter_.choose(set);
    if (choice.kind == SplitKind::kLeaf) return make_leaf(node, set.references);
    splitter_.divide(set, choice, left, right);
  }
  const std::uint32_t children = take_two_nodes();
  out.first = children;
  out.count = 0;
  build(children + 1, right);
  build(children, left);
}

void SubtreeBuilder::make_leaf(std::uint32_t node, std::span<const Reference> references) {
  leaves_ -= references.size();
  std::memmove(leaves_, references.data(), references.size() * sizeof(Reference));
  leaf_references_ += references.size();
  BinaryNode& out = slots_.topology.nodes[node];
  out.first = static_cast<std::uint32_t>(leaves_ - slots_.topology.references.data());
  out.count = static_cast<std::uint32_t>(references.size());
}

std::uint32_t SubtreeBuilder::take_two_nodes() {
  if (next_node_ == nodes_end_) {
    const std::uint32_t run = std::min(kNodesPerRun, nodes_left_);
    nodes_left_ -= run;
    next_node_ = slots_.next_node.fetch_add(run);
    nodes_end_ = next_node_ + run;
  }
  next_node_ += 2;
  return next_node_ - 2;
}

}  // namespace msbvh
