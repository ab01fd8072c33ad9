#include "core/bvh/rebraid.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <queue>
#include <utility>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/build/topology.h"
#include "core/bvh/build_bvh.h"
#include "core/bvh/instance_bounds.h"
#include "core/bvh/key_bounds.h"
#include "core/bvh/track_area.h"
#include "core/motion/bezier.h"

namespace msbvh {
namespace {

constexpr std::size_t kInstancesPerTask = 1024;
constexpr std::size_t kOpenedPerTask = 16;

// Opened is what boxes of other instances take up this share of, each counted: the budget is for overlap.
constexpr float kOverlap = 0.5f;
// ... and whose children together have at most so much of its area: a ray enters an instance as often as it
// meets the boxes of its parts, and that costs a transform (docs/design/rebraiding.md).
constexpr float kMaxGrowth = 1.0f;

InstanceBounds bounds_of(const Bvh& bvh, const InstancePart& part) {
  const Instance& instance = bvh.instances[part.instance];
  if (part.is_whole()) return instance_bounds_of(bvh, instance);
  return bound_slot(bvh, instance, {instance.object->node({part.parent}), part.slot});
}

// The value of a track at the shutter's centre.
template <typename Control>
auto at_centre(const Control& control, const TrackForm& form) {
  const SegmentTime at = locate(0.5f, form.segments);
  const auto in_segment = [&](std::uint32_t i) { return control(at.key * form.degree + i); };
  return form.moving() ? bezier(in_segment, form.degree, at.w) : control(0);
}

// Where instances are at the shutter's centre, to be asked who overlaps whom.
class Neighbours {
 public:
  explicit Neighbours(const InstanceParts& all)
      : topology_(build_topology({.meshes = {}, .instances = all.bounds, .parts = all.parts}, {})) {}

  // Whether boxes of instances other than `self` take up kOverlap of the box's area, counted by each of them.
  bool overlapped(std::uint32_t self, const Box3f& box) const {
    float left = kOverlap * half_area(box);
    if (topology_.node_count > 0) visit(0, self, box, left);
    return left <= 0.0f;
  }

 private:
  void visit(std::uint32_t node, std::uint32_t self, const Box3f& box, float& left) const {
    const BinaryNode& n = topology_.nodes[node];
    if (left <= 0.0f ||
        intersect(box, Box3f{{n.lo[0], n.lo[1], n.lo[2]}, {n.hi[0], n.hi[1], n.hi[2]}}).empty())
      return;
    if (!n.is_leaf()) {
      visit(n.first, self, box, left);
      visit(n.first + 1, self, box, left);
      return;
    }
    for (std::uint32_t i = n.first; i < n.first + n.count; ++i) {
      const Reference& r = topology_.references[i];
      if (r.index != self) left -= half_area(intersect(box, r.box));
    }
  }

  const Topology topology_;  // references are instances: all are whole here
};

// What the boxes of a node's children have of that around all of them, in the outer tree at the shutter's
// centre. An estimate: nothing is padded, and time remaps are not asked.
class Growth {
 public:
  Growth(const Bvh& bvh, const Instance& instance) {
    const Affine3f* controls = bvh.controls_of(instance);
    const auto column = [&](Vec3f Affine3f::*c) {
      return abs(at_centre([&](std::uint32_t i) { return controls[i].*c; }, instance.form));
    };
    columns_ = {column(&Affine3f::x), column(&Affine3f::y), column(&Affine3f::z), {}};
  }
  float of(const NodeHeader& node) const {
    Box3f all;
    float sum = 0.0f;
    for (std::uint32_t i = 0; i < node.child_count; ++i) {
      const Box3f box = at_centre([&](std::uint32_t c) { return node.box(c, i); }, node.form());
      all.grow(box);
      sum += area(box);
    }
    const float whole = area(all);
    return whole > 0.0f ? sum / whole : std::numeric_limits<float>::infinity();
  }

 private:
  // Of the box around the image.
  float area(const Box3f& box) const { return half_area(Box3f{{}, columns_.vector(box.extent())}); }

  Affine3f columns_;  // by magnitude
};

class Braider {
 public:
  Braider(const Bvh& bvh, const InstanceParts& whole, const BuildSettings& settings)
      : bvh_(bvh),
        settings_(settings),
        parts_(whole),
        left_(static_cast<std::size_t>(settings.rebraid_budget * static_cast<float>(whole.parts.size()))) {}

  InstanceParts run() {
    for (std::uint32_t i = 0; i < parts_.parts.size(); ++i) offer(i);
    if (!queue_.empty()) neighbours_.emplace(parts_);
    while (left_ > 0 && !queue_.empty()) {
      if (settings_.cancelled && settings_.cancelled()) throw Cancelled();
      open_largest();
    }
    return std::move(parts_);
  }

 private:
  struct Candidate {
    double area;  // averaged over the shutter
    std::uint32_t part;
    bool operator<(const Candidate& c) const { return area != c.area ? area < c.area : part > c.part; }
  };

