// Coherent rays: kPacket of them go down the tree together, a child's box against all of them at once.
//
// A node's boxes are read, and a child is chosen, once for all rays that are there; what 16 rays share is
// paid once. Children that the rays' intervals miss (core/trace/beam-inl.h) are held against no ray. Where
// few are left, each goes on alone (C. Benthin, I. Wald, S. Woop, M. Ernst, W. Mark, "Combining Single and
// Packet-Ray Tracing for Arbitrary Ray Distributions on the Intel MIC Architecture", TVCG 18(9), 2012). Rays
// have times of their own: boxes are interpolated for all rays in one segment at once, and ray by ray where
// rays are in more than two. Triangles are tested a ray at a time, eight at once, by the same code in the
// same arithmetic as everywhere: same hits to the bit.

#if defined(MSBVH_PACKET_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MSBVH_PACKET_INL_H
#undef MSBVH_PACKET_INL_H
#else
#define MSBVH_PACKET_INL_H
#endif

#include <algorithm>
#include <bit>
#include <cstdint>
#include <hwy/highway.h>
#include <limits>
#include <memory>

#include "core/trace/beam-inl.h"
#include "core/trace/traverse-inl.h"

HWY_BEFORE_NAMESPACE();
namespace msbvh::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

inline constexpr std::uint32_t kPacket = 16;  // rays
using RayMask = std::uint32_t;                // a bit each
inline constexpr RayMask kAllRays = (1u << kPacket) - 1u;

using DR = hn::CappedTag<float, kPacket>;
using VR = hn::Vec<DR>;
inline constexpr std::size_t kRayLanes = hn::MaxLanes(DR());

// What the rays of a packet bring into a tree: axis by axis for boxes, ray by ray for triangles.
template <Movement kMovement>
struct PacketSetup {
  alignas(64) float org[3][kPacket], reciprocal[3][kPacket], tnear[kPacket], tfar[kPacket], time[kPacket];
  RaySetup<kMovement> ray[kPacket];
  // Up to this level all rays are in the same segment.
  std::uint32_t common_level = 0;
  Beam beam;

  void set(std::uint32_t i, const Ray& r, const Bvh& bvh) {
    std::construct_at(&ray[i], r, bvh);
    for (int axis = 0; axis < 3; ++axis) org[axis][i] = r.org[axis];
    for (int axis = 0; axis < 3; ++axis) reciprocal[axis][i] = 1.0f / r.dir[axis];
    tnear[i] = ray[i].tnear;
    tfar[i] = r.tfar;
    time[i] = clamped_time(r.time);
  }
  // Once all rays are set.
  void join() {
    beam.set(org, reciprocal, tnear, time);
    find_common_level();
  }

 private:
  void find_common_level() {
    if constexpr (kMovement == Movement::kStill) return;
    const auto [first, last] = std::minmax_element(time, time + kPacket);
    common_level = 1;
    while (common_level + 1 < kSliceLevel) {
      const std::uint32_t segments = segments_of_level(common_level + 1);
      if (locate(*first, segments).key != locate(*last, segments).key) return;
      ++common_level;
    }
  }
};

// In a tree without instances, whatever else is in its leaves.
template <Movement kMovement, LeafKinds kKinds, bool kMixed, bool kAnyHit>
class Packet {
 public:
  using Setup = PacketSetup<kMovement>;

  // `all` rays, that `setup` is of, from the root on; `queries` take their answers.
  void run(const Bvh& bvh, const Ray* all, Query* queries) {
    bvh_ = &bvh;
    rays_ = all;
    queries_ = queries;
    Place at{bvh.root, bvh.root_form_code};
    RayMask rays = kAllRays;
    top_ = stack_;
    find_farthest();
    for (;;) {
      if (std::popcount(rays) <= kFew) {
        go_alone(at, rays);
      } else if (at.ref.is_leaf()) {
        fetch_own_keys(at, rays);
        visit_leaf(at, rays);
        find_farthest();
      } else if (descend(at, rays)) {
        continue;
      }
      if (!pop(at, rays)) return;
    }
  }

  Setup setup;
  // What packets have saved so far over interleaved rays, in some 5 cycles: a node costs a ray on its own
  // kOwnNode, all rays together kSharedNode, and one that goes on alone waits where interleaved it would not.
  // Between the scenes where packets pay and those where they do not kAlone may be 7 to 20
  // (docs/design/traversal.md).
  std::int64_t saved = 0;

