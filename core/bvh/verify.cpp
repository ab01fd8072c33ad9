#include "core/bvh/verify.h"

#include <algorithm>
#include <map>
#include <sstream>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/bvh/build_bvh.h"
#include "core/bvh/rebraid.h"
#include "core/bvh/verify_grids.h"
#include "core/bvh/verify_round.h"
#include "core/bvh/verify_slot.h"
#include "core/motion/bezier.h"

namespace msbvh {
namespace {

constexpr int kSamplesPerEdge = 12;  // barycentric grid on a triangle in several leaves

// Instants within a segment at which Bezier tracks of different forms are compared.
constexpr std::uint32_t kInstantsPerSegment = 8;

// Where a part of an instance is.
struct Leaf {
  ChildRef ref;
  FormCode form;  // of the place in the object where the part begins
  Slot slot;
};

class Verifier {
 public:
  explicit Verifier(const Bvh& bvh) : bvh_(bvh), grids_(bvh), round_(bvh) {}

  void run() {
    const auto count = static_cast<std::uint32_t>(bvh_.slice_roots.size());
    if (count == 0) run_slice(bvh_.root, {});
    for (std::uint32_t i = 0; i < count; ++i) run_slice(bvh_.slice_roots[i].ref, {i, count});
  }

 private:
  void run_slice(ChildRef root, const TimeSlice& slice) {
    slice_ = slice;
    triangles_.clear();
    grids_ = GridVerifier(bvh_, slice);
    round_ = RoundVerifier(bvh_, slice);
    instances_.clear();
    visit(root, {bvh_.root_form, bvh_.root_bounds}, 1);
    for (const auto& [id, slots] : triangles_) check_triangle(std::get<0>(id), std::get<1>(id), slots);
    grids_.finish();
    round_.finish();
    check_complete();
  }

  [[noreturn]] void fail(ChildRef ref, const std::string& what) const {
    std::ostringstream s;
    s << "accelerator: " << (ref.is_leaf() ? "leaf" : "node") << " at byte " << ref.offset() << ": " << what;
    throw Error(s.str());
  }

  // `slot`: what the parent says that bounds this child. Returns whether all below are triangles that do not
  // move.
  bool visit(ChildRef ref, const Slot& slot, std::uint32_t depth) {
    if (depth > kMaxDepth) fail(ref, "deeper than the traversal stack allows");
    if (ref.is_leaf()) return visit_leaf(ref, slot);
    bool all_still = true;
    const NodeHeader& node = bvh_.node(ref);
    if (ref.offset() + node_bytes(node.form(), node.compact) > bvh_.arena.size())
      fail(ref, "reaches beyond the arena");
    if (ref.offset() % AlignedBuffer::kAlignment != 0) fail(ref, "does not start on a cache line");
    if (node.compact != (bvh_.layout == TreeLayout::kCompact)) fail(ref, "is not of its tree's layout");
    if (node.child_count < 2 || node.child_count > kWidth)
      fail(ref, "has " + std::to_string(node.child_count) + " children");
    for (std::uint32_t i = 0; i < kWidth; ++i) {
      const Slot child = slot_of(node, i);
      if (i >= node.child_count) {
        if (!node.compact) check_absent(ref, child);
        continue;
      }
      check_contains(ref, slot, child);
      const ChildRef inner = node.child[i];
      if (node.child_form[i].bits != code_told_of(inner).bits)
        fail(ref, "says another form of a child than the child itself");
      const bool still = visit(inner, child, depth + 1);
      if (((node.still_children >> i & 1u) != 0) != still)
        fail(ref, still ? "says that a still child moves" : "says that a moving child is still");
      all_still &= still;
    }
    return all_still;
  }

  // What a parent tells of a child: how many keys it has and how long its controls are; of a leaf, its first
  // block.
  FormCode code_told_of(ChildRef child) const {
    if (!child.is_leaf()) return bvh_.node(child).form_code.of_node(bvh_.node(child).compact);
    const BlockHeader& first = bvh_.block(child);
    if (first.kind != BlockKind::kGathered) return FormCode::of({});
    return first.form_code.with_vertices(first.vertex_count);
  }

  Slot slot_of(const NodeHeader& node, std::uint32_t i) const {
    Slot slot{node.form(), {}, node.form_code.level() == kSliceLevel ? slice_ : TimeSlice{}};
    for (std::uint32_t c = 0; c < slot.form.controls(); ++c) {
      slot.controls.push_back(node.box(c, i));
    }
    return slot;
  }

  void check_absent(ChildRef ref, const Slot& slot) const {
    for (const Box3f& b : slot.controls) {
      if (b.lo.x != kAbsent || b.hi.x != -kAbsent) fail(ref, "an absent child has a box");
    }
  }

