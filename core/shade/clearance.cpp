#include "core/shade/clearance.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "core/bvh/grid_block.h"
#include "core/motion/affine_track.h"
#include "core/motion/bezier.h"
#include "core/shade/world_triangle.h"

namespace msbvh {
namespace {

// C. Ericson, "Real-Time Collision Detection", section 5.1.5, from the triangle's plane and edges.
double squared_distance_to_segment(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
  const Vec3d edge = b - a, from = p - a;
  const double l2 = dot(edge, edge);
  const double s = l2 > 0.0 ? std::clamp(dot(from, edge) / l2, 0.0, 1.0) : 0.0;
  const Vec3d apart = from - edge * s;
  return dot(apart, apart);
}

double squared_distance(const Vec3d& p, const Vec3d (&v)[3]) {
  const Vec3d normal = cross(v[1] - v[0], v[2] - v[0]);
  bool above = true;  // the foot of the perpendicular is in the triangle
  double edges = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    const Vec3d &a = v[i], &b = v[(i + 1) % 3];
    above &= dot(cross(normal, b - a), p - a) >= 0.0;
    edges = std::min(edges, squared_distance_to_segment(p, a, b));
  }
  const double n2 = dot(normal, normal);
  if (!above || n2 == 0.0) return edges;
  const double height = dot(normal, p - v[0]);
  return std::min(edges, height * height / n2);
}

// In single precision, rounded outwards.
Box3f outer_box(const Vec3d& centre, const Vec3d& half) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  Box3f box;
  for (int a = 0; a < 3; ++a) {
    box.lo[a] = std::nextafter(static_cast<float>(centre[a] - half[a]), -kInfinity);
    box.hi[a] = std::nextafter(static_cast<float>(centre[a] + half[a]), kInfinity);
  }
  return box;
}

// The leaves of a tree that a box meets at one time. Boxes and vertices are interpolated by the same
// routine, hence boxes hold what they bound bit by bit (core/base/lerp.h).
template <EffectSet kEffects>
class BoxWalk {
 public:
  BoxWalk(const Bvh& bvh, float time, const Box3f& box) : bvh_(bvh), time_(time), box_(box) {}

  template <class Visit>  // visit(block, walk)
  void run(const Visit& visit) const {
    if (bvh_.empty) return;
    if (!kMoving || bvh_.slice_roots.empty()) return run(bvh_.root, visit);
    const std::uint32_t slice = locate(time_, segments_of_level(bvh_.slice_level)).key;
    run(bvh_.slice_roots[slice].ref, visit);
  }
  template <class Visit>
  void run(ChildRef at, const Visit& visit) const {
    if (at.is_leaf()) {
      for (const BlockHeader* block = &bvh_.block(at);; block = next_block(block)) {
        visit(*block, *this);
        if (block->last) return;
      }
    }
    const NodeHeader& node = bvh_.node(at);
    const std::uint32_t met = children_met(node);
    for (std::uint32_t child = 0; child < node.child_count; ++child) {
      if (met >> child & 1u) run(node.child[child], visit);
    }
  }

  // A bit for each tile of a grid's block that the box meets.
  std::uint32_t tiles_met(const BlockHeader& block) const {
    return boxes_met(block.form_code.of_node(), grid_of(block).tiles());
  }

 private:
  static constexpr bool kMoving =
      kEffects.has(Effect::kDeformingKeys) || kEffects.has(Effect::kMovingInstances);

  SegmentTime segment_of(FormCode form) const {
    if (!kMoving) return {0, 0.0f};
    if (form.level() != kSliceLevel) return locate(time_, segments_of_level(form.level()));
    return {0, locate(time_, segments_of_level(bvh_.slice_level)).w};
  }

  std::uint32_t children_met(const NodeHeader& node) const {
    if (!node.compact) return boxes_met(node.form_code, node.bounds());
    const FormCode form = node.form_code;
    const std::uint32_t key = segment_of(form).key * form.degree();
    NodeBounds decoded[kMaxDegree + 1];
    for (std::uint32_t c = 0; c < (kMoving && form.level() != 0 ? form.degree() + 1 : 1); ++c) {
      for (std::uint32_t i = 0; i < kWidth; ++i) decoded[c].set_box(i, node.box(key + c, i));
    }
    return boxes_met_in(form, decoded);
  }
  std::uint32_t boxes_met(FormCode form, const NodeBounds* bounds) const {
    return boxes_met_in(form, bounds + segment_of(form).key * form.degree());
  }
  // `first`: the control in force.
  std::uint32_t boxes_met_in(FormCode form, const NodeBounds* first) const {
    const SegmentTime at = segment_of(form);
    const bool moves = kMoving && form.level() != 0;
    const auto value = [&](auto side) {
      return moves ? bezier([&](std::uint32_t c) { return side(first[c]); }, form.degree(), at.w)
                   : side(first[0]);
    };
    std::uint32_t apart = 0;
    for (int a = 0; a < 3; ++a) {
      for (std::uint32_t i = 0; i < kWidth; ++i) {
        const float lo = value([&](const NodeBounds& b) { return b.axis[a].lo[i]; });
        const float hi = value([&](const NodeBounds& b) { return b.axis[a].hi[i]; });
        apart |= std::uint32_t((lo > box_.hi[a]) | (hi < box_.lo[a])) << i;
      }
    }
    return ~apart;
  }