 private:
  static constexpr std::int64_t kOwnNode = 8, kSharedNode = 28, kAlone = 14;
  static constexpr bool kMoving = kMovement != Movement::kStill;
  static constexpr bool kCompact = kKinds.has(LeafKind::kCompactTree);
  // Rays that go on alone.
  static constexpr int kFew = 2;

  struct Entry {
    alignas(64) float enter[kPacket];
    Place at;
    RayMask rays;
  };

  // Which of a node's children rays enter, a bit each; which rays and where, in entered_ and enter_.
  HWY_INLINE std::uint32_t test(const NodeHeader& node, FormCode form, RayMask rays) {
    if constexpr (kMoving) {
      const std::uint32_t level = form.level();
      if (level > setup.common_level) {
        // Not all in one segment: those in the same one together, where that is few groups.
        if (level > setup.common_level + 1 || level == kSliceLevel) return test_one_by_one(node, form, rays);
        const std::uint32_t key = key_of_first(level, rays);
        RayMask same = 0;
        for (RayMask rest = rays; rest != 0; rest &= rest - 1) {
          const int i = std::countr_zero(rest);
          same |= static_cast<RayMask>(setup.ray[i].at_level[level].key == key) << i;
        }
        std::uint32_t children = test_together<true, false>(node, form, key, same);
        if (rays != same) {
          rays &= ~same;
          children |= test_together<true, true>(node, form, key_of_first(level, rays), rays);
        }
        return children;
      }
      if (level != 0) return test_together<true, false>(node, form, key_of_first(level, rays), rays);
    }
    return test_together<false, false>(node, form, 0, rays);
  }

  HWY_INLINE std::uint32_t key_of_first(std::uint32_t level, RayMask rays) const {
    return setup.ray[std::countr_zero(rays)].at_level[level].key;
  }

