// A built tree: what traversal reads, immutable. Copies share the arena: all that it knows of meshes are
// their ids, so that a copy may go on with meshes and objects that hold the same.
#pragma once

#include <memory>
#include <vector>

#include "core/base/affine.h"
#include "core/base/aligned_buffer.h"
#include "core/base/box.h"
#include "core/build/reference.h"
#include "core/build/settings.h"
#include "core/bvh/layout.h"
#include "core/bvh/leaf_kinds.h"
#include "core/bvh/statistics.h"
#include "core/geometry/grid_mesh.h"
#include "core/geometry/triangle_mesh.h"
#include "core/motion/time_remap.h"

namespace msbvh {

class Bvh;

// What kernels must be ready for.
enum class Movement : std::uint8_t { kStill, kLinear, kPolynomial };

inline constexpr std::uint32_t kNoTimeRemap = 0xffffffffu;

// An instance of another tree, whose form.controls() maps lead from the object's space to the tree's. Its
// time remap, if any, says when it is there and what time its maps are read at; what time it is in the object
// is the object's own affair (Bvh::time_remap).
struct Instance {
  std::shared_ptr<const Bvh> object;
  TrackForm form;
  std::uint32_t time_remap = kNoTimeRemap;  // in Bvh::time_remaps
  std::uint64_t first_control = 0;          // in Bvh::instance_controls
};

struct SliceRoot {
  ChildRef ref;
  FormCode form;
};

class Bvh {
 public:
  // Kept alive: indexed blocks and those of grids, curves and points read their tracks.
  std::vector<std::shared_ptr<const TriangleMesh>> meshes;
  std::vector<std::shared_ptr<const GridMesh>> grids;
  std::vector<std::shared_ptr<const CurveSet>> curves;
  std::vector<std::shared_ptr<const PointSet>> points;
  std::vector<Instance> instances;
  std::vector<Affine3f> instance_controls;
  std::vector<TimeRemap> time_remaps;  // of instances
  TimeRemap time_remap;                // of this tree as an object that is instanced
  Builder builder = Builder::kMsbvh;
  TreeLayout layout = TreeLayout::kFull;

  AlignedBuffer arena;
  ChildRef root = ChildRef::leaf(0);
  // Of a tree for each of equal slices of the shutter, and the level of so many segments; else none.
  std::vector<SliceRoot> slice_roots;
  std::uint32_t slice_level = 0;
  bool empty = true;  // nothing to hit; the arena is empty
  TrackForm root_form;
  FormCode root_form_code = FormCode::of({});
  std::vector<Box3f> root_bounds;        // at the controls of the root
  Movement movement = Movement::kStill;  // the most of this tree and of what its instances show
  LeafKinds leaf_kinds;                  // of this tree and of what its instances show
  bool still_parts = false;              // something moves, but some subtree of this tree is still
  std::uint32_t max_level = 0;           // of nodes and blocks in this tree
  BvhStatistics statistics;

  const NodeHeader& node(ChildRef ref) const {
    return *reinterpret_cast<const NodeHeader*>(arena.data() + ref.offset());
  }
  const BlockHeader& block(ChildRef ref) const {
    return *reinterpret_cast<const BlockHeader*>(arena.data() + ref.offset());
  }
  const Affine3f* controls_of(const Instance& instance) const {
    return instance_controls.data() + instance.first_control;
  }
  const TimeRemap* time_remap_of(const Instance& instance) const {
    return instance.time_remap == kNoTimeRemap ? nullptr : &time_remaps[instance.time_remap];
  }
};

// The block that follows in the same leaf; block.last must be 0, as it never is for a grid's.
inline const BlockHeader* next_block(const BlockHeader* block) {
  return reinterpret_cast<const BlockHeader*>(reinterpret_cast<const std::byte*>(block) +
                                              block->units * kUnit);
}

}  // namespace msbvh
