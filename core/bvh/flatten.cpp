#include "core/bvh/flatten.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/bvh/box_track.h"
#include "core/bvh/key_bounds.h"
#include "core/bvh/leaf_blocks.h"
#include "core/bvh/track_area.h"

namespace msbvh {
namespace {

// Subtrees of fewer bytes are written by one task, and planned by one from this depth on (8^3 tasks). Trees
// of fewer binary nodes are planned by one, too: of many small trees each takes less time than tasks do.
constexpr std::size_t kParallelBytes = 1 << 18;
constexpr std::uint32_t kParallelNodes = 512;
constexpr std::uint32_t kParallelDepth = 3;
// The cost of a patch: its tiles are 8 boxes, of which a ray that meets the patch enters one or two.
constexpr double kPatchBlocks = 3.0;

std::size_t rounded_up(std::size_t bytes, std::size_t unit) { return (bytes + unit - 1) / unit * unit; }

// The binary nodes that become the children of one wide node: the largest are opened until there are 8.
struct WideChildren {
  std::uint32_t node[kWidth];
  std::uint32_t count = 0;

  WideChildren(const Topology& topology, std::uint32_t root) {
    const BinaryNode* nodes = topology.nodes.get();
    node[0] = nodes[root].first;
    node[1] = nodes[root].first + 1;
    count = 2;
    while (count < kWidth) {
      int largest = -1;
      for (std::uint32_t i = 0; i < count; ++i) {
        if (nodes[node[i]].is_leaf()) continue;
        if (largest < 0 || nodes[node[i]].half_area() > nodes[node[largest]].half_area())
          largest = static_cast<int>(i);
      }
      if (largest < 0) break;
      const std::uint32_t opened = nodes[node[largest]].first;
      node[largest] = opened;
      node[count++] = opened + 1;
    }
  }
};

class Flattener {
 public:
  Flattener(const Primitives& primitives, Topology& topology, const BuildSettings& settings, Bvh& out)
      : primitives_(primitives),
        topology_(topology),
        settings_(settings),
        compact_(settings.layout == TreeLayout::kCompact),
        out_(out),
        plans_(topology.node_count) {}

  void run() {
    Tally tally;
    BoxTrack root = plan(0, 1, tally);
    const std::size_t bytes = plans_[0].bytes;
    if (bytes / kUnit >= ChildRef::kLeafFlag) {
      throw Error("accelerator: " + std::to_string(bytes) +
                  " bytes of nodes and leaves; expected less than 2^35");
    }
    out_.arena = AlignedBuffer(bytes + kArenaGuard);
    std::memset(out_.arena.data() + bytes, 0, kArenaGuard);
    emit(0, 0);
    out_.root = ref_of(0, 0);
    out_.root_form_code = child_code_of(0);
    out_.root_form = root.form;
    out_.still_parts = tally.still && !plans_[0].still;
    out_.root_bounds = std::move(root.controls);
    out_.max_level = level_of(tally.segments);
    report(tally);
  }

 private:
  // What the first pass finds out about a subtree.
  struct Plan {
    std::size_t bytes = 0;  // of the whole subtree; a multiple of 64 for inner nodes, of 16 for leaves
    TrackForm form;         // of the node itself
    FormCode first_block = FormCode::of({});  // of a leaf, as its parent tells it
    std::vector<Box3f> slots;                 // of inner nodes: SlotTracks::controls
    bool still = true;                        // NodeHeader::still_children
  };
  // Summed over children in their order, so that the sums do not depend on threads.
  struct Tally {
    std::uint64_t nodes = 0, leaves = 0, node_bytes = 0, leaf_bytes = 0;
    std::uint32_t depth = 0;
    std::uint32_t segments = 0;         // the most of any node or block
    std::uint32_t motion_segments = 0;  // the most of any block
    double cost = 0.0;
    bool indexed = false;
    bool still = false;  // some of it, as NodeHeader::still_children has it

    void add(const Tally& t) {
      nodes += t.nodes;
      leaves += t.leaves;
      node_bytes += t.node_bytes;
      leaf_bytes += t.leaf_bytes;
      depth = std::max(depth, t.depth);
      segments = std::max(segments, t.segments);
      motion_segments = std::max(motion_segments, t.motion_segments);
      cost += t.cost;
      indexed |= t.indexed;
      still |= t.still;
    }
  };

  bool is_leaf(std::uint32_t node) const { return topology_.nodes[node].is_leaf(); }
  std::span<Reference> leaf_references(std::uint32_t node) {
    const BinaryNode& n = topology_.nodes[node];
    return {topology_.references.data() + n.first, n.count};
  }
  ChildRef ref_of(std::uint32_t node, std::size_t offset) const {
    const auto unit = static_cast<std::uint32_t>(offset / kUnit);
    return is_leaf(node) ? ChildRef::leaf(unit) : ChildRef::node(unit);
  }

  // The first pass, bottom-up: boxes, forms and sizes. Returns the box of the subtree.
  BoxTrack plan(std::uint32_t node, std::uint32_t depth, Tally& tally) {
    return is_leaf(node) ? plan_leaf(node, depth, tally) : plan_node(node, depth, tally);
  }

