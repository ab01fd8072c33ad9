// Many rays at once: kSlots of them take turns, one node or one leaf each.
//
// A ray on its own waits: for the child's address, for the cache line behind it, and for the processor to
// guess again where it guessed wrong which child comes next. Here the next box of a ray is fetched while the
// others have their turns, and what would be a guess is made arithmetic: a node's children always go onto the
// stack and the next place is always popped from it; rays at nodes and rays at leaves stand in two queues,
// and where something moves those in still objects and still subtrees in two of their own, whose steps know
// no time. Rays need not be coherent. Same tests, same order, same hits as core/trace/traverse-inl.h.

#if defined(MSBVH_STREAM_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef MSBVH_STREAM_INL_H
#undef MSBVH_STREAM_INL_H
#else
#define MSBVH_STREAM_INL_H
#endif

#include <algorithm>
#include <bit>
#include <cstddef>
#include <hwy/highway.h>
#include <memory>

#include "core/trace/packets-inl.h"
#include "core/trace/traverse-inl.h"

HWY_BEFORE_NAMESPACE();
namespace msbvh::HWY_NAMESPACE {

template <Movement kMovement, LeafKinds kKinds, bool kMixed, bool kAnyHit>
class Stream {
  static constexpr bool kInstanced = kKinds.has(LeafKind::kInstances), kGrids = kKinds.has(LeafKind::kGrids);
  static constexpr bool kRound = kKinds.has(LeafKind::kCurves) || kKinds.has(LeafKind::kPoints);
  static constexpr bool kCompact = kKinds.has(LeafKind::kCompactTree);

 public:
  using Setup = RaySetup<kMovement>;
  // Enough that a line from memory is there when its ray's turn comes; few enough that their stacks' tops
  // stay in the first cache.
  static constexpr std::size_t kSlots = 16;

  // `finish(ray index, query)` takes the answers, in any order.
  template <typename Finish>
  void run(const Bvh& world, const Ray* rays, std::size_t count, const Finish& finish) {
    world_ = &world;
    rays_ = rays;
    count_ = count;
    next_ray_ = 0;
    for (std::size_t& queued : queued_) queued = 0;
    const auto done = [&](Slot* slot) {
      finish(slot->index, slot->query);
      if (next_ray_ == count_) return;
      start(*slot);
      enqueue(slot);
    };
    // A slot is put back only at or before its place in the queue that is being read.
    const auto each_in = [&](std::size_t queue, const auto& step) {
      const std::size_t count = queued_[queue];
      queued_[queue] = 0;
      for (std::size_t i = 0; i < count; ++i) {
        Slot* slot = queues_[queue][i];
        step(*slot) ? enqueue(slot) : done(slot);
      }
      return count;
    };
    for (std::size_t i = 0; i < kSlots && next_ray_ < count_; ++i) {
      start(slots_[i]);
      enqueue(&slots_[i]);
    }
    for (std::size_t stepped = 1; stepped > 0;) {
      stepped = each_in(kNodes, [&](Slot& slot) { return step_node<kMovement>(slot), next(slot); });
      stepped += each_in(kLeaves, [&](Slot& slot) { return step_leaf<kMovement>(slot); });
      if constexpr (kStillQueues) {
        stepped += each_in(kStill + kNodes,
                           [&](Slot& slot) { return step_node<Movement::kStill>(slot), next(slot); });
        stepped += each_in(kStill + kLeaves, [&](Slot& slot) { return step_leaf<Movement::kStill>(slot); });
      }
    }
  }

 private:
  static constexpr bool kStillObjects = kInstanced && kMovement != Movement::kStill;
  static constexpr bool kStillQueues = kStillObjects || kMixed;
  static constexpr std::size_t kNodes = 0, kLeaves = 1, kStill = 2;

  struct Slot {
    Setup setup[kInstanced ? 2 : 1];  // in the world, and in an instance's object
    Query query{0.0f};
    const Ray* ray;
    std::size_t index;
    // Of the tree that the ray is in.
    const Bvh* bvh;
    const Setup* in;
    Frame* base;
    std::uint32_t instance;
    std::uint32_t entered;  // the instance that setup[1] is for
    std::uint32_t queues;   // where those of `bvh` begin: 0, or kStill for a still object
    Place at;
    Spot spot;  // of `at`
    Frame* top;
    Frame stack[2 * kMaxDepth + 2];
  };

