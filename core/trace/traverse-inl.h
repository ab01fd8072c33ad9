// The traversal of one ray: closest hit or any hit, one tree or two levels. One source for all of them; what
// a kernel does not need is not compiled into it.

#if defined(MSBVH_TRAVERSE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MSBVH_TRAVERSE_INL_H
#undef MSBVH_TRAVERSE_INL_H
#else
#define MSBVH_TRAVERSE_INL_H
#endif

#include <bit>
#include <hwy/highway.h>

#include "core/trace/trace_visit.h"
#include "core/trace/visit-inl.h"

HWY_BEFORE_NAMESPACE();
namespace msbvh::HWY_NAMESPACE {

template <Movement kMovement, LeafKinds kKinds, bool kAnyHit, bool kCount>
class Traversal {
  static constexpr bool kInstanced = kKinds.has(LeafKind::kInstances), kGrids = kKinds.has(LeafKind::kGrids);
  static constexpr bool kRound = kKinds.has(LeafKind::kCurves) || kKinds.has(LeafKind::kPoints);

 public:
  // `setup` is that of `ray` for `bvh`.
  HWY_INLINE Traversal(const Bvh& bvh, const Ray& ray, const RaySetup<kMovement>& setup,
                       std::uint32_t instance, Query& query, TraceCounts* counts)
      : bvh_(bvh), ray_(ray), setup_(setup), instance_(instance), query_(query), counts_(counts) {}

  void run() { run(root_of<kMovement>(bvh_, setup_)); }
  // An instance's object, from where the block says.
  void run_part(const BlockHeader& block) { run(entry_of<kMovement>(block, bvh_, setup_)); }
  HWY_INLINE void run(Place at) {
    for (;;) {
      while (!at.ref.is_leaf()) {
        if (!descend(at) && !pop(at)) return;
      }
      test_leaf(bvh_.block(at.ref));
      if (kAnyHit && query_.found) return;
      if (!pop(at)) return;
    }
  }

 private:
  static constexpr bool kMoving = kMovement != Movement::kStill;
  static constexpr bool kCompact = kKinds.has(LeafKind::kCompactTree);

  // Goes to the nearest child that is hit and leaves the others in a frame; where any hit will do, to the
  // first one. False: none is hit.
  HWY_INLINE bool descend(Place& at) {
    const NodeHeader& node = bvh_.node(at.ref);
    if constexpr (kCount) counts_->add({.instance = instance_, .at = at.ref, .nodes = 1});
    std::uint32_t hits;
    const ChildKeys keys = test_node<kMovement, kCompact>(node, at.form, setup_, query_.tfar, hits);
    if (hits == 0) return false;
    const std::uint32_t others = hits & (hits - 1);
    if (kAnyHit || others == 0) {
      at = child_of<false>(node, static_cast<std::uint32_t>(std::countr_zero(hits)) % kWidth);
    } else {
      at = child_of<false>(node, ChildKeys::slot(keys.take_nearest(top_->keys)));
    }
    if (!kAnyHit && others == 0) return true;
    top_->node = &node;
    top_->left = kAnyHit ? others : static_cast<std::uint32_t>(std::popcount(others));
    top_ += top_->left != 0;
    return true;
  }

  // The next child of the topmost frame: where the closest hit is wanted, the nearest. A frame whose nearest
  // is beyond the closest hit is done with.
  HWY_INLINE bool pop(Place& at) {
    while (top_ != stack_) {
      Frame& frame = top_[-1];
      if constexpr (kAnyHit) {
        at = child_of<false>(*frame.node, static_cast<std::uint32_t>(std::countr_zero(frame.left)) % kWidth);
        frame.left &= frame.left - 1;
        top_ -= frame.left == 0;
        return true;
      }
      const ChildKey key = ChildKeys::load(frame.keys).take_nearest(frame.keys);
      if (is_beyond(distance_of(key), query_.tfar)) {
        --top_;
        continue;
      }
      at = child_of<false>(*frame.node, ChildKeys::slot(key));
      top_ -= --frame.left == 0;
      return true;
    }
    return false;
  }

