// What both ways of walking a tree share, one ray (core/trace/traverse-inl.h) and many interleaved
// (core/trace/stream-inl.h): places in a tree, the stack's frames, leaves, the step into an instance.

#if defined(MSBVH_VISIT_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MSBVH_VISIT_INL_H
#undef MSBVH_VISIT_INL_H
#else
#define MSBVH_VISIT_INL_H
#endif

#include <bit>
#include <hwy/highway.h>

#include "core/base/affine.h"
#include "core/bvh/known_kinds.h"
#include "core/trace/curve_test-inl.h"
#include "core/trace/grid_test-inl.h"
#include "core/trace/node_test-inl.h"
#include "core/trace/point_test-inl.h"
#include "core/trace/triangle_test-inl.h"

HWY_BEFORE_NAMESPACE();
namespace msbvh::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

struct Query {
  Query() = default;
  explicit Query(float farthest) : tfar(farthest) {}
  float tfar = 0.0f;  // of the closest hit so far
  bool found = false;
  Hit hit;
};

// A child, and how it moves.
struct Place {
  ChildRef ref;
  FormCode form;
  bool still = false;  // triangles alone, and none moves: steps that know no time will do
};
// `kMixed`: there are still subtrees among what moves.
template <bool kMixed>
HWY_INLINE Place child_of(const NodeHeader& node, std::uint32_t slot) {
  return {node.child[slot], node.child_form[slot], kMixed && (node.still_children >> slot & 1u) != 0};
}

// Where a ray's way begins.
template <Movement kMovement>
HWY_INLINE Place root_of(const Bvh& bvh, const RaySetup<kMovement>& setup) {
  if (kMovement == Movement::kStill || bvh.slice_roots.empty()) return {bvh.root, bvh.root_form_code};
  const SliceRoot& root = bvh.slice_roots[setup.at_level[bvh.slice_level].key];
  return {root.ref, root.form};
}

// Where it begins in an instance's object.
template <Movement kMovement>
HWY_INLINE Place entry_of(const BlockHeader& block, const Bvh& object, const RaySetup<kMovement>& setup) {
  if (block.is_part) return {block.part(), block.form_code};
  return root_of<kMovement>(object, setup);
}

// What a ray reads at a place: from where it starts, and what is in force at its time: of a node the boxes,
// of a leaf the first vertices.
struct Spot {
  const std::byte* start;
  const std::byte* control;

  const NodeHeader& node() const { return *reinterpret_cast<const NodeHeader*>(start); }
  const BlockHeader& block() const { return *reinterpret_cast<const BlockHeader*>(start); }
  const NodeBounds* bounds() const { return reinterpret_cast<const NodeBounds*>(control); }
  const CompactBounds* compact_bounds() const { return reinterpret_cast<const CompactBounds*>(control); }
};
template <Movement kMovement>
HWY_INLINE Spot spot_of(const Bvh& bvh, Place at, const RaySetup<kMovement>& setup) {
  const std::byte* start = bvh.arena.data() + at.ref.offset();
  const std::byte* control = start + sizeof(NodeHeader);  // about what stands before a block's vertices, too
  if constexpr (kMovement != Movement::kStill) {
    const std::uint32_t degree = kMovement == Movement::kPolynomial ? at.form.degree() : 1;
    // No branch: what comes next, a node or a leaf, moving or still, is what a processor cannot guess.
    control += setup.at_level[at.form.level()].key * degree * at.form.control_bytes();
  }
  return {start, control};
}
// A node's boxes at the controls that a ray reads. Compact ones may begin in the middle of a line.
template <Movement kMovement, bool kCompact>
inline constexpr std::size_t kLinesAhead = kCompact ? (kMovement == Movement::kStill    ? 2
                                                       : kMovement == Movement::kLinear ? 4
                                                                                        : 6)
                                                    : (kMovement == Movement::kStill ? 3 : 6);
template <Movement kMovement, bool kCompact>
HWY_INLINE void prefetch(Spot spot) {
  __builtin_prefetch(spot.start);
  constexpr std::size_t kLines = kLinesAhead<kMovement, kCompact>;
  for (std::size_t line = 0; line < kLines; ++line) __builtin_prefetch(spot.control + 64 * line);
}

// The children of a node that are still to be visited.
struct alignas(64) Frame {
  ChildKey keys[kWidth];
  const NodeHeader* node;
  std::uint32_t
      left;  // how many of the keys are not kNoChild; or, where any hit will do, a bit for each child
};

// At equal distance, the one with the lowest ids: the answer does not depend on the shape of the tree.
HWY_INLINE bool closer(const Hit& a, const Hit& b) {
  if (a.t != b.t) return a.t < b.t;
  if (a.instance != b.instance) return a.instance < b.instance;
  return a.geometry != b.geometry ? a.geometry < b.geometry : a.triangle < b.triangle;
}

HWY_INLINE void take(const Hit& candidate, Query& query) {
  if (query.found && !closer(candidate, query.hit)) return;
  query.found = true;
  query.hit = candidate;
  query.tfar = candidate.t;
}

