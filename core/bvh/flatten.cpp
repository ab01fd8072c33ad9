#include "core/bvh/flatten.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/bvh/grid_block.h"
#include "core/bvh/key_bounds.h"

namespace msbvh {
namespace {

// Subtrees of fewer bytes are written by one task, and planned by one from this depth on (8^3 tasks).
constexpr std::size_t kParallelBytes = 1 << 18;
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

// A run of a leaf's references that shares a block.
struct BlockRange {
  std::span<const Reference> references;  // without repeats, 1 to 4
  TrackForm form;
  bool instance, grid;
  std::size_t bytes() const {
    if (grid) return grid_block_bytes(form);
    return instance ? sizeof(BlockHeader) : triangle_block_bytes(form);
  }
};

class Flattener {
 public:
  Flattener(const Primitives& primitives, Topology& topology, const BuildSettings& settings, Bvh& out)
      : primitives_(primitives),
        topology_(topology),
        settings_(settings),
        out_(out),
        plans_(topology.node_count) {}

  void run() {
    plan(0, 0);
    const std::size_t bytes = plans_[0].bytes;
    if (bytes / kUnit >= ChildRef::kLeafFlag) {
      throw Error("accelerator: " + std::to_string(bytes) +
                  " bytes of nodes and leaves; expected less than 2^35");
    }
    out_.arena = AlignedBuffer(bytes);
    out_.root_form = plans_[0].form;
    out_.root_bounds.assign(out_.root_form.controls(), {});
    const Tally tally = emit(0, 0, out_.root_bounds, 1);
    out_.root = ref_of(0, 0);
    out_.max_level = level_of(plans_[0].form.segments);
    report(tally);
  }

 private:
  // What the layout pass learns of a subtree.
  struct Plan {
    std::size_t bytes = 0;  // of the whole subtree; a multiple of 64 for inner nodes, of 16 for leaves
    TrackForm form;
  };
  // Summed over children in their order, so that the sums do not depend on threads.
  struct Tally {
    std::uint64_t nodes = 0, leaves = 0, node_bytes = 0, leaf_bytes = 0;
    std::uint32_t depth = 0;
    double cost = 0.0;
    bool indexed = false;

    void add(const Tally& t) {
      nodes += t.nodes;
      leaves += t.leaves;
      node_bytes += t.node_bytes;
      leaf_bytes += t.leaf_bytes;
      depth = std::max(depth, t.depth);
      cost += t.cost;
      indexed |= t.indexed;
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
  TrackForm form(const Reference& r) const { return form_of(primitives_, r); }

  void plan(std::uint32_t node, std::uint32_t depth) {
    if (is_leaf(node)) return plan_leaf(node);
    const WideChildren children(topology_, node);
    const bool parallel = depth < kParallelDepth;
    if (parallel && settings_.cancelled && settings_.cancelled()) throw Cancelled();
    parallel_for_ranges(children.count, parallel ? 1 : kWidth, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) plan(children.node[i], depth + 1);
    });
    Plan& p = plans_[node];
    for (std::uint32_t i = 0; i < children.count; ++i)
      p.form = common_form(p.form, plans_[children.node[i]].form);
    p.bytes = node_bytes(p.form);
    std::size_t leaves = 0;
    for (std::uint32_t i = 0; i < children.count; ++i) {
      (is_leaf(children.node[i]) ? leaves : p.bytes) += plans_[children.node[i]].bytes;
    }
    p.bytes += rounded_up(leaves, AlignedBuffer::kAlignment);
  }

  void plan_leaf(std::uint32_t node) {
    const std::span<Reference> refs = leaf_references(node);
    std::sort(refs.begin(), refs.end(), [&](const Reference& a, const Reference& b) {
      const TrackForm fa = form(a), fb = form(b);
      return std::tuple(fa.segments, fa.degree, a.mesh(), a.index) <
             std::tuple(fb.segments, fb.degree, b.mesh(), b.index);
    });
    Plan& p = plans_[node];
    for (const Reference& r : refs) p.form = common_form(p.form, form(r));
    for (const BlockRange& b : blocks(refs)) p.bytes += b.bytes();
  }

