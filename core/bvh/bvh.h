// A built tree: what traversal reads, immutable.
#pragma once

#include <memory>
#include <vector>

#include "core/base/affine.h"
#include "core/base/aligned_buffer.h"
#include "core/base/box.h"
#include "core/build/reference.h"
#include "core/bvh/layout.h"
#include "core/bvh/statistics.h"
#include "core/geometry/triangle_mesh.h"

namespace msbvh {

class Bvh;

// An instance of another tree; `keys` are key_count(segments) maps from the object's space to the tree's.
struct Instance {
  std::shared_ptr<const Bvh> object;
  std::uint32_t segments = 0;
  std::uint32_t first_key = 0;  // in Bvh::instance_keys
};

class Bvh {
 public:
  // Kept alive: indexed blocks read the meshes' tracks.
  std::vector<std::shared_ptr<const TriangleMesh>> meshes;
  std::vector<Instance> instances;
  std::vector<Affine3f> instance_keys;

  AlignedBuffer arena;
  ChildRef root = ChildRef::leaf(0);
  bool empty = true;  // nothing to hit; the arena is empty
  std::uint32_t root_segments = 0;
  std::vector<Box3f> root_bounds;  // at the keys of the root
  // What traversal must be ready for: nothing that moves in this tree or below its instances, no instances.
  bool moving = false;
  bool instanced = false;
  std::uint32_t max_level = 0;  // of nodes and blocks in this tree
  BvhStatistics statistics;

  const NodeHeader& node(ChildRef ref) const {
    return *reinterpret_cast<const NodeHeader*>(arena.data() + ref.offset());
  }
  const BlockHeader& block(ChildRef ref) const {
    return *reinterpret_cast<const BlockHeader*>(arena.data() + ref.offset());
  }
  const Affine3f* keys_of(const Instance& instance) const {
    return instance_keys.data() + instance.first_key;
  }
};

// The block that follows in the same leaf; block.last must be 0.
inline const BlockHeader* next_block(const BlockHeader* block) {
  const std::size_t bytes =
      block->kind == BlockKind::kInstance ? sizeof(BlockHeader) : triangle_block_bytes(block->level);
  return reinterpret_cast<const BlockHeader*>(reinterpret_cast<const std::byte*>(block) + bytes);
}

}  // namespace msbvh