  HWY_INLINE void test_leaf(const BlockHeader& first) {
    for (const BlockHeader* block = &first;; block = next_block(block)) {
      if (kInstanced && block->kind == BlockKind::kInstance) {
        enter_instance(*block);
      } else if (kGrids && block->kind == BlockKind::kGrid) {
        visit_grid(*block);
      } else if (kRound && block->kind >= BlockKind::kCurves) {
        visit_round(*block);
      } else {
        if constexpr (kCount) count(*block, 0, 1, block->count);
        test_triangles<kMovement, kAnyHit, kCompact>(bvh_, *block, setup_, instance_, query_);
      }
      if ((kAnyHit && query_.found) || block->last) return;
    }
  }

  // The place of a block, as its parent knows it.
  ChildRef ref_of(const BlockHeader& block) const {
    const std::ptrdiff_t bytes = reinterpret_cast<const std::byte*>(&block) - bvh_.arena.data();
    return ChildRef::leaf(static_cast<std::uint32_t>(static_cast<std::size_t>(bytes) / kUnit));
  }
  // Only where kCount.
  void count(const BlockHeader& block, std::uint32_t nodes, std::uint32_t blocks, std::uint32_t primitives) {
    counts_->add({.instance = instance_,
                  .at = ref_of(block),
                  .nodes = nodes,
                  .blocks = blocks,
                  .primitives = primitives});
  }

  HWY_INLINE void visit_grid(const BlockHeader& block) {
    if constexpr (kGrids) {
      const std::uint32_t tiles = test_grid<kMovement, kAnyHit>(bvh_, block, setup_, instance_, query_);
      if constexpr (kCount) count(block, 1, tiles, 2 * kTileQuads * tiles);
    }
  }

  HWY_INLINE void visit_round(const BlockHeader& block) {
    if constexpr (kRound) {
      test_round<kMovement, kAnyHit>(bvh_, block, setup_, instance_, query_);
      if constexpr (kCount) count(block, 0, 1, block.count);
    }
  }

  // Not inlined: the stack of the inner traversal is the inner traversal's own.
  HWY_NOINLINE void enter_instance(const BlockHeader& block) {
    if constexpr (kInstanced) {
      const Instance& instance = bvh_.instances[block.owner];
      Ray local = ray_;
      if (!to_object<kMovement>(bvh_, instance, local)) return;
      if constexpr (kCount) counts_->add({.instance = instance_, .at = ref_of(block), .instances = 1});
      if (kMovement == Movement::kPolynomial && instance.object->movement == Movement::kPolynomial) {
        trace_object<Movement::kPolynomial>(instance, local, block);
      } else if (kMoving && instance.object->movement != Movement::kStill) {
        trace_object<Movement::kLinear>(instance, local, block);
      } else {
        trace_object<Movement::kStill>(instance, local, block);
      }
    }
  }
  template <Movement kObject>
  void trace_object(const Instance& instance, const Ray& local, const BlockHeader& block) {
    const RaySetup<kObject> setup(local, *instance.object);
    Traversal<kObject, kKinds.without(LeafKind::kInstances), kAnyHit, kCount>(*instance.object, local, setup,
                                                                              block.owner, query_, counts_)
        .run_part(block);
  }

  const Bvh& bvh_;
  const Ray& ray_;
  const RaySetup<kMovement>& setup_;
  const std::uint32_t instance_;
  Query& query_;
  TraceCounts* const counts_;
  Frame stack_[kMaxDepth + 1];  // at most one for each node on the way down
  Frame* top_ = stack_;
};

template <Movement kMovement, LeafKinds kKinds, bool kCount>
bool intersect(const Bvh& bvh, const Ray& ray, Hit& hit, TraceCounts* counts) {
  if constexpr (kCount) ++counts->rays;
  if (bvh.empty) return false;
  Query query(ray.tfar);
  const RaySetup<kMovement> setup(ray, bvh);
  Traversal<kMovement, kKinds, false, kCount>(bvh, ray, setup, kNoInstance, query, counts).run();
  if (query.found) hit = query.hit;
  return query.found;
}

template <Movement kMovement, LeafKinds kKinds, bool kCount>
bool occluded(const Bvh& bvh, const Ray& ray, TraceCounts* counts) {
  if constexpr (kCount) ++counts->rays;
  if (bvh.empty) return false;
  Query query(ray.tfar);
  const RaySetup<kMovement> setup(ray, bvh);
  Traversal<kMovement, kKinds, true, kCount>(bvh, ray, setup, kNoInstance, query, counts).run();
  return query.found;
}

}  // namespace msbvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