  // Blocks of at most 4 distinct triangles of one form, or of one instance. Two fragments of one triangle
  // that meet again in a leaf share an entry. A patch is alone in its leaf.
  std::vector<BlockRange> blocks(std::span<const Reference> refs) {
    std::vector<BlockRange> out;
    std::size_t begin = 0;
    std::uint32_t distinct = 0;
    for (std::size_t i = 0; i < refs.size(); ++i) {
      const bool repeat =
          i > begin && refs[i].mesh() == refs[i - 1].mesh() && refs[i].index == refs[i - 1].index;
      const bool full = distinct == kBlockWidth && !repeat;
      const bool other = i > begin && (form(refs[i]) != form(refs[begin]) || refs[i].is_instance() ||
                                       refs[begin].is_instance());
      if (i > begin && (full || other)) {
        out.push_back({refs.subspan(begin, i - begin), form(refs[begin]), refs[begin].is_instance(), false});
        begin = i;
        distinct = 0;
      }
      if (!repeat || distinct == 0) ++distinct;
    }
    out.push_back({refs.subspan(begin), form(refs[begin]), refs[begin].is_instance(), refs[begin].is_grid()});
    return out;
  }

  Tally emit(std::uint32_t node, std::size_t offset, std::span<Box3f> bounds, std::uint32_t depth) {
    return is_leaf(node) ? emit_leaf(node, offset, bounds, depth) : emit_node(node, offset, bounds, depth);
  }

  Tally emit_node(std::uint32_t node, std::size_t offset, std::span<Box3f> bounds, std::uint32_t depth) {
    if (depth > kMaxDepth) throw Error("accelerator: deeper than " + std::to_string(kMaxDepth) + " nodes");
    const WideChildren children(topology_, node);
    const Plan& p = plans_[node];
    const std::uint32_t controls = p.form.controls();
    NodeHeader& header = *new (out_.arena.data() + offset) NodeHeader{};
    header.level = static_cast<std::uint16_t>(level_of(p.form.segments));
    header.degree = static_cast<std::uint16_t>(p.form.degree);
    header.child_count = children.count;
    std::size_t offsets[kWidth];
    place(children, offset + node_bytes(p.form), offsets);

    std::vector<Box3f> slots(std::size_t(kWidth) * controls);
    std::array<Tally, kWidth> tallies;
    parallel_for_ranges(children.count, p.bytes > kParallelBytes ? 1 : kWidth,
                        [&](std::size_t begin, std::size_t end) {
                          for (std::size_t i = begin; i < end; ++i) {
                            const std::uint32_t child = children.node[i];
                            const TrackForm child_form = plans_[child].form;
                            std::vector<Box3f> track(child_form.controls());
                            tallies[i] = emit(child, offsets[i], track, depth + 1);
                            grow_track({slots.data() + i * controls, controls}, p.form, track, child_form);
                            header.child[i] = ref_of(child, offsets[i]);
                          }
                        });
    Tally sum;
    for (std::uint32_t i = 0; i < children.count; ++i) {
      const std::span<const Box3f> slot(slots.data() + i * controls, controls);
      sum.add(tallies[i]);
      sum.cost += mean_half_area(slot, p.form) *
                  (is_leaf(children.node[i]) ? settings_.block_cost * block_units(children.node[i]) : 1.0);
      for (std::uint32_t c = 0; c < controls; ++c) bounds[c].grow(slot[c]);
    }
    write_bounds(header, slots, controls);
    ++sum.nodes;
    sum.node_bytes += node_bytes(p.form);
    sum.depth = std::max(sum.depth, depth);
    return sum;
  }

