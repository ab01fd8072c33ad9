#include "core/cost/tree_owners.h"

namespace msbvh {
namespace {

std::uint32_t of_leaf(const Bvh& tree, ChildRef leaf, const TreeOwners::OwnerOfBlock& owner_of_block) {
  std::uint32_t owner = kOwnedByNone;
  for (const BlockHeader* block = &tree.block(leaf);; block = next_block(block)) {
    owner = common_owner(owner, owner_of_block(*block));
    if (block->last) return owner;
  }
}

}  // namespace

TreeOwners::TreeOwners(const Bvh& tree, const OwnerOfBlock& owner_of_block)
    : owners_(tree.arena.size() / AlignedBuffer::kAlignment + 1, kOwnedByNone) {
  if (tree.empty) return;
  if (tree.slice_roots.empty()) of_root_ = visit(tree, tree.root, owner_of_block);
  for (const SliceRoot& root : tree.slice_roots)
    of_root_ = common_owner(of_root_, visit(tree, root.ref, owner_of_block));
}

// As deep as kMaxDepth.
std::uint32_t TreeOwners::visit(const Bvh& tree, ChildRef ref, const OwnerOfBlock& owner_of_block) {
  if (ref.is_leaf()) return of_leaf(tree, ref, owner_of_block);
  const NodeHeader& node = tree.node(ref);
  std::uint32_t owner = kOwnedByNone;
  for (std::uint32_t i = 0; i < node.child_count; ++i)
    owner = common_owner(owner, visit(tree, node.child[i], owner_of_block));
  return owners_[place(ref)] = owner;
}

}  // namespace msbvh