  HWY_INLINE void enqueue(Slot* slot) {
    slot->spot = spot_of<kMovement>(*slot->bvh, slot->at, *slot->in);
    prefetch<kMovement, kCompact>(slot->spot);
    const std::size_t still = (kStillObjects ? slot->queues : 0) | (kMixed && slot->at.still ? kStill : 0);
    const std::size_t queue = still + slot->at.ref.is_leaf();
    queues_[queue][queued_[queue]++] = slot;
  }

  void start(Slot& slot) {
    slot.index = next_ray_++;
    slot.ray = &rays_[slot.index];
    slot.query.tfar = slot.ray->tfar;
    slot.query.found = false;
    std::construct_at(&slot.setup[0], *slot.ray, *world_);  // in place: no copy waits for its stores
    slot.top = slot.stack;
    slot.entered = kNoInstance;
    enter(slot, *world_, 0, kNoInstance);
    slot.at = root_of<kMovement>(*world_, *slot.in);
  }

  static void enter(Slot& slot, const Bvh& bvh, std::size_t setup, std::uint32_t instance) {
    slot.bvh = &bvh;
    slot.in = &slot.setup[setup];
    slot.base = slot.top;
    slot.instance = instance;
    slot.queues = 0;
  }

  template <Movement kTree>
  HWY_INLINE static ChildKeys test_spot(const Slot& slot, std::uint32_t& hits) {
    const Spot& spot = slot.spot;
    if constexpr (kCompact)
      return test_children<kTree>(spot.compact_bounds(), spot.node(), slot.at.form, *slot.in, slot.query.tfar,
                                  hits);
    else
      return test_children<kTree>(spot.bounds(), slot.at.form, *slot.in, slot.query.tfar, hits);
  }
  template <Movement kTree>
  HWY_INLINE static void step_node(Slot& slot) {
    std::uint32_t hits;
    const ChildKeys keys = test_spot<kTree>(slot, hits);
    if (!kAnyHit) keys.store(slot.top->keys);
    slot.top->node = &slot.spot.node();
    slot.top->left = kAnyHit ? hits : static_cast<std::uint32_t>(std::popcount(hits));
    slot.top += hits != 0;
  }

  // Goes to the nearest child of the topmost frame, or to the first one where any hit will do. False: the ray
  // is done.
  HWY_INLINE bool next(Slot& slot) const {
    for (;;) {
      if (slot.top == slot.base) {
        if (!kInstanced || slot.instance == kNoInstance) return false;
        // Back from an instance. Its frames are gone, the world's are below.
        slot.bvh = world_;
        slot.in = &slot.setup[0];
        slot.base = slot.stack;
        slot.instance = kNoInstance;
        slot.queues = 0;
        continue;
      }
      Frame& frame = slot.top[-1];
      if constexpr (kAnyHit) {
        const NodeHeader& node = *frame.node;
        const auto child = static_cast<std::uint32_t>(std::countr_zero(frame.left)) % kWidth;
        frame.left &= frame.left - 1;
        slot.top -= frame.left == 0;
        slot.at = child_of<kMixed>(node, child);
        return true;
      }
      const ChildKey key = ChildKeys::load(frame.keys).take_nearest(frame.keys);
      if (is_beyond(distance_of(key), slot.query.tfar)) {
        --slot.top;
        continue;
      }
      const NodeHeader& node = *frame.node;
      slot.top -= --frame.left == 0;
      slot.at = child_of<kMixed>(node, ChildKeys::slot(key));
      return true;
    }
  }

  // False: the ray is done.
  template <Movement kTree>
  HWY_INLINE bool step_leaf(Slot& slot) const {
    const BlockHeader* block = &slot.spot.block();
    if (kInstanced && kTree == kMovement && block->kind == BlockKind::kInstance) {  // alone in its leaf
      if (enter_instance(slot, *block)) return true;
      return next(slot);
    }
    if (kGrids && block->kind == BlockKind::kGrid) {  // alone, too
      visit_grid<kTree>(slot, *block);
      return !(kAnyHit && slot.query.found) && next(slot);
    }
    for (;; block = next_block(block)) {
      if (kRound && block->kind >= BlockKind::kCurves) {
        visit_round<kTree>(slot, *block);
      } else {
        test_triangles<kTree, kAnyHit, kCompact>(*slot.bvh, *block, *slot.in, slot.instance, slot.query);
      }
      if (kAnyHit && slot.query.found) return false;
      if (block->last) break;
    }
    return next(slot);
  }