  // Leaves right behind the node, where the next cache line is; then the inner children, depth first.
  void place(const WideChildren& children, std::size_t offset, std::size_t* offsets) {
    for (std::uint32_t i = 0; i < children.count; ++i) {
      if (!is_leaf(children.node[i])) continue;
      offsets[i] = offset;
      offset += plans_[children.node[i]].bytes;
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

  double block_units(std::uint32_t leaf) const {
    if (topology_.references[topology_.nodes[leaf].first].is_grid()) return kPatchBlocks;
    return (topology_.nodes[leaf].count + kBlockWidth - 1) / kBlockWidth;
  }

  static void write_bounds(NodeHeader& header, std::span<const Box3f> slots, std::uint32_t controls) {
    for (std::uint32_t k = 0; k < controls; ++k) {
      NodeBounds& b = *new (header.bounds() + k) NodeBounds;
      for (std::uint32_t i = 0; i < kWidth; ++i) {
        const Box3f& slot = slots[i * controls + k];
        for (int axis = 0; axis < 3; ++axis) {
          b.lo[axis][i] = i < header.child_count ? slot.lo[axis] : kAbsent;
          b.hi[axis][i] = i < header.child_count ? slot.hi[axis] : -kAbsent;
        }
      }
    }
  }

  Tally emit_leaf(std::uint32_t node, std::size_t offset, std::span<Box3f> bounds, std::uint32_t depth) {
    const std::span<const Reference> refs = leaf_references(node);
    for (const Reference& r : refs) grow_by_reference(bounds, plans_[node].form, primitives_, r);
    const std::vector<BlockRange> ranges = blocks(refs);
    Tally tally;
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      write_block(ranges[i], offset, i + 1 == ranges.size());
      offset += ranges[i].bytes();
      tally.indexed |= !ranges[i].instance && !ranges[i].grid &&
                       triangle_block_kind(level_of(ranges[i].form.segments)) == BlockKind::kIndexed;
    }
    tally.leaves = 1;
    tally.leaf_bytes = plans_[node].bytes;
    tally.depth = depth;
    return tally;
  }

  void write_block(const BlockRange& range, std::size_t offset, bool last) {
    BlockHeader& block = *new (out_.arena.data() + offset) BlockHeader{};
    block.kind = range.instance ? BlockKind::kInstance : triangle_block_kind(level_of(range.form.segments));
    block.level = static_cast<std::uint8_t>(level_of(range.form.segments));
    block.degree = static_cast<std::uint8_t>(range.form.degree);
    block.last = last;
    if (range.grid) {
      block.kind = BlockKind::kGrid;
      block.count = 1;
      return write_grid_block(primitives_, range.references[0], block);
    }
    for (const Reference& r : range.references) {
      const bool repeat = block.count > 0 && r.mesh() == block.mesh[block.count - 1] &&
                          r.index == block.triangle[block.count - 1];
      if (repeat) continue;
      block.mesh[block.count] = r.mesh();
      block.triangle[block.count++] = r.index;
    }
    for (std::uint32_t i = block.count; i < kBlockWidth; ++i) {
      block.mesh[i] = block.mesh[0];
      block.triangle[i] = block.triangle[0];
    }
    if (block.kind != BlockKind::kInstance) write_triangles(block);
  }

  void write_triangles(BlockHeader& block) const {
    for (std::uint32_t i = 0; i < kBlockWidth; ++i) {
      const TriangleMesh& mesh = *primitives_.meshes[block.mesh[i]];
      const Triangle& triangle = mesh.triangles[block.triangle[i]];
      if (block.kind == BlockKind::kIndexed) {
        auto* indices = reinterpret_cast<VertexIndices*>(&block + 1);
        for (int v = 0; v < 3; ++v) indices->vertex[v][i] = triangle[v];
        continue;
      }
      auto* keys = reinterpret_cast<GatheredKey*>(&block + 1);
      for (std::uint32_t k = 0; k < mesh.form().controls(); ++k) {
        for (int v = 0; v < 3; ++v) {
          const Vec3f p = mesh.control_positions(k)[triangle[v]];
          for (int axis = 0; axis < 3; ++axis) keys[k].position[v][axis][i] = p[axis];
        }
      }
    }
  }

  void report(const Tally& t) {
    BvhStatistics& s = out_.statistics;
    s.nodes = t.nodes;
    s.leaves = t.leaves;
    s.node_bytes = t.node_bytes;
    s.leaf_bytes = t.leaf_bytes;
    s.depth = t.depth;
    s.max_segments = out_.root_form.segments;
    const double root_area = mean_half_area(out_.root_bounds, out_.root_form);
    s.sah_cost = 1.0 + (root_area > 0.0 ? t.cost / root_area : 0.0);
    if (!t.indexed) return;
    for (const auto& mesh : primitives_.meshes) {
      if (triangle_block_kind(level_of(mesh->segments)) == BlockKind::kIndexed)
        s.vertex_bytes += mesh->positions.size() * sizeof(Vec3f);
    }
  }

  const Primitives& primitives_;
  Topology& topology_;
  const BuildSettings& settings_;
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