  // Control by control, where both have the same form: interpolation is monotone. Else at the keys of the
  // finer one, and within segments that are curved.
  void check_contains(ChildRef ref, const Slot& outer, const Slot& inner) const {
    if (outer.form == inner.form && outer.slice == inner.slice) {
      for (std::uint32_t c = 0; c < outer.form.controls(); ++c) {
        if (!outer.controls[c].contains(inner.controls[c]))
          fail(ref, "a child leaves its parent at control " + std::to_string(c));
      }
      return;
    }
    const TrackForm form = common_form(outer.form, inner.form);
    const std::uint32_t steps = form.segments * (form.degree == 1 ? 1 : kInstantsPerSegment);
    for (std::uint32_t k = 0; k <= steps; ++k) {
      const float u = slice_.time(steps == 0 ? 0.0f : static_cast<float>(k) / static_cast<float>(steps));
      if (!outer.at(u).contains(inner.at(u)))
        fail(ref, "a child leaves its parent at u = " + std::to_string(u));
    }
  }

  bool visit_leaf(ChildRef ref, const Slot& slot) {
    bool still = true;
    const BlockHeader* block = &bvh_.block(ref);
    for (;; block = next_block(block)) {
      const auto end = reinterpret_cast<const std::byte*>(block) + sizeof(BlockHeader) - bvh_.arena.data();
      if (static_cast<std::size_t>(end) > bvh_.arena.size()) fail(ref, "reaches beyond the arena");
      if (block->kind == BlockKind::kInstance) {
        add_instance(ref, *block, slot);
        still = false;
      } else if (block->kind == BlockKind::kGrid) {
        grids_.add(*block, slot);
        still = false;
      } else if (block->kind == BlockKind::kCurves || block->kind == BlockKind::kPoints) {
        round_.add(*block, slot);
        still = false;
      } else {
        check_block(ref, *block);
        for (int i = 0; i < block->count; ++i)
          triangles_[{block->owner, block->triangles()[i]}].push_back(slot);
        still &= !block->form().moving();
      }
      if (block->last) return still;
    }
  }

  // The block's vertices are those of its triangles, bit by bit.
  void check_block(ChildRef ref, const BlockHeader& block) const {
    if (block.count < 1 || block.count > kBlockWidth || block.vertex_count > kBlockVertices)
      fail(ref, "a block of " + std::to_string(block.count) + " triangles and " +
                    std::to_string(block.vertex_count) + " vertices");
    if (block.owner >= bvh_.meshes.size()) fail(ref, "mesh id out of range");
    const TriangleMesh& mesh = *bvh_.meshes[block.owner];
    if (mesh.form() != block.form()) fail(ref, "a block's controls are not its mesh's");
    for (std::uint32_t i = 0; i < block.lanes(); ++i) {
      const std::uint32_t triangle = block.triangles()[i];
      if (triangle >= mesh.triangles.size()) fail(ref, "triangle id out of range");
      for (std::uint32_t v = 0; v < 3; ++v) check_vertex(ref, block, mesh, i, v);
    }
  }

  void check_vertex(ChildRef ref, const BlockHeader& block, const TriangleMesh& mesh, std::uint32_t i,
                    std::uint32_t v) const {
    const std::uint32_t corner = block.corners(v)[i], expected = mesh.triangles[block.triangles()[i]][v];
    if (corner >= block.vertex_count) fail(ref, "a corner is none of the block's vertices");
    if (block.kind == BlockKind::kIndexed) {
      if (block.vertex_indices()[corner] != expected) fail(ref, "a corner is another vertex than its mesh's");
      return;
    }
    const std::uint32_t row = block.row_floats();
    for (std::uint32_t c = 0; c < mesh.form().controls(); ++c) {
      const float* p = block.vertices() + std::size_t(3) * c * row + corner;
      if (Vec3f{p[0], p[row], p[2 * row]} != mesh.control_positions(c)[expected])
        fail(ref, "a corner is elsewhere than its mesh's");
    }
  }

  void add_instance(ChildRef ref, const BlockHeader& block, const Slot& slot) {
    if (block.owner >= bvh_.instances.size()) fail(ref, "instance id out of range");
    const Bvh& object = *bvh_.instances[block.owner].object;
    if (!block.last) fail(ref, "an instance shares its leaf");
    if (block.is_part && !object.slice_roots.empty()) fail(ref, "a part of an object in time slices");
    const ChildRef part = block.is_part ? block.part() : object.root;
    const Leaf leaf{ref, block.is_part ? block.form_code : object.root_form_code, slot};
    if (!instances_[block.owner].emplace(part.bits, leaf).second) fail(ref, "a part is in two leaves");
  }