  template <Movement kTree>
  HWY_INLINE static void visit_grid(Slot& slot, const BlockHeader& block) {
    if constexpr (kGrids) test_grid<kTree, kAnyHit>(*slot.bvh, block, *slot.in, slot.instance, slot.query);
  }

  template <Movement kTree>
  HWY_INLINE static void visit_round(Slot& slot, const BlockHeader& block) {
    if constexpr (kRound) test_round<kTree, kAnyHit>(*slot.bvh, block, *slot.in, slot.instance, slot.query);
  }

  // False: there is nothing to hit. Parts of one instance often follow each other: the ray in its space is
  // still there.
  bool enter_instance(Slot& slot, const BlockHeader& block) const {
    constexpr std::size_t kInner = kInstanced ? 1 : 0;
    const Instance& instance = world_->instances[block.owner];
    const bool still = kStillObjects && instance.object->movement == Movement::kStill;
    if (slot.entered != block.owner) {
      Ray local = *slot.ray;
      if (!to_object<kMovement>(*world_, instance, local)) return false;
      if (still)
        std::construct_at(static_cast<StillSetup*>(&slot.setup[kInner]), local, *instance.object);
      else
        std::construct_at(&slot.setup[kInner], local, *instance.object);
      slot.entered = block.owner;
    }
    enter(slot, *instance.object, kInner, block.owner);
    slot.queues = still ? kStill : 0;
    slot.at = entry_of<kMovement>(block, *instance.object, *slot.in);
    return true;
  }

  const Bvh* world_ = nullptr;
  const Ray* rays_ = nullptr;
  std::size_t count_ = 0, next_ray_ = 0;
  std::size_t queued_[kStillQueues ? 4 : 2];
  Slot* queues_[kStillQueues ? 4 : 2][kSlots];
  Slot slots_[kSlots];
};

// Streams are large, a few kilobytes a ray: one of each kind a thread, made when first asked for.
template <Movement kMovement, LeafKinds kKinds, bool kMixed, bool kAnyHit>
Stream<kMovement, kKinds, kMixed, kAnyHit>& thread_stream() {
  using S = Stream<kMovement, kKinds, kMixed, kAnyHit>;
  static thread_local const std::unique_ptr<S> stream = std::make_unique<S>();
  return *stream;
}

// Rays in the order of their times, as far as packets call for it, and each one's place among the caller's.
struct TimeSorted {
  static constexpr std::size_t kMost = 1024;
  static constexpr std::size_t kBins = 4;

  Ray rays[kMost];
  std::size_t place[kMost];

  TimeSorted(const Ray* unsorted, std::size_t count, bool moving) {
    std::size_t begin[kBins + 1] = {};
    std::uint8_t bin[kMost];
    for (std::size_t i = 0; i < count; ++i) {
      bin[i] = static_cast<std::uint8_t>(
          moving
              ? std::min(kBins - 1, static_cast<std::size_t>(clamped_time(unsorted[i].time) * float(kBins)))
              : 0);
      ++begin[bin[i] + 1];
    }
    for (std::size_t b = 1; b <= kBins; ++b) begin[b] += begin[b - 1];
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t at = begin[bin[i]]++;
      rays[at] = unsorted[i];
      place[at] = i;
    }
  }
};