  const Bvh& bvh_;
  const float time_;
  const Box3f box_;
};

template <EffectSet kEffects>
class Search {
 public:
  Search(const Surroundings& around, const Vec3f& place, float time, double view_error, double reach)
      : around_(around), place_(place), time_(time), view_error_(view_error), reach_(reach) {}

  Clearance run() {
    const Box3f box = outer_box(place_, {reach_, reach_, reach_});
    Walk(around_.world, time_, box).run([&](const BlockHeader& block, const Walk& walk) {
      if (kEffects.has(Effect::kInstances) && block.kind == BlockKind::kInstance) {
        look_into(block);
      } else {
        look_at(block, walk, kNoInstance);
      }
    });
    return found_;
  }

 private:
  using Walk = BoxWalk<kEffects>;

  void look_into(const BlockHeader& block) {
    const Instance& instance = around_.world.instances[block.owner];
    const Bvh& object = *instance.object;
    float own = time_, inside = time_;
    const TimeRemap* time_remap = around_.world.time_remap_of(instance);
    if (object.empty || (time_remap && !time_remap->at(time_, own)) || !object.time_remap.at(time_, inside))
      return;
    const Affine3f* controls = around_.world.controls_of(instance);
    const Affine3d map(evaluate({controls, instance.form.controls()}, instance.form, own));
    if (map.determinant() == 0.0) return;
    const Affine3d m = inverse(map);
    // The inverse errs by a small multiple of 2^-53 of its terms unless it is next to singular.
    const Vec3d half = (abs(m.x) + abs(m.y) + abs(m.z)) * (reach_ * 1.001);
    const Walk walk(object, inside, outer_box(m.point(place_), half));
    const auto visit = [&](const BlockHeader& b, const Walk& w) { look_at(b, w, block.owner); };
    block.is_part ? walk.run(block.part(), visit) : walk.run(visit);
  }

  // Curves and points enclose nothing that light could leak into.
  void look_at(const BlockHeader& block, const Walk& walk, std::uint32_t instance) {
    const bool grids = kEffects.has(Effect::kDisplacement) && block.kind == BlockKind::kGrid;
    if (!grids && block.kind != BlockKind::kGathered && block.kind != BlockKind::kIndexed) return;
    const HitSource source =
        around_.index.template resolve<kEffects>({.geometry = block.geometry(), .instance = instance});
    const std::optional<InstancePose> pose = instance_pose<kEffects>(source, time_);
    if (grids) {
      look_at_tiles(grid_of(block), walk.tiles_met(block), source, pose);
      return;
    }
    for (std::uint32_t i = 0; i < block.count; ++i) look_at(block.triangles()[i], source, pose);
  }

  // `met`: a bit for each tile.
  void look_at_tiles(const GridBlock& grid, std::uint32_t met, const HitSource& source,
                     const std::optional<InstancePose>& pose) {
    for (std::uint32_t row = 0; row < grid.rows; ++row) {
      for (std::uint32_t column = 0; column < grid.columns; ++column) {
        const std::uint32_t tile = row / kTileRows * 2 + column / kTileColumns;
        if (!(met >> tile & 1u)) continue;
        const std::uint32_t first = grid.first_triangle + 2 * (row * grid.grid_columns + column);
        look_at(first, source, pose);
        look_at(first + 1, source, pose);
      }
    }
  }

  void look_at(std::uint32_t id, const HitSource& source, const std::optional<InstancePose>& pose) {
    const WorldTriangle triangle = world_triangle<kEffects>(source, pose, id, time_);
    const double needed = triangle.margin + view_error_;
    const double distance2 = squared_distance(place_, triangle.vertex);
    if (distance2 > reach_ * reach_ && distance2 > needed * needed) return;
    found_.needed = std::max(found_.needed, needed);
    found_.clear &= distance2 > needed * needed;
  }

  const Surroundings& around_;
  const Vec3d place_;
  const float time_;
  const double view_error_, reach_;
  Clearance found_;
};

}  // namespace

template <EffectSet kEffects>
Clearance clearance_at(const Surroundings& around, const Vec3f& place, float time, double view_error,
                       double reach) {
  return Search<kEffects>(around, place, time, view_error, reach).run();
}

template Clearance clearance_at<kPlain>(const Surroundings&, const Vec3f&, float, double, double);
template Clearance clearance_at<kKnownEffects>(const Surroundings&, const Vec3f&, float, double, double);

}  // namespace msbvh
