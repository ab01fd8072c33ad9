// Whose geometry stands below each node of a tree.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/base/aligned_buffer.h"
#include "core/bvh/bvh.h"

namespace msbvh {

// An owner is a row (core/cost/scene_rows.h), or one of these: nothing stands there; geometry of several rows
// does.
inline constexpr std::uint32_t kOwnedByNone = 0xffffffffu, kOwnedByMany = 0xfffffffeu;

// Of what two owners hold together.
constexpr std::uint32_t common_owner(std::uint32_t a, std::uint32_t b) {
  if (a == b || b == kOwnedByNone) return a;
  return a == kOwnedByNone ? b : kOwnedByMany;
}

class TreeOwners {
 public:
  // The owner of a leaf's block. Asked once for each block of the tree while the owners are made.
  using OwnerOfBlock = std::function<std::uint32_t(const BlockHeader&)>;

  // Takes 4 bytes for every 64 of the tree's arena.
  TreeOwners(const Bvh& tree, const OwnerOfBlock& owner_of_block);

  std::uint32_t of_node(ChildRef node) const { return owners_[place(node)]; }
  std::uint32_t of_root() const { return of_root_; }

 private:
  static std::size_t place(ChildRef node) { return node.offset() / AlignedBuffer::kAlignment; }
  std::uint32_t visit(const Bvh& tree, ChildRef ref, const OwnerOfBlock& owner_of_block);

  std::vector<std::uint32_t> owners_;  // by nodes' places
  std::uint32_t of_root_ = kOwnedByNone;
};

}  // namespace msbvh
