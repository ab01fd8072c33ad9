#include "core/build/splitter.h"

#include <algorithm>
#include <cmath>

#include "core/build/leaf_rule.h"
#include "core/build/motion_split.h"

namespace msbvh {
namespace {

// What keeps the search for spatial splits from costing more than all the rest; figures in
// docs/design/build.md. Sets that make two blocks as they are have nothing to gain (patches, which have a
// leaf each, do) ...
constexpr std::size_t kMinSpatialReferences = 2 * kTrianglesPerBlock + 1, kMinSpatialPatches = 2;
// ... where so many searches in a row were in vain the next one would be, too; more, once one has paid, that
// is, has won this much ...
constexpr std::uint32_t kFirstPatience = 5, kPatience = 7;
constexpr float kWorthwhile = 0.99f;
// ... and of large sets a sample of so many is asked first, which errs by about so much.
constexpr std::size_t kSample = 128;
constexpr float kSampleError = 1.02f;

// The object split's cost on every so many-th reference.
float sampled_cost(const WorkSet& set, const ObjectBinning& binning, const ObjectSplit& split,
                   std::size_t stride) {
  const IsLeftOfBin is_left(binning, split);
  Box4 boxes[2];
  std::size_t counts[2] = {};
  for (std::size_t i = 0; i < set.size(); i += stride) {
    const Box4 box(set.references[i].box);
    const int side = is_left(box, set.references[i]) ? 0 : 1;
    boxes[side].grow(box);
    ++counts[side];
  }
  return half_area(boxes[0]) * block_count(counts[0]) + half_area(boxes[1]) * block_count(counts[1]);
}

SetBounds bounds_of(std::span<const Reference> references) {
  SetBounds bounds;
  for (const Reference& r : references) bounds.grow(Box4(r.box));
  return bounds;
}

Halves halve(std::span<const Reference> references) {
  const std::size_t middle = references.size() / 2;
  return {middle, {bounds_of(references.first(middle)), bounds_of(references.subspan(middle))}};
}

}  // namespace

Splitter::Splitter(const CentrePose& pose, const BuildSettings& settings, float root_area)
    : pose_(pose),
      settings_(settings),
      root_area_(root_area),
      min_spatial_references_(pose.primitives().grids.empty() ? kMinSpatialReferences : kMinSpatialPatches) {}

WorkSet Splitter::root(std::span<Reference> references, const SetBounds& bounds, std::size_t room) {
  return {references, bounds, room, 0, kFirstPatience};
}

SplitChoice Splitter::choose(const WorkSet& set) const {
  SplitChoice choice{SplitKind::kLeaf, ObjectBinning(set.bounds, set.size()), {}, {}, set.patience};
  const float area = half_area(set.bounds.box);
  const bool leaf = may_be_leaf(std::span<const Reference>(set.references), settings_);
  if (leaf && is_small_leaf(set.size())) return choice;
  choice.kind = SplitKind::kHalves;
  if (set.depth > kMaxSahDepth) {
    if (leaf) choice.kind = SplitKind::kLeaf;
    return choice;
  }
  choice.object = find_object_split(set.references, choice.binning);
  if (wants_spatial_split(set, choice.object, area)) {
    if (promises_gain(set, choice)) {
      choice.spatial = find_spatial_split(pose_, set.references, set.bounds.box);
      choice.patience = choice.spatial.cost < kWorthwhile * choice.object.cost ? kPatience : set.patience - 1;
    }
  }
  const float split_cost =
      settings_.split_cost * area + settings_.block_cost * std::min(choice.object.cost, choice.spatial.cost);
  const float leaf_cost = settings_.block_cost * area * block_count(set.size());
  if (leaf && leaf_cost <= split_cost) {
    choice.kind = SplitKind::kLeaf;
  } else if (choice.spatial.cost < choice.object.cost) {
    choice.kind = SplitKind::kSpatial;
  } else if (std::isfinite(choice.object.cost)) {
    choice.kind = SplitKind::kObject;
  } else if (leaf) {
    choice.kind = SplitKind::kLeaf;
  }
  return choice;
}

SplitChoice Splitter::choose_root(const WorkSet& set) const {
  if (settings_.sah_time != SahTime::kShutter || !moves_in_a_corner(primitives(), set.references))
    return choose(set);
  return {SplitKind::kMotion, ObjectBinning(set.bounds, set.size()), {}, {}, set.patience};
}

void Splitter::divide(const WorkSet& set, const SplitChoice& choice, WorkSet& left, WorkSet& right) const {
  std::span<Reference> all = set.references;
  std::size_t room = set.room;
  Halves halves;
  if (choice.kind == SplitKind::kObject) {
    halves = partition(all, IsLeftOfBin(choice.binning, choice.object));
  } else if (choice.kind == SplitKind::kSpatial) {
    const std::size_t added = cut_references(pose_, all, set.space_for(choice.spatial), choice.spatial);
    all = {all.data(), all.size() + added};
    room -= added;
    halves = partition(all, IsLeftOfPlane(choice.spatial));
  } else if (choice.kind == SplitKind::kMotion) {
    halves = partition(all, IsStill(primitives()));
  }
  if (halves.left_count == 0 || halves.left_count == all.size()) halves = halve(all);
  const std::size_t left_room = room * halves.left_count / all.size();
  left = {all.first(halves.left_count), halves.left(), left_room, set.depth + 1, choice.patience};
  right = {all.subspan(halves.left_count), halves.right(), room - left_room, set.depth + 1, choice.patience};
}

// Only where the object split's children overlap noticeably.
bool Splitter::wants_spatial_split(const WorkSet& set, const ObjectSplit& object, float area) const {
  if (settings_.builder != Builder::kMsbvh || set.room == 0) return false;
  if (set.size() < min_spatial_references_ || set.patience == 0) return false;
  if (!std::isfinite(object.cost)) return true;
  const float overlap = half_area(intersect(object.left, object.right));
  return overlap > settings_.spatial_split_root_overlap * root_area_ &&
         overlap > settings_.spatial_split_node_overlap * area;
}

bool Splitter::promises_gain(const WorkSet& set, const SplitChoice& choice) const {
  if (set.size() < 2 * kSample || !std::isfinite(choice.object.cost)) return true;
  const std::size_t stride = set.size() / kSample;
  const float cost = find_spatial_split(pose_, set.references, set.bounds.box, stride).cost;
  return cost < kSampleError * sampled_cost(set, choice.binning, choice.object, stride);
}

}  // namespace msbvh