  BoxTrack plan_node(std::uint32_t node, std::uint32_t depth, Tally& tally) {
    if (depth > kMaxDepth) throw Error("accelerator: deeper than " + std::to_string(kMaxDepth) + " nodes");
    const WideChildren children(topology_, node);
    std::array<BoxTrack, kWidth> tracks;
    std::array<Tally, kWidth> tallies;
    const bool parallel = depth <= kParallelDepth && topology_.node_count >= kParallelNodes;
    if (parallel && settings_.cancelled && settings_.cancelled()) throw Cancelled();
    parallel_for_ranges(children.count, parallel ? 1 : kWidth, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) tracks[i] = plan(children.node[i], depth + 1, tallies[i]);
    });
    TrackForm form;
    for (std::uint32_t i = 0; i < children.count; ++i) {
      form = common_form(form, tracks[i].form);
      tally.add(tallies[i]);
    }
    SlotTracks slots(form, children.count);
    for (std::uint32_t i = 0; i < children.count; ++i)
      grow_track(slots.slot(i), form, tracks[i].controls, tracks[i].form);
    slots.measure();
    if (settings_.fewest_keys) slots = in_fewest_segments(std::move(slots));
    if (compact_) {  // what lies above bounds the boxes that rays will see
      round_outwards(slots.controls);
      slots.measure();
    }
    keep(node, children, slots, tally);
    tally.depth = std::max(tally.depth, depth);
    BoxTrack all = union_of(slots, finest(tally));
    plans_[node].slots = std::move(slots.controls);
    return all;
  }

  // A node may have twice the segments of what moves in it. In the time of a slice there is but one, and
  // without fewest_keys nothing would take back those that do not pay.
  std::uint32_t finest(const Tally& tally) const {
    if (!settings_.fewest_keys) return tally.motion_segments;
    return primitives_.slice.whole() ? std::min(2 * tally.motion_segments, kMaxSegments) : 1;
  }
  FormCode code_of(const TrackForm& form) const {
    return primitives_.slice.whole() || !form.moving() ? FormCode::of(form) : FormCode::of_slice(form.degree);
  }

  // What a parent tells of a child. A leaf has nothing to fetch at a ray's own key where its first block's
  // vertices stand elsewhere: it is told as still.
  FormCode child_code_of(std::uint32_t node) const {
    const Plan& p = plans_[node];
    return is_leaf(node) ? p.first_block : code_of(p.form).of_node(compact_);
  }

  void keep(std::uint32_t node, const WideChildren& children, const SlotTracks& slots, Tally& tally) {
    Plan& p = plans_[node];
    p.form = slots.form;
    p.bytes = node_bytes(p.form, compact_);
    std::size_t leaves = 0;
    for (std::uint32_t i = 0; i < children.count; ++i) {
      const bool leaf = is_leaf(children.node[i]);
      (leaf ? leaves : p.bytes) += plans_[children.node[i]].bytes;
      p.still &= plans_[children.node[i]].still;
      tally.cost += slots.area[i] * (leaf ? settings_.block_cost * block_units(children.node[i]) : 1.0);
    }
    p.bytes += rounded_up(leaves, AlignedBuffer::kAlignment);
    tally.segments = std::max(tally.segments, p.form.segments);
    ++tally.nodes;
    tally.node_bytes += node_bytes(p.form, compact_);
  }

  bool is_patch(std::uint32_t node) const {
    return is_leaf(node) && topology_.references[topology_.nodes[node].first].is_grid();
  }
  double block_units(std::uint32_t leaf) const {
    if (is_patch(leaf)) return kPatchBlocks;
    if (topology_.references[topology_.nodes[leaf].first].is_curve()) return topology_.nodes[leaf].count;
    return (topology_.nodes[leaf].count + kBlockWidth - 1) / kBlockWidth;
  }

  BoxTrack plan_leaf(std::uint32_t node, std::uint32_t depth, Tally& tally) {
    const std::span<Reference> refs = leaf_references(node);
    sort_leaf(primitives_, refs);
    Plan& p = plans_[node];
    for (const Reference& r : refs) p.form = common_form(p.form, node_form_of(primitives_, r));
    for (std::span<const Reference> rest = refs; !rest.empty();) {
      const LeafBlock block = first_block(primitives_, rest);
      if (p.bytes == 0 && block.kind == BlockKind::kGathered)
        p.first_block = FormCode::of(block.form).with_vertices(block.vertex_count);
      p.bytes += block.bytes();
      const bool triangles = block.kind == BlockKind::kGathered || block.kind == BlockKind::kIndexed;
      p.still &= triangles && !block.form.moving();
      rest = rest.subspan(block.references);
      tally.indexed |= block.kind == BlockKind::kIndexed;
    }
    tally.segments = tally.motion_segments = p.form.segments;
    tally.leaves = 1;
    tally.still = p.still;
    tally.leaf_bytes = p.bytes;
    tally.depth = depth - 1;
    BoxTrack track(p.form);
    for (const Reference& r : refs) grow_by_reference(track.controls, p.form, primitives_, r);
    return track;
  }

