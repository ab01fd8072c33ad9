#include "core/build/topology.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/build/object_split.h"
#include "core/build/spatial_split.h"

namespace msbvh {
namespace {

// Below this depth the SAH decides; further down a set is halved, which ends within 32 more levels. Only sets
// that the SAH peels one by one come here.
constexpr int kMaxSahDepth = 56;
constexpr std::size_t kParallelReferences = 2048;
constexpr std::size_t kCancelReferences = 4096;

// A contiguous run of references, with free slots behind it that spatial splits may fill. Handing the free
// slots down bounds the number of references whatever the splits do, and keeps the build deterministic.
struct Range {
  std::size_t begin, end, slots_end;
  std::size_t count() const { return end - begin; }
  std::size_t free_slots() const { return slots_end - end; }
};

class TopologyBuilder {
 public:
  TopologyBuilder(const Primitives& primitives, const BuildSettings& settings, Topology& out)
      : primitives_(primitives), settings_(settings), out_(out) {}

  void run(std::size_t count) {
    const SetBounds bounds = bounds_of({out_.references.data(), count});
    root_area_ = half_area(bounds.box);
    next_node_ = 1;
    build(0, {0, count, out_.references.size()}, bounds, 0);
    out_.node_count = next_node_;
    out_.reference_count = leaf_references_;
  }

 private:
  void build(std::uint32_t node, Range range, const SetBounds& bounds, int depth) {
    check_cancelled(range);
    set_box(node, bounds.box);
    Range left, right;
    if (!split(range, bounds, depth, left, right)) return make_leaf(node, range);
    const std::uint32_t children = next_node_.fetch_add(2);
    out_.nodes[node].first = children;
    out_.nodes[node].count = 0;
    const auto build_child = [this, depth](std::uint32_t child, const Range& r) {
      build(child, r, bounds_of(references(r)), depth + 1);
    };
    if (range.count() < kParallelReferences) {
      build_child(children, left);
      build_child(children + 1, right);
    } else {
      parallel_invoke([&] { build_child(children, left); }, [&] { build_child(children + 1, right); });
    }
  }

  // False: the range becomes a leaf.
  bool split(Range range, const SetBounds& bounds, int depth, Range& left, Range& right) {
    if (range.count() == 1) return false;
    if (depth > kMaxSahDepth) return may_be_leaf(range) ? false : halve(range, left, right);
    const ObjectBinning binning(bounds.centres);
    const ObjectSplit object = find_object_split(references(range), binning);
    const SpatialSplit spatial = wants_spatial_split(object, range, half_area(bounds.box))
                                     ? find_spatial_split(primitives_, references(range), bounds.box)
                                     : SpatialSplit{};
    const float area = half_area(bounds.box);
    const float split_cost = area + settings_.block_cost * std::min(object.cost, spatial.cost);
    const float leaf_cost = settings_.block_cost * area * block_count(range.count());
    if (may_be_leaf(range) && leaf_cost <= split_cost) return false;
    if (spatial.cost < object.cost && split_space(range, spatial, left, right)) return true;
    if (std::isfinite(object.cost)) return split_objects(range, binning, object, left, right);
    return may_be_leaf(range) ? false : halve(range, left, right);
  }

  bool may_be_leaf(const Range& range) const {
    if (range.count() > settings_.max_leaf_triangles) return false;
    const auto refs = references(range);
    return range.count() == 1 || std::none_of(refs.begin(), refs.end(), [](const Reference& r) {
             return r.is_instance() || r.is_grid();
           });
  }

  // Only where the object split's children overlap noticeably.
  bool wants_spatial_split(const ObjectSplit& object, const Range& range, float area) const {
    if (settings_.builder != Builder::kMsbvh || range.free_slots() == 0) return false;
    if (!std::isfinite(object.cost)) return true;
    const float overlap = half_area(intersect(object.left, object.right));
    return overlap > settings_.spatial_split_root_overlap * root_area_ &&
           overlap > settings_.spatial_split_node_overlap * area;
  }

  bool split_objects(Range range, const ObjectBinning& binning, const ObjectSplit& split, Range& left,
                     Range& right) {
    const auto middle = std::partition(begin(range), end(range), [&](const Reference& r) {
      return binning.bin(r.box, split.axis) < split.first_right_bin;
    });
    share(range, static_cast<std::size_t>(middle - out_.references.begin()), left, right);
    return true;
  }