  // Controls `first` to `first + more`; once for all rays.
  HWY_INLINE static void decode(const NodeHeader& node, std::uint32_t first, std::uint32_t more,
                                NodeBounds* out) {
    const hn::CappedTag<float, kWidth> d;
    const CompactPlanes planes{reinterpret_cast<const std::uint16_t*>(node.compact_bounds() + first), node};
    constexpr std::size_t kAxis = 2 * kWidth, kControl = 3 * kAxis;
    auto* to = reinterpret_cast<float*>(out);
    for (std::size_t c = 0; c <= more; ++c) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        for (std::size_t i = c * kControl + axis * kAxis; i < c * kControl + (axis + 1) * kAxis;
             i += hn::MaxLanes(d))
          hn::Store(planes.load(d, planes.first + i, axis), d, to + i);
      }
    }
  }

  // `kMore`: beside those that have been tested already.
  template <bool kMoves, bool kMore>
  HWY_INLINE std::uint32_t test_together(const NodeHeader& node, FormCode form, std::uint32_t key,
                                         RayMask rays) {
    const DR d;
    const std::uint32_t degree = kMovement == Movement::kPolynomial ? form.degree() : 1;
    const auto segments = static_cast<float>(kMoves ? segments_of_level(form.level()) : 0);
    NodeBounds decoded[kCompact ? kMaxDegree + 1 : 1];
    if constexpr (kCompact) decode(node, key * degree, kMoves ? degree : 0, decoded);
    const NodeBounds& bounds = kCompact ? decoded[0] : node.bounds()[key * degree];
    std::uint32_t met = setup.beam.template meets<kMoves, kMovement == Movement::kPolynomial>(
                            &bounds, degree, kMoves ? segments_of_level(form.level()) : 0, key, farthest_) &
                        ((1u << node.child_count) - 1u);
    std::uint32_t children = 0;
    if (!kMore) std::fill_n(entered_, kWidth, 0);
    for (; met != 0; met &= met - 1) {
      const auto c = static_cast<std::uint32_t>(std::countr_zero(met));
      RayMask entered = 0;
      for (std::size_t lane = 0; lane < kPacket; lane += kRayLanes) {
        // As locate() has it.
        const Weights<DR> w(d, hn::Sub(hn::Mul(hn::Load(d, setup.time + lane), hn::Set(d, segments)),
                                       hn::Set(d, static_cast<float>(key))));
        VR enter = hn::Load(d, setup.tnear + lane), leave = hn::Load(d, setup.tfar + lane);
        for (int axis = 0; axis < 3; ++axis) {
          const VR org = hn::Load(d, setup.org[axis] + lane), r = hn::Load(d, setup.reciprocal[axis] + lane);
          const auto distance = [&](const float* plane) {
            const auto control = [&](std::size_t i) {
              return hn::Set(d, plane[i * (sizeof(NodeBounds) / sizeof(float))]);
            };
            return hn::Mul(hn::Sub(kMoves ? simd_bezier(control, degree, w) : control(0), org), r);
          };
          const VR lo = distance(bounds.axis[axis].lo + c), hi = distance(bounds.axis[axis].hi + c);
          // A distance that is not a number bounds nothing: see node_test-inl.h.
          enter = hn::Max(hn::IfNegativeThenElse(r, hi, lo), enter);
          leave = hn::Min(hn::IfNegativeThenElse(r, lo, hi), leave);
        }
        const auto hit = hn::Le(enter, hn::Mul(leave, hn::Set(d, kFarFactor)));
        std::uint8_t bits[8] = {};
        hn::StoreMaskBits(d, hit, bits);
        if (kMore) {
          const auto in = static_cast<std::uint16_t>(rays >> lane);
          const auto mask = hn::LoadMaskBits(d, reinterpret_cast<const std::uint8_t*>(&in));
          enter = hn::IfThenElse(mask, enter, hn::Load(d, enter_[c] + lane));
        }
        hn::Store(enter, d, enter_[c] + lane);
        entered |= (RayMask(bits[0]) | RayMask(bits[1]) << 8) << lane;
      }
      entered_[c] = (entered & rays) | (kMore ? entered_[c] : 0);
      children |= static_cast<std::uint32_t>(entered_[c] != 0) << c;
    }
    return children;
  }

  std::uint32_t test_one_by_one(const NodeHeader& node, FormCode form, RayMask rays) {
    std::uint32_t children = 0;
    for (std::uint32_t c = 0; c < kWidth; ++c) entered_[c] = 0;
    for (; rays != 0; rays &= rays - 1) {
      const auto i = static_cast<std::uint32_t>(std::countr_zero(rays));
      alignas(64) ChildKey keys[kWidth];
      std::uint32_t hits;
      test_node<kMovement, kCompact>(node, form, setup.ray[i], setup.tfar[i], hits).store(keys);
      children |= hits;
      for (; hits != 0; hits &= hits - 1) {
        const auto c = static_cast<std::uint32_t>(std::countr_zero(hits));
        entered_[c] |= 1u << i;
        enter_[c][i] = distance_of(keys[c]);
      }
    }
    return children;
  }

  // Goes to the child that a ray enters first and leaves the others on the stack, the farthest at the bottom;
  // where any hit will do, to the first one. False: none is hit.
  HWY_INLINE bool descend(Place& at, RayMask& rays) {
    const NodeHeader& node = bvh_->node(at.ref);
    saved += kOwnNode * std::popcount(rays) - (at.form.level() > setup.common_level ? 2 : 1) * kSharedNode;
    std::uint32_t children = test(node, at.form, rays);
    if (children == 0) return false;
    ChildKey order[kWidth];
    int count = 0;
    for (; children != 0; children &= children - 1) {
      const auto c = static_cast<std::uint32_t>(std::countr_zero(children));
      const ChildKey key = kAnyHit ? static_cast<ChildKey>(c) : key_of(c);
      int place = count++;
      for (; place > 0 && order[place - 1] < key; --place) order[place] = order[place - 1];
      order[place] = key;
    }
    const std::uint32_t nearest = ChildKeys::slot(order[count - 1]);
    at = child_of<kMixed>(node, nearest);
    fetch(at, entered_[nearest]);
    for (int i = 0; i < count - 1; ++i) push(node, ChildKeys::slot(order[i]));
    rays = entered_[nearest];
    return true;
  }

  // Orders children by where the first of their rays enters them.
  HWY_INLINE ChildKey key_of(std::uint32_t c) const {
    const float distance = enter_[c][std::countr_zero(entered_[c])];
    return (std::bit_cast<ChildKey>(distance) & ~kSlotMask) | static_cast<ChildKey>(c);
  }

  HWY_INLINE void push(const NodeHeader& node, std::uint32_t c) {
    const DR d;
    for (std::size_t lane = 0; lane < kPacket; lane += kRayLanes)
      hn::Store(hn::Load(d, enter_[c] + lane), d, top_->enter + lane);
    top_->at = child_of<kMixed>(node, c);
    top_->rays = entered_[c];
    fetch(top_->at, top_->rays);
    ++top_;
  }
  HWY_INLINE void fetch(Place at, RayMask rays) const {
    prefetch<kMovement, kCompact>(spot_of<kMovement>(*bvh_, at, setup.ray[std::countr_zero(rays)]));
  }

  // Of rays that are in other segments than the first of them.
  HWY_INLINE void fetch_own_keys(Place at, RayMask rays) const {
    if (!kMoving || at.form.level() <= setup.common_level) return;
    for (rays &= rays - 1; rays != 0; rays &= rays - 1) fetch(at, rays);
  }

  // The topmost entry that some ray enters before its closest hit, and those rays.
  HWY_INLINE bool pop(Place& at, RayMask& rays) {
    const DR d;
    while (top_ != stack_) {
      const Entry& entry = *--top_;
      RayMask before = 0;
      for (std::size_t lane = 0; lane < kPacket; lane += kRayLanes) {
        std::uint8_t bits[8] = {};
        // As is_beyond() has it.
        const VR farthest = hn::Mul(hn::Load(d, setup.tfar + lane), hn::Set(d, kFarFactor));
        hn::StoreMaskBits(d, hn::Le(hn::Load(d, entry.enter + lane), farthest), bits);
        before |= (RayMask(bits[0]) | RayMask(bits[1]) << 8) << lane;
      }
      rays = entry.rays & before;
      at = entry.at;
      if (rays != 0) return true;
    }
    return false;
  }

  // Nothing is found beyond: what was found bounds all of the rays together.
  HWY_INLINE void find_farthest() {
    const DR d;
    VR farthest = hn::Set(d, -std::numeric_limits<float>::infinity());
    for (std::size_t lane = 0; lane < kPacket; lane += kRayLanes)
      farthest = hn::Max(hn::Load(d, setup.tfar + lane), farthest);
    farthest_ = hn::GetLane(hn::MaxOfLanes(d, farthest));
  }

  // What a ray has found bounds its way. One that is done, since any hit will do, enters nothing any more.
  HWY_INLINE void take_answer(std::uint32_t i) {
    constexpr float kNowhere = -std::numeric_limits<float>::infinity();
    setup.tfar[i] = kAnyHit && queries_[i].found ? kNowhere : queries_[i].tfar;
  }

  void go_alone(Place at, RayMask rays) {
    saved -= kAlone * std::popcount(rays);
    fetch_own_keys(at, rays);
    if (kMixed && at.still) return go_alone_in<Movement::kStill>(at, rays);
    go_alone_in<kMovement>(at, rays);
  }
  template <Movement kTree>
  HWY_INLINE void go_alone_in(Place at, RayMask rays) {
    for (; rays != 0; rays &= rays - 1) {
      const auto i = static_cast<std::uint32_t>(std::countr_zero(rays));
      Traversal<kTree, kKinds, kAnyHit, false>(*bvh_, rays_[i], setup.ray[i], kNoInstance, queries_[i],
                                               nullptr)
          .run(at);
      take_answer(i);
    }
  }

  HWY_INLINE void visit_leaf(Place at, RayMask rays) {
    if (kMixed && at.still) return visit_blocks<Movement::kStill>(bvh_->block(at.ref), rays);
    visit_blocks<kMovement>(bvh_->block(at.ref), rays);
  }
  template <Movement kTree>
  HWY_INLINE void visit_blocks(const BlockHeader& first, RayMask rays) {
    for (; rays != 0; rays &= rays - 1) {
      const auto i = static_cast<std::uint32_t>(std::countr_zero(rays));
      for (const BlockHeader* block = &first;; block = next_block(block)) {
        visit_block<kTree>(*block, i);
        if ((kAnyHit && queries_[i].found) || block->last) break;
      }
      take_answer(i);
    }
  }

  template <Movement kTree>
  HWY_INLINE void visit_block(const BlockHeader& block, std::uint32_t i) {
    if constexpr (kKinds.has(LeafKind::kGrids)) {
      if (block.kind == BlockKind::kGrid) {
        test_grid<kTree, kAnyHit>(*bvh_, block, setup.ray[i], kNoInstance, queries_[i]);
        return;
      }
    }
    if constexpr (kKinds.has(LeafKind::kCurves) || kKinds.has(LeafKind::kPoints)) {
      if (block.kind >= BlockKind::kCurves)
        return test_round<kTree, kAnyHit>(*bvh_, block, setup.ray[i], kNoInstance, queries_[i]);
    }
    test_triangles<kTree, kAnyHit, kCompact>(*bvh_, block, setup.ray[i], kNoInstance, queries_[i]);
  }

  const Bvh* bvh_;
  const Ray* rays_;
  Query* queries_;
  // Of the node that was tested last: the rays that enter each child, and where.
  alignas(64) float enter_[kWidth][kPacket];
  RayMask entered_[kWidth];
  float farthest_;
  Entry* top_;
  Entry stack_[(kWidth - 1) * kMaxDepth + 1];
};

}  // namespace msbvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