  // The second pass: bytes.
  void emit(std::uint32_t node, std::size_t offset) {
    is_leaf(node) ? emit_leaf(node, offset) : emit_node(node, offset);
  }

  void emit_node(std::uint32_t node, std::size_t offset) {
    const WideChildren children(topology_, node);
    Plan& p = plans_[node];
    NodeHeader& header = *new (out_.arena.data() + offset) NodeHeader{};
    header.form_code = code_of(p.form);
    header.child_count = static_cast<std::uint8_t>(children.count);
    header.compact = compact_;
    compact_ ? write_compact(p, children.count, header) : write_bounds(p, children.count, header.bounds());
    p.slots = {};
    std::size_t offsets[kWidth];
    place(children, offset + node_bytes(p.form, compact_), offsets);
    for (std::uint32_t i = 0; i < children.count; ++i) {
      header.child[i] = ref_of(children.node[i], offsets[i]);
      header.child_form[i] = child_code_of(children.node[i]);
      header.still_children |= static_cast<std::uint8_t>(plans_[children.node[i]].still << i);
    }
    parallel_for_ranges(children.count, p.bytes > kParallelBytes ? 1 : kWidth,
                        [&](std::size_t begin, std::size_t end) {
                          for (std::size_t i = begin; i < end; ++i) emit(children.node[i], offsets[i]);
                        });
  }

  static void write_compact(const Plan& plan, std::uint32_t count, NodeHeader& header) {
    header.frame = frame_around(plan.slots);
    const std::uint32_t controls = plan.form.controls();
    for (std::uint32_t c = 0; c < controls; ++c) {
      CompactBounds& out = *new (header.compact_bounds() + c) CompactBounds;
      for (std::uint32_t i = 0; i < count; ++i)
        out.set_box(header.frame, i, plan.slots[std::size_t(i) * controls + c]);
      for (std::uint32_t i = count; i < kWidth; ++i) out.set_absent(i);
    }
  }

  static void write_bounds(const Plan& plan, std::uint32_t count, NodeBounds* out) {
    constexpr Box3f kNothing{{kAbsent, kAbsent, kAbsent}, {-kAbsent, -kAbsent, -kAbsent}};
    const std::uint32_t controls = plan.form.controls();
    for (std::uint32_t c = 0; c < controls; ++c) {
      for (std::uint32_t i = 0; i < kWidth; ++i)
        out[c].set_box(i, i < count ? plan.slots[std::size_t(i) * controls + c] : kNothing);
    }
  }

  // Leaves right behind the node, where the next cache line is, patches first, which are whole lines; then
  // the inner children, depth first.
  void place(const WideChildren& children, std::size_t offset, std::size_t* offsets) {
    for (const bool patches : {true, false}) {
      for (std::uint32_t i = 0; i < children.count; ++i) {
        if (!is_leaf(children.node[i]) || is_patch(children.node[i]) != patches) continue;
        offsets[i] = offset;
        offset += plans_[children.node[i]].bytes;
      }
    }
    const std::size_t gap = rounded_up(offset, AlignedBuffer::kAlignment) - offset;
    std::memset(out_.arena.data() + offset, 0, gap);  // no byte of the arena is left to chance
    offset += gap;
    for (std::uint32_t i = 0; i < children.count; ++i) {
      if (is_leaf(children.node[i])) continue;
      offsets[i] = offset;
      offset += plans_[children.node[i]].bytes;
    }
  }

  void emit_leaf(std::uint32_t node, std::size_t offset) {
    std::span<const Reference> refs = leaf_references(node);
    while (!refs.empty()) {
      const LeafBlock block = first_block(primitives_, refs);
      refs = refs.subspan(block.references);
      write_block(primitives_, block, refs.empty(), out_.arena.data() + offset);
      offset += block.bytes();
    }
  }

  void report(const Tally& t) {
    BvhStatistics& s = out_.statistics;
    s.nodes = t.nodes;
    s.leaves = t.leaves;
    s.node_bytes = t.node_bytes;
    s.leaf_bytes = t.leaf_bytes;
    s.depth = t.depth;
    s.max_segments = t.motion_segments;
    const double root_area = mean_half_area(out_.root_bounds, out_.root_form);
    s.sah_cost = 1.0 + (root_area > 0.0 ? t.cost / root_area : 0.0);
    if (!t.indexed) return;
    for (const auto& mesh : primitives_.meshes) {
      if (triangle_block_kind(primitives_, mesh->form()) == BlockKind::kIndexed)
        s.vertex_bytes += mesh->positions.size() * sizeof(Vec3f);
    }
  }

  const Primitives& primitives_;
  Topology& topology_;
  const BuildSettings& settings_;
  const bool compact_;
  Bvh& out_;
  std::vector<Plan> plans_;  // by binary node; filled for leaves and for those that become wide nodes
};

}  // namespace

void flatten(const Primitives& primitives, Topology& topology, const BuildSettings& settings, Bvh& out) {
  if (topology.node_count == 0) return;
  Flattener(primitives, topology, settings, out).run();
  out.empty = false;
}

}  // namespace msbvh
