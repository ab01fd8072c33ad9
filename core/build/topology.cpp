#include "core/build/topology.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <memory>
#include <string>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/build/make_references.h"
#include "core/build/moving_builder.h"
#include "core/build/subtree.h"

namespace msbvh {
namespace {

// Smaller sets are one thread's.
constexpr std::size_t kSubtreeReferences = 128;
// Smaller ones are not asked how they move: that takes as long as to build them.
constexpr std::size_t kMovingReferences = 64;
constexpr std::size_t kCancelReferences = 4096;
constexpr std::size_t kCopiedPerTask = 32768;

// The upper part of the tree, whose large sets all threads divide together.
class TopologyBuilder {
 public:
  TopologyBuilder(const Splitter& splitter, const ShutterPose& shutter, const BuildSettings& settings,
                  Topology& out)
      : splitter_(splitter),
        shutter_(shutter),
        settings_(settings),
        over_shutter_(settings.sah_time == SahTime::kShutter && !splitter.primitives().swept &&
                      splitter.primitives().slice.whole()),
        slots_{out},
        subtree_references_(std::max<std::size_t>(kSubtreeReferences, settings.max_leaf_triangles)) {}

  void run(Memory memory, const WorkSet& root) {
    build(0, std::move(memory), root);
    slots_.topology.node_count = slots_.next_node;
    slots_.topology.reference_count = slots_.leaf_references;
    slots_.topology.incoherent_references = incoherent_references_;
  }

 private:
  // `memory` is where the set lies, shared with its sibling.
  void build(std::uint32_t node, Memory memory, WorkSet set) {
    if (is_incoherent(set)) {
      incoherent_references_ += set.size();
      return MovingBuilder(shutter_, settings_, slots_).run(node, set.references, set.depth);
    }
    if (set.size() <= subtree_references_) return SubtreeBuilder(splitter_, slots_).run(node, set);
    check_cancelled(set);
    write_node(slots_.topology.nodes[node], set.bounds.box, half_area(set.bounds.box));
    WorkSet left, right;
    {
      const SplitChoice choice = node == 0 ? splitter_.choose_root(set) : splitter_.choose(set);
      if (choice.kind == SplitKind::kSpatial) memory = with_room(set, choice.spatial);
      splitter_.divide(set, choice, left, right);
    }
    const std::uint32_t children = slots_.next_node.fetch_add(2);
    slots_.topology.nodes[node].first = children;
    slots_.topology.nodes[node].count = 0;
    // Each child holds the memory alone, so that what neither needs any more is freed.
    Memory shared = memory;
    parallel_invoke([&] { build(children, std::move(memory), left); },
                    [&] { build(children + 1, std::move(shared), right); });
  }

  // Moves the set to where there is space for what the split adds. Room that it does not need stays a number.
  static Memory with_room(WorkSet& set, const SpatialSplit& split) {
    const std::size_t count = set.size();
    const std::size_t added = set.space_for(split);
    auto memory = std::make_shared<RawArray<Reference>>(count + added);
    parallel_for_ranges(count, kCopiedPerTask, [&](std::size_t begin, std::size_t end) {
      std::memcpy(memory->data() + begin, set.references.data() + begin, (end - begin) * sizeof(Reference));
    });
    set.references = {memory->data(), count};
    return memory;
  }

  bool is_incoherent(const WorkSet& set) const {
    return over_shutter_ && shutter_.moving() && set.size() >= kMovingReferences &&
           shutter_.incoherent(set.references);
  }

  void check_cancelled(const WorkSet& set) const {
    if (set.size() >= kCancelReferences && settings_.cancelled && settings_.cancelled()) throw Cancelled();
  }

  const Splitter& splitter_;
  const ShutterPose& shutter_;
  const BuildSettings& settings_;
  const bool over_shutter_;  // not for swept boxes, which do not move, nor for a slice
  TopologySlots slots_;
  std::atomic<std::uint64_t> incoherent_references_{0};
  const std::size_t subtree_references_;
};

}  // namespace

Topology build_topology(const Primitives& primitives, const BuildSettings& settings) {
  Topology out;
  const CentrePose pose(primitives);
  AllReferences all = make_references(pose);
  const std::size_t count = all.count;
  if (count == 0) return out;
  const bool spatial = settings.builder == Builder::kMsbvh;
  const auto extra =
      static_cast<std::size_t>(spatial ? settings.spatial_split_budget * static_cast<float>(count) : 0.0f);
  if (count + extra >= (std::size_t(1) << 31)) {
    throw Error("accelerator: " + std::to_string(count) + " primitives; expected fewer than 2^31 references");
  }
  out.references = RawArray<Reference>(count + extra);
  out.nodes = RawArray<BinaryNode>(2 * (count + extra));
  const Splitter splitter(pose, settings, half_area(all.bounds.box));
  const WorkSet root = Splitter::root({all.memory->data(), count}, all.bounds, extra);
  TopologyBuilder(splitter, ShutterPose(pose), settings, out).run(std::move(all.memory), root);
  return out;
}

}  // namespace msbvh