template <Movement kMovement, bool kAnyHit, bool kCompact>
HWY_INLINE void test_triangles(const Bvh& bvh, const BlockHeader& block, const RaySetup<kMovement>& setup,
                               std::uint32_t instance, Query& query) {
  BlockHit hit;
  test_block<kMovement, kCompact>(bvh, block, setup, query.tfar, hit);
  if (kAnyHit) {
    query.found |= hit.lanes != 0;
    return;
  }
  for (std::uint32_t lanes = hit.lanes; lanes != 0; lanes &= lanes - 1) {
    const int i = std::countr_zero(lanes);
    take({hit.t[i], hit.u[i], hit.v[i], block.triangles()[i], block.geometry(), instance}, query);
  }
}

template <Movement kMovement, bool kAnyHit>
HWY_INLINE void test_tile(const GridTest<kMovement>& grid, std::uint32_t tile, GeometryId mesh,
                          std::uint32_t instance, Query& query) {
  for (std::uint32_t pass = 0; pass < GridTest<kMovement>::kPasses; ++pass) {
    BlockHit hit[2];
    grid.test(tile, pass, query.tfar, hit);
    if (kAnyHit) {
      query.found |= (hit[0].lanes | hit[1].lanes) != 0;
      continue;
    }
    for (std::uint32_t half = 0; half < 2; ++half) {
      const BlockHit& h = hit[half];
      for (std::uint32_t lanes = h.lanes; lanes != 0; lanes &= lanes - 1) {
        const auto i = static_cast<std::uint32_t>(std::countr_zero(lanes));
        take({h.t[i], h.u[i], h.v[i], grid.triangle_id(tile, pass, i, half), mesh, instance}, query);
      }
    }
  }
}

// The tiles of a grid that the ray enters, in their own order: to find the nearest of the one or two that
// there are costs more than it saves. Returns how many were tested. Not inlined: the loop over triangles'
// blocks keeps its registers.
template <Movement kMovement, bool kAnyHit>
HWY_NOINLINE std::uint32_t test_grid(const Bvh& bvh, const BlockHeader& block,
                                     const RaySetup<kMovement>& setup, std::uint32_t instance, Query& query) {
  const GridTest<kMovement> grid(bvh, block, setup);
  alignas(64) ChildKey keys[kWidth];
  std::uint32_t tiles, tested = 0;
  grid.tiles(query.tfar, tiles).store(keys);
  for (; tiles != 0; tiles &= tiles - 1) {
    const auto tile = static_cast<std::uint32_t>(std::countr_zero(tiles));
    if (is_beyond(distance_of(keys[tile]), query.tfar)) continue;
    test_tile<kMovement, kAnyHit>(grid, tile, block.geometry(), instance, query);
    ++tested;
    if (kAnyHit && query.found) break;
  }
  return tested;
}

// Curves and points. Not inlined, as above.
template <Movement kMovement, bool kAnyHit>
HWY_NOINLINE void test_round(const Bvh& bvh, const BlockHeader& block, const RaySetup<kMovement>& setup,
                             std::uint32_t instance, Query& query) {
  constexpr bool kCurves = !kOmittedKinds.has(LeafKind::kCurves),
                 kPoints = !kOmittedKinds.has(LeafKind::kPoints);
  if (kCurves && (!kPoints || block.kind == BlockKind::kCurves)) {
    const bool found =
        test_curves<kMovement>(bvh, block, setup, query.tfar, [&](std::uint32_t span, const CurveHit& hit) {
          if (!kAnyHit) take({hit.t, hit.u, hit.v, span, block.geometry(), instance}, query);
        });
    if (kAnyHit) query.found |= found;
    return;
  }
  if (!kPoints) return;
  BlockHit hit;
  test_spheres<kMovement>(bvh, block, setup, query.tfar, hit);
  if (kAnyHit) {
    query.found |= hit.lanes != 0;
    return;
  }
  for (std::uint32_t lanes = hit.lanes; lanes != 0; lanes &= lanes - 1) {
    const int i = std::countr_zero(lanes);
    take({hit.t[i], 0.0f, 0.0f, block.triangles()[i], block.geometry(), instance}, query);
  }
}

// The ray in an instance's own space and time: matrix elements interpolated in single precision, inverted and
// applied in double. The parameter t keeps its meaning. False where there is nothing to hit: the map is
// singular at this time, or the instance or its object not there.
template <Movement kMovement>
bool to_object(const Bvh& bvh, const Instance& instance, Ray& ray) {
  constexpr bool kMoving = kMovement != Movement::kStill, kRemaps = kMoving && kKnownTimeRemaps;
  if (instance.object->empty) return false;
  const D4 d;
  const Affine3f* controls = bvh.controls_of(instance);
  Affine3f map = *controls;
  float u = clamped_time(ray.time);
  if (kRemaps && !instance.object->time_remap.is_shutter() && !instance.object->time_remap.at(u, ray.time))
    return false;
  if (kRemaps && instance.time_remap != kNoTimeRemap && !bvh.time_remaps[instance.time_remap].at(u, u))
    return false;
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
  const Affine3d a(map);
  // Cramer's rule: org and dir are the two right-hand sides, and no inverse is formed.
  const Vec3d yz = cross(a.y, a.z), zx = cross(a.z, a.x), xy = cross(a.x, a.y);
  const double determinant = dot(a.x, yz);
  if (determinant == 0.0) return false;
  const double s = 1.0 / determinant;
  const auto solved = [&](const Vec3d& v) { return Vec3f(Vec3d{dot(yz, v), dot(zx, v), dot(xy, v)} * s); };
  ray.org = solved(Vec3d(ray.org) - a.t);
  ray.dir = solved(Vec3d(ray.dir));
  return true;
}

}  // namespace msbvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
