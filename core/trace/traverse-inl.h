// The traversal loop: closest hit or any hit, one tree or two levels. One source for all of them; what a
// kernel does not need is not compiled into it.

#if defined(MSBVH_TRAVERSE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MSBVH_TRAVERSE_INL_H
#undef MSBVH_TRAVERSE_INL_H
#else
#define MSBVH_TRAVERSE_INL_H
#endif

#include <bit>
#include <hwy/highway.h>

#include "core/base/affine.h"
#include "core/trace/grid_test-inl.h"
#include "core/trace/node_test-inl.h"
#include "core/trace/triangle_test-inl.h"

HWY_BEFORE_NAMESPACE();
namespace msbvh::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Distance in the upper, child in the lower half: distances are not negative, so entries order as integers.
using StackEntry = std::uint64_t;
HWY_INLINE StackEntry stack_entry(float distance, ChildRef child) {
  return (StackEntry(std::bit_cast<std::uint32_t>(distance)) << 32) | child.bits;
}
HWY_INLINE ChildRef child_of(StackEntry e) { return {static_cast<std::uint32_t>(e)}; }
HWY_INLINE float distance_of(StackEntry e) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(e >> 32));
}

struct Query {
  explicit Query(float farthest) : tfar(farthest) {}
  float tfar;  // of the closest hit so far
  bool found = false;
  Hit hit;
};

template <Movement kMovement, bool kInstanced, bool kGrids, bool kAnyHit, bool kCount>
class Traversal {
 public:
  Traversal(const Bvh& bvh, const Ray& ray, std::uint32_t instance, Query& query, TraceCounts* counts)
      : bvh_(bvh),
        ray_(ray),
        setup_(ray, bvh.max_level),
        instance_(instance),
        query_(query),
        counts_(counts) {}

  void run() {
    ChildRef current = bvh_.root;
    for (;;) {
      while (!current.is_leaf()) {
        if (!descend(current) && !pop(current)) return;
      }
      test_leaf(bvh_.block(current));
      if (kAnyHit && query_.found) return;
      if (!pop(current)) return;
    }
  }

 private:
  static constexpr bool kMoving = kMovement != Movement::kStill;

  // Goes to the nearest child that is hit, the others onto the stack, the nearest on top. False: none is hit.
  HWY_INLINE bool descend(ChildRef& current) {
    const NodeHeader& node = bvh_.node(current);
    HWY_ALIGN float distance[kWidth];
    std::uint32_t hits = test_node<kMovement>(node, setup_, query_.tfar, distance);
    if constexpr (kCount) ++counts_->nodes;
    if (hits == 0) return false;
    const std::uint32_t first = static_cast<std::uint32_t>(std::countr_zero(hits));
    hits &= hits - 1;
    if (hits == 0) {
      current = node.child[first];
      return true;
    }
    StackEntry* const base = top_;
    *top_++ = stack_entry(distance[first], node.child[first]);
    do {
      const std::uint32_t i = static_cast<std::uint32_t>(std::countr_zero(hits));
      hits &= hits - 1;
      push_sorted(base, stack_entry(distance[i], node.child[i]));
    } while (hits != 0);
    current = child_of(*--top_);
    return true;
  }

  HWY_INLINE void push_sorted(StackEntry* base, StackEntry entry) {
    StackEntry* at = top_++;
    if constexpr (!kAnyHit) {
      for (; at > base && at[-1] < entry; --at) *at = at[-1];
    }
    *at = entry;
  }

  HWY_INLINE bool pop(ChildRef& current) {
    while (top_ != stack_) {
      const StackEntry e = *--top_;
      if (distance_of(e) <= query_.tfar) {
        current = child_of(e);
        return true;
      }
    }
    return false;
  }

  HWY_INLINE void test_leaf(const BlockHeader& first) {
    for (const BlockHeader* block = &first;; block = next_block(block)) {
      if (kInstanced && block->kind == BlockKind::kInstance) {
        enter_instance(block->triangle[0]);
      } else if (kGrids && block->kind == BlockKind::kGrid) {
        test_grid(*block);
      } else {
        test_triangles(*block);
      }
      if ((kAnyHit && query_.found) || block->last) return;
    }
  }

  HWY_INLINE void test_triangles(const BlockHeader& block) {
    if constexpr (kCount) {
      ++counts_->blocks;
      counts_->triangles += block.count;
    }
    BlockHit hit;
    test_block<kMovement>(bvh_, block, setup_, query_.tfar, hit);
    for (std::uint32_t lanes = hit.lanes; lanes != 0; lanes &= lanes - 1) {
      const int i = std::countr_zero(lanes);
      if (kAnyHit) {
        query_.found = true;
        return;
      }
      take({hit.t[i], hit.u[i], hit.v[i], block.triangle[i], block.mesh[i], instance_});
    }
  }

  HWY_INLINE void take(const Hit& candidate) {
    if (query_.found && !closer(candidate, query_.hit)) return;
    query_.found = true;
    query_.hit = candidate;
    query_.tfar = candidate.t;
  }

