#include "core/build/moving_builder.h"

#include <cmath>

#include "core/base/error.h"
#include "core/build/leaf_rule.h"
#include "core/build/moving_split.h"
#include "core/build/partition.h"
#include "core/build/raw_array.h"
#include "core/build/reduce.h"

namespace msbvh {
namespace {

constexpr std::size_t kAloneReferences = 1024;
constexpr std::size_t kChunk = 8192;
constexpr std::size_t kCancelReferences = 4096;

MovingBounds bounds_of(std::span<const MovingReference> references) {
  return reduce_in_chunks<MovingBounds>(
      references.size(), kChunk, [] { return MovingBounds(); },
      [&](MovingBounds& sum, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) sum.grow(ShutterBox(references[i]));
      },
      [](MovingBounds& sum, const MovingBounds& part) { sum.grow(part); });
}

class IsLeft {
 public:
  IsLeft(const MovingBinning& binning, const MovingSplit& split)
      : binning_(binning),
        first_right_(_mm_set1_epi32(split.first_right_bin)),
        by_drift_(split.axis >= 3),
        lane_(split.axis % 3) {}
  bool operator()(const Box4&, const MovingReference& r) const {
    const __m128i left = _mm_cmplt_epi32(binning_.bins_of(ShutterBox(r), by_drift_), first_right_);
    return ((_mm_movemask_ps(_mm_castsi128_ps(left)) >> lane_) & 1) != 0;
  }

 private:
  const MovingBinning binning_;
  const __m128i first_right_;
  const bool by_drift_;
  const int lane_;
};

}  // namespace

void MovingBuilder::run(std::uint32_t node, std::span<const Reference> references, std::uint32_t depth) {
  RawArray<MovingReference> memory(references.size());
  parallel_for_ranges(references.size(), kChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) memory[i] = pose_.at_ends(references[i]);
  });
  first_ = memory.data();
  first_place_ = slots_.next_reference.fetch_add(references.size());
  const std::span<MovingReference> all(memory.data(), references.size());
  build(node, {all, bounds_of(all), depth});
  slots_.leaf_references += references.size();
}

void MovingBuilder::build(std::uint32_t node, const Set& set) {
  if (set.references.size() <= kAloneReferences) {
    NodeTaker nodes(slots_, set.references.size());
    return build_alone(node, set, nodes);
  }
  if (set.references.size() >= kCancelReferences && settings_.cancelled && settings_.cancelled())
    throw Cancelled();
  Set left, right;
  if (!divide(node, set, left, right)) return;
  const std::uint32_t children = slots_.next_node.fetch_add(2);
  slots_.topology.nodes[node].first = children;
  parallel_invoke([&] { build(children, left); }, [&] { build(children + 1, right); });
}

void MovingBuilder::build_alone(std::uint32_t node, const Set& set, NodeTaker& nodes) {
  Set left, right;
  if (!divide(node, set, left, right)) return;
  const std::uint32_t children = nodes.take_two();
  slots_.topology.nodes[node].first = children;
  build_alone(children, left, nodes);
  build_alone(children + 1, right, nodes);
}

// False: the node has become a leaf.
bool MovingBuilder::divide(std::uint32_t node, const Set& set, Set& left, Set& right) {
  BinaryNode& out = slots_.topology.nodes[node];
  write_node(out, set.bounds.box.centre, pose_.mean_area()(set.bounds.box));
  out.count = 0;
  if (split(set, left, right)) return true;
  make_leaf(node, set.references);
  return false;
}

bool MovingBuilder::split(const Set& set, Set& left, Set& right) const {
  const std::size_t count = set.references.size();
  const std::span<const MovingReference> references = set.references;
  const bool leaf = may_be_leaf(references, settings_);
  if (leaf && is_small_leaf(count)) return false;
  std::size_t middle = count / 2;
  if (set.depth <= kMaxSahDepth) {
    const MovingBinning binning(set.bounds, count);
    const MovingSplit best = find_moving_split(references, binning, pose_.mean_area());
    const float area = pose_.mean_area()(set.bounds.box);
    const float leaf_cost = settings_.block_cost * area * block_count(count);
    if (leaf && leaf_cost <= settings_.split_cost * area + settings_.block_cost * best.cost) return false;
    if (std::isfinite(best.cost)) middle = partition(set.references, IsLeft(binning, best)).left_count;
  } else if (leaf) {
    return false;
  }
  left = {set.references.first(middle), bounds_of(references.first(middle)), set.depth + 1};
  right = {set.references.subspan(middle), bounds_of(references.subspan(middle)), set.depth + 1};
  return true;
}

void MovingBuilder::make_leaf(std::uint32_t node, std::span<const MovingReference> references) {
  const std::uint64_t place = first_place_ + static_cast<std::uint64_t>(references.data() - first_);
  std::copy(references.begin(), references.end(), slots_.topology.references.data() + place);
  slots_.topology.nodes[node].first = static_cast<std::uint32_t>(place);
  slots_.topology.nodes[node].count = static_cast<std::uint32_t>(references.size());
}

}  // namespace msbvh