  // False, with the references untouched, if the free slots do not suffice or one side stays empty. Ends
  // always: a split that cuts uses up free slots, one that does not leaves fewer references on either side.
  bool split_space(Range range, const SpatialSplit& split, Range& left, Range& right) {
    if (split.left_count + split.right_count - range.count() > range.free_slots()) return false;
    std::vector<Reference> lefts, rights;
    lefts.reserve(split.left_count);
    rights.reserve(split.right_count);
    for (const Reference& r : references(range)) {
      const DividedReference d = divide(primitives_, r, split);
      if (d.in_left) lefts.push_back(d.left);
      if (d.in_right) rights.push_back(d.right);
    }
    const std::size_t total = lefts.size() + rights.size();
    if (lefts.empty() || rights.empty() || total - range.count() > range.free_slots()) return false;
    std::copy(lefts.begin(), lefts.end(), begin(range));
    std::copy(rights.begin(), rights.end(), begin(range) + static_cast<std::ptrdiff_t>(lefts.size()));
    range.end = range.begin + total;
    share(range, range.begin + lefts.size(), left, right);
    return true;
  }

  bool halve(Range range, Range& left, Range& right) {
    share(range, range.begin + range.count() / 2, left, right);
    return true;
  }

  // Divides the free slots among the children by their number of references; the right one's references move
  // up.
  void share(const Range& range, std::size_t middle, Range& left, Range& right) {
    const std::size_t left_count = middle - range.begin, right_count = range.end - middle;
    const std::size_t left_free = range.free_slots() * left_count / range.count();
    const std::size_t moved = std::min(left_free, right_count);
    const auto at = [this](std::size_t i) {
      return out_.references.begin() + static_cast<std::ptrdiff_t>(i);
    };
    std::copy_backward(at(middle), at(middle + moved), at(range.end + left_free));
    left = {range.begin, middle, middle + left_free};
    right = {middle + left_free, range.end + left_free, range.slots_end};
  }

  void make_leaf(std::uint32_t node, const Range& range) {
    out_.nodes[node].first = static_cast<std::uint32_t>(range.begin);
    out_.nodes[node].count = static_cast<std::uint32_t>(range.count());
    leaf_references_ += range.count();
  }

  void set_box(std::uint32_t node, const Box3f& box) {
    for (int axis = 0; axis < 3; ++axis) {
      out_.nodes[node].lo[axis] = box.lo[axis];
      out_.nodes[node].hi[axis] = box.hi[axis];
    }
  }

  void check_cancelled(const Range& range) const {
    if (range.count() >= kCancelReferences && settings_.cancelled && settings_.cancelled()) throw Cancelled();
  }

  std::vector<Reference>::iterator begin(const Range& r) {
    return out_.references.begin() + static_cast<std::ptrdiff_t>(r.begin);
  }
  std::vector<Reference>::iterator end(const Range& r) {
    return out_.references.begin() + static_cast<std::ptrdiff_t>(r.end);
  }
  std::span<const Reference> references(const Range& r) const {
    return {out_.references.data() + r.begin, r.count()};
  }

  const Primitives& primitives_;
  const BuildSettings& settings_;
  Topology& out_;
  float root_area_ = 0.0f;
  std::atomic<std::uint32_t> next_node_{0};
  std::atomic<std::uint64_t> leaf_references_{0};
};

}  // namespace

Topology build_topology(const Primitives& primitives, const BuildSettings& settings) {
  Topology out;
  out.references = make_references(primitives);
  const std::size_t count = out.references.size();
  if (count == 0) return out;
  const bool spatial = settings.builder == Builder::kMsbvh;
  const auto extra =
      static_cast<std::size_t>(spatial ? settings.spatial_split_budget * static_cast<float>(count) : 0.0f);
  if (count + extra >= (std::size_t(1) << 31)) {
    throw Error("accelerator: " + std::to_string(count) + " primitives; expected fewer than 2^31 references");
  }
  out.references.resize(count + extra);
  out.nodes.reset(new BinaryNode[2 * (count + extra)]);
  TopologyBuilder(primitives, settings, out).run(count);
  return out;
}

}  // namespace msbvh