  // The parts of an instance are a cut through its object's tree, each in its leaf's slot at every key: what
  // the object has on the way to any of its leaves lies in one of them.
  void check_instance(std::uint32_t id, std::map<std::uint32_t, Leaf> parts) const {
    const Instance& instance = bvh_.instances[id];
    const Bvh& object = *instance.object;
    const auto found = parts.find(object.root.bits);
    if (found != parts.end()) {
      check_part(found->second, instance_bounds_of(bvh_, instance), object.root_form_code);
      parts.erase(found);
    } else {
      check_cut(instance, object.root, parts);
    }
    if (!parts.empty()) fail(parts.begin()->second.ref, "a part that is no place below the others");
  }

  void check_cut(const Instance& instance, ChildRef ref, std::map<std::uint32_t, Leaf>& parts) const {
    if (ref.is_leaf()) fail(ref, "a leaf of an instance's object is in no part of it");
    const NodeHeader& node = instance.object->node(ref);
    for (std::uint32_t i = 0; i < node.child_count; ++i) {
      const auto found = parts.find(node.child[i].bits);
      if (found == parts.end()) {
        check_cut(instance, node.child[i], parts);
        continue;
      }
      check_part(found->second, bound_slot(bvh_, instance, {node, i}), node.child_form[i]);
      parts.erase(found);
    }
  }

  void check_part(const Leaf& leaf, const InstanceBounds& bounds, FormCode form) const {
    if (leaf.form.bits != form.bits)
      fail(leaf.ref, "says another form of an instance's part than its object");
    check_contains(leaf.ref, leaf.slot, {bounds.form, bounds.controls});
  }

  // Each point of the triangle, moved exactly as its vertices are, lies in a slot of one of its leaves.
  void check_triangle(std::uint32_t m, std::uint32_t t, const std::vector<Slot>& slots) const {
    const TriangleMesh& mesh = *bvh_.meshes[m];
    TrackForm form = mesh.form();
    for (const Slot& s : slots) form = common_form(form, s.form);
    const std::uint32_t steps = form.segments * (form.degree == 1 ? 2 : kInstantsPerSegment);
    const int samples = slots.size() == 1 ? 1 : kSamplesPerEdge;
    for (std::uint32_t k = 0; k <= steps; ++k) {
      const float u = slice_.time(steps == 0 ? 0.0f : static_cast<float>(k) / static_cast<float>(steps));
      const Triangle& v = mesh.triangles[t];
      const Vec3d p[3] = {Vec3d(mesh.position(v[0], u)), Vec3d(mesh.position(v[1], u)),
                          Vec3d(mesh.position(v[2], u))};
      for (int i = 0; i <= samples; ++i) {
        for (int j = 0; i + j <= samples; ++j) {
          const double b1 = double(i) / samples, b2 = double(j) / samples;
          check_point(m, t, u, p[0] * (1.0 - b1 - b2) + p[1] * b1 + p[2] * b2, slots);
        }
      }
    }
  }

  void check_point(std::uint32_t m, std::uint32_t t, float u, const Vec3d& p,
                   const std::vector<Slot>& slots) const {
    for (const Slot& s : slots) {
      const Box3f b = s.at(u);
      if (Box3d{Vec3d(b.lo), Vec3d(b.hi)}.contains(p)) return;
    }
    throw Error("accelerator: mesh " + std::to_string(m) + " triangle " + std::to_string(t) +
                ": a point of it is outside its " + std::to_string(slots.size()) +
                " leaves at u = " + std::to_string(u));
  }

  void check_complete() const {
    std::size_t triangles = 0, instances = 0;
    for (const auto& mesh : bvh_.meshes) triangles += mesh->triangles.size();
    for (const Instance& i : bvh_.instances)
      instances += instance_bounds_of(bvh_, i).controls.empty() ? 0 : 1;
    for (const auto& [id, parts] : instances_) check_instance(id, parts);
    if (triangles_.size() != triangles) {
      throw Error("accelerator: " + std::to_string(triangles_.size()) + " triangles in leaves; expected " +
                  std::to_string(triangles));
    }
    if (instances_.size() != instances) {
      throw Error("accelerator: " + std::to_string(instances_.size()) + " instances in leaves; expected " +
                  std::to_string(instances));
    }
  }

  const Bvh& bvh_;
  TimeSlice slice_;  // of the tree that is looked at
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<Slot>> triangles_;
  GridVerifier grids_;
  RoundVerifier round_;
  std::map<std::uint32_t, std::map<std::uint32_t, Leaf>> instances_;  // by id, by place in the object
};

}  // namespace

void verify(const Bvh& bvh) {
  if (!bvh.empty) Verifier(bvh).run();
}

}  // namespace msbvh