  // The inner node that a part begins at, or null.
  const NodeHeader* node_of(const InstancePart& part) const {
    const Bvh& object = *bvh_.instances[part.instance].object;
    if (object.empty || !object.slice_roots.empty()) return nullptr;
    const ChildRef ref = part.is_whole() ? object.root : ChildRef{part.child};
    return ref.is_leaf() ? nullptr : &object.node(ref);
  }

  void offer(std::uint32_t i) {
    const InstanceBounds& bounds = parts_.bounds[i];
    const InstancePart& part = parts_.parts[i];
    const NodeHeader* node = node_of(part);
    if (bounds.controls.empty() || !node) return;
    if (!(Growth(bvh_, bvh_.instances[part.instance]).of(*node) <= kMaxGrowth)) return;
    queue_.push({mean_half_area(bounds.controls, bounds.form), i});
  }

  // Those that are at least half as large as the largest, all at once; they are replaced in their order.
  void open_largest() {
    std::vector<Candidate> chosen;
    const double least = 0.5 * queue_.top().area;
    do {  // always one: an area that is not a number is not at least anything
      chosen.push_back(queue_.top());
      queue_.pop();
    } while (!queue_.empty() && queue_.top().area >= least && chosen.size() <= left_ / 4);
    std::vector<InstanceParts> opened(chosen.size());
    parallel_for_ranges(chosen.size(), kOpenedPerTask, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) opened[i] = open(chosen[i].part);
    });
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      const std::size_t parts = opened[i].parts.size();
      if (parts > 0 && parts - 1 <= left_) replace(chosen[i].part, std::move(opened[i]));
    }
  }

  // The parts below the node that a part begins at; none where others do not overlap it.
  InstanceParts open(std::uint32_t i) const {
    const InstancePart& part = parts_.parts[i];
    const InstanceBounds& bounds = parts_.bounds[i];
    InstanceParts children;
    const Box3f box = at_centre([&](std::uint32_t c) { return bounds.controls[c]; }, bounds.form);
    if (!neighbours_->overlapped(part.instance, box)) return children;
    const NodeHeader& node = *node_of(part);
    const ChildRef parent =
        part.is_whole() ? bvh_.instances[part.instance].object->root : ChildRef{part.child};
    for (std::uint8_t slot = 0; slot < node.child_count; ++slot) {
      children.parts.push_back(
          {part.instance, parent.bits, node.child[slot].bits, slot, node.child_form[slot].bits});
      children.bounds.push_back(bounds_of(bvh_, children.parts.back()));
    }
    return children;
  }

  void replace(std::uint32_t part, InstanceParts children) {
    left_ -= children.parts.size() - 1;
    for (std::size_t i = 0; i < children.parts.size(); ++i) {
      const auto at = i == 0 ? part : static_cast<std::uint32_t>(parts_.parts.size());
      if (i > 0) {
        parts_.parts.emplace_back();
        parts_.bounds.emplace_back();
      }
      parts_.parts[at] = children.parts[i];
      parts_.bounds[at] = std::move(children.bounds[i]);
      offer(at);
    }
  }

  const Bvh& bvh_;
  std::optional<Neighbours> neighbours_;
  const BuildSettings& settings_;
  InstanceParts parts_;
  std::size_t left_;  // references that may still be added
  std::priority_queue<Candidate> queue_;
};

}  // namespace

SlotTrack::SlotTrack(const NodeHeader& node, std::uint32_t slot) : form(node.form()) {
  for (std::uint32_t c = 0; c < form.controls(); ++c) controls.push_back(node.box(c, slot));
}

InstanceBounds bound_slot(const Bvh& bvh, const Instance& instance, const SlotTrack& slot) {
  return bound_instance(
      {{bvh.controls_of(instance), instance.form.controls()}, instance.form, bvh.time_remap_of(instance)},
      {slot.controls, slot.form, &instance.object->time_remap});
}

InstanceParts kept_parts(const Bvh& bvh, std::vector<InstancePart> parts) {
  InstanceParts result{std::move(parts), {}};
  result.bounds.resize(result.parts.size());
  parallel_for_ranges(result.parts.size(), kInstancesPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) result.bounds[i] = bounds_of(bvh, result.parts[i]);
  });
  return result;
}

InstanceParts whole_instances(const Bvh& bvh) {
  std::vector<InstancePart> parts(bvh.instances.size());
  for (std::uint32_t i = 0; i < parts.size(); ++i) parts[i].instance = i;
  return kept_parts(bvh, std::move(parts));
}

InstanceParts rebraided(const Bvh& bvh, InstanceParts all, const BuildSettings& settings) {
  if (!(settings.rebraid_budget > 0.0f) || all.parts.size() < 2 || bvh.builder == Builder::kTimeSplit)
    return all;
  return Braider(bvh, all, settings).run();
}

}  // namespace msbvh