// Coherent rays, `count` a multiple of kPacket: by packets, and interleaved where those do not pay.
template <Movement kMovement, LeafKinds kKinds, bool kMixed, bool kAnyHit, typename Finish>
void trace_coherent(const Bvh& bvh, const Ray* rays, std::size_t count, TraceModes& modes,
                    const Finish& finish) {
  using P = Packets<kMovement, kKinds, kMixed, kAnyHit>;
  static thread_local const std::unique_ptr<P> packets = std::make_unique<P>();
  const auto interleaved = [&](const Ray* some, std::size_t n, const auto& place) {
    if (n == 0) return;
    modes.interleaved += n;
    thread_stream<kMovement, kKinds, kMixed, kAnyHit>().run(
        bvh, some, n, [&](std::size_t k, const Query& query) { finish(place(k), query); });
  };
  for (std::size_t from = 0; from < count;) {
    const std::size_t over = kPacket * packets->pass_over(bvh, (count - from) / kPacket);
    interleaved(rays + from, over, [&](std::size_t k) { return from + k; });
    from += over;
    const std::size_t most = std::min(count - from, TimeSorted::kMost);
    if (most == 0) return;
    const TimeSorted sorted(rays + from, most, kMovement != Movement::kStill);
    packets->forget();
    std::size_t i = 0;
    for (; i < most && packets->pays(); i += kPacket) {
      modes.packets += kPacket;
      packets->trace(bvh, sorted.rays + i,
                     [&](std::size_t k, const Query& query) { finish(from + sorted.place[i + k], query); });
    }
    interleaved(sorted.rays + i, most - i, [&](std::size_t k) { return from + sorted.place[i + k]; });
    from += most;
  }
}

// Coherent rays in packets, the others interleaved.
template <Movement kMovement, LeafKinds kKinds, bool kMixed, bool kAnyHit, typename Finish>
void trace_by_coherence(const Bvh& bvh, const Ray* rays, std::size_t count, TraceModes& modes,
                        const Finish& finish) {
  const auto packet_at = [&](std::size_t i) { return i + kPacket <= count && coherent(rays + i); };
  for (std::size_t i = 0; i < count;) {
    std::size_t end = i;
    const auto ours = [&](std::size_t k, const Query& query) { finish(i + k, query); };
    while (packet_at(end)) end += kPacket;
    if (end > i) {
      trace_coherent<kMovement, kKinds, kMixed, kAnyHit>(bvh, rays + i, end - i, modes, ours);
    } else {
      while (end < count && !packet_at(end)) end = std::min(count, end + kPacket);
      modes.interleaved += end - i;
      thread_stream<kMovement, kKinds, kMixed, kAnyHit>().run(bvh, rays + i, end - i, ours);
    }
    i = end;
  }
}

// Among instances packets do not pay (docs/design/traversal.md), and rays at different times begin in
// different slices of the shutter: all interleaved.
template <Movement kMovement, LeafKinds kKinds, bool kMixed, bool kAnyHit, typename Finish>
void trace_many(const Bvh& bvh, const Ray* rays, std::size_t count, TraceModes& modes, const Finish& finish) {
  constexpr bool kMayHaveInstances = kKinds.has(LeafKind::kInstances);
  // Kernels for triangles and instances serve trees that have instances.
  if constexpr (!kMayHaveInstances || kKinds.has(LeafKind::kGrids)) {
    if (bvh.slice_roots.empty() && (!kMayHaveInstances || !bvh.leaf_kinds.has(LeafKind::kInstances)))
      return trace_by_coherence<kMovement, kKinds, kMixed, kAnyHit>(bvh, rays, count, modes, finish);
  }
  modes.interleaved += count;
  thread_stream<kMovement, kKinds, kMixed, kAnyHit>().run(bvh, rays, count, finish);
}

template <Movement kMovement, LeafKinds kKinds, bool kMixed>
void intersect_many(const Bvh& bvh, const Ray* rays, std::size_t count, Hit* hits, TraceModes& modes) {
  for (std::size_t i = 0; bvh.empty && i < count; ++i) hits[i] = Hit{};
  if (bvh.empty) return;
  trace_many<kMovement, kKinds, kMixed, false>(
      bvh, rays, count, modes,
      [&](std::size_t i, const Query& query) { hits[i] = query.found ? query.hit : Hit{}; });
}

template <Movement kMovement, LeafKinds kKinds, bool kMixed>
void occluded_many(const Bvh& bvh, const Ray* rays, std::size_t count, bool* occluded, TraceModes& modes) {
  for (std::size_t i = 0; bvh.empty && i < count; ++i) occluded[i] = false;
  if (bvh.empty) return;
  trace_many<kMovement, kKinds, kMixed, true>(
      bvh, rays, count, modes, [&](std::size_t i, const Query& query) { occluded[i] = query.found; });
}

}  // namespace msbvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