  // Not inlined: the loop over triangles' blocks keeps its registers.
  HWY_NOINLINE void test_grid(const BlockHeader& block) {
    if constexpr (kGrids) {
      const GridTest<kMovement> grid(bvh_, block, setup_);
      HWY_ALIGN float distance[kWidth];
      std::uint32_t tiles = grid.tiles(query_.tfar, distance);
      for (; tiles != 0; tiles &= tiles - 1) {
        const auto tile = static_cast<std::uint32_t>(std::countr_zero(tiles));
        if (!(distance[tile] <= query_.tfar)) continue;
        test_tile(grid, tile);
        if (kAnyHit && query_.found) return;
      }
    }
  }
  HWY_INLINE void test_tile(const GridTest<kMovement>& grid, std::uint32_t tile) {
    if constexpr (kCount) {
      ++counts_->blocks;
      counts_->triangles += 2 * kTileLanes;
    }
    for (std::size_t pass = 0; pass < grid.passes(); ++pass) {
      TileHit hit[2];
      grid.test(tile, pass, query_.tfar, hit);
      for (std::uint32_t half = 0; half < 2; ++half) {
        for (std::uint32_t lanes = hit[half].lanes; lanes != 0; lanes &= lanes - 1) {
          const auto i = static_cast<std::uint32_t>(std::countr_zero(lanes));
          if (kAnyHit) {
            query_.found = true;
            return;
          }
          take({hit[half].t[i], hit[half].u[i], hit[half].v[i], grid.triangle_id(tile, pass, i, half),
                grid.mesh() | kGridMesh, instance_});
        }
      }
    }
  }

  // At equal distance, the one with the lowest ids: the answer does not depend on the shape of the tree.
  static bool closer(const Hit& a, const Hit& b) {
    if (a.t != b.t) return a.t < b.t;
    if (a.instance != b.instance) return a.instance < b.instance;
    return a.mesh != b.mesh ? a.mesh < b.mesh : a.triangle < b.triangle;
  }

  // Not inlined: the stack of the inner traversal is the inner traversal's own.
  HWY_NOINLINE void enter_instance(std::uint32_t id) {
    if constexpr (kInstanced) {
      const Instance& instance = bvh_.instances[id];
      Ray local = ray_;
      if (instance.object->empty || !is_there(instance, local) || !to_object_space(instance, local)) return;
      if constexpr (kCount) ++counts_->instances;
      if (kMovement == Movement::kPolynomial && instance.object->movement == Movement::kPolynomial) {
        trace_object<Movement::kPolynomial>(instance, local, id);
      } else if (kMoving && instance.object->movement != Movement::kStill) {
        trace_object<Movement::kLinear>(instance, local, id);
      } else {
        trace_object<Movement::kStill>(instance, local, id);
      }
    }
  }
  template <Movement kObject>
  void trace_object(const Instance& instance, const Ray& local, std::uint32_t id) {
    Traversal<kObject, false, kGrids, kAnyHit, kCount>(*instance.object, local, id, query_, counts_).run();
  }

  // Whether the object is there at the ray's time; the ray's time in the object's own time.
  static bool is_there(const Instance& instance, Ray& local) {
    if (!kMoving || instance.object->clock.is_shutter()) return true;
    return instance.object->clock.at(clamped_time(local.time), local.time);
  }

  // The ray in the object's space: matrix elements interpolated in single precision, inverted and applied in
  // double. The parameter t keeps its meaning. False where the map is singular at this time, or the instance
  // not there: nothing can be hit.
  bool to_object_space(const Instance& instance, Ray& local) const {
    const D4 d;
    const Affine3f* controls = bvh_.controls_of(instance);
    Affine3f map = *controls;
    float u = clamped_time(ray_.time);
    if (kMoving && instance.clock != kNoClock && !bvh_.clocks[instance.clock].at(u, u)) return false;
    if (kMoving && instance.form.moving()) {
      const std::uint32_t degree = kMovement == Movement::kPolynomial ? instance.form.degree : 1;
      const SegmentTime at = locate(u, instance.form.segments);
      const Affine3f* first = controls + at.key * degree;
      const Weights<D4> w(d, at.w);
      static_assert(sizeof(Affine3f) == 12 * sizeof(float));
      for (int i = 0; i < 12; i += 4) {
        const auto control = [&](std::uint32_t c) { return hn::LoadU(d, &first[c].x.x + i); };
        hn::StoreU(simd_bezier(control, degree, w), d, &map.x.x + i);
      }
    }
    const Affine3d world_from_object(map);
    if (world_from_object.determinant() == 0.0) return false;
    const Affine3d object_from_world = inverse(world_from_object);
    local.org = Vec3f(object_from_world.point(Vec3d(ray_.org)));
    local.dir = Vec3f(object_from_world.vector(Vec3d(ray_.dir)));
    return true;
  }

  const Bvh& bvh_;
  const Ray& ray_;
  const RaySetup<kMovement> setup_;
  const std::uint32_t instance_;
  Query& query_;
  TraceCounts* const counts_;
  StackEntry stack_[(kWidth - 1) * kMaxDepth + 1];
  StackEntry* top_ = stack_;
};

template <Movement kMovement, bool kInstanced, bool kGrids, bool kCount>
bool intersect(const Bvh& bvh, const Ray& ray, Hit& hit, TraceCounts* counts) {
  if constexpr (kCount) ++counts->rays;
  if (bvh.empty) return false;
  Query query(ray.tfar);
  Traversal<kMovement, kInstanced, kGrids, false, kCount>(bvh, ray, kNoInstance, query, counts).run();
  if (query.found) hit = query.hit;
  return query.found;
}

template <Movement kMovement, bool kInstanced, bool kGrids, bool kCount>
bool occluded(const Bvh& bvh, const Ray& ray, TraceCounts* counts) {
  if constexpr (kCount) ++counts->rays;
  if (bvh.empty) return false;
  Query query(ray.tfar);
  Traversal<kMovement, kInstanced, kGrids, true, kCount>(bvh, ray, kNoInstance, query, counts).run();
  return query.found;
}

}  // namespace msbvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
