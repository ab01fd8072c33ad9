#include "tests/stability/box_judge.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <sstream>
#include <utility>

#include "bench/procedural.h"
#include "core/bvh/grid_block.h"
#include "core/geometry/curve_piece.h"
#include "core/trace/pose.h"
#include "tests/stability/exact_parts.h"
#include "tests/stability/rounded.h"

namespace msbvh::stability {
namespace {

constexpr int kPlaces = 8;  // along a piece of a curve: dyadic, so that the weights of its vertices are exact

struct Window {
  GridPatch quads;
  Slot slot;
};

bool holds(const GridPatch& window, const GridTriangle& t) {
  return t.grid == window.grid && t.row >= window.row && t.row < std::uint32_t(window.row + window.rows) &&
         t.column >= window.column && t.column < std::uint32_t(window.column + window.columns);
}

Slot slot_of(const NodeHeader& node, std::uint32_t child, const TimeSlice& slice) {
  Slot slot{node.form(), {}, node.form_code.level() == kSliceLevel ? slice : TimeSlice{}};
  for (std::uint32_t c = 0; c < slot.form.controls(); ++c) slot.controls.push_back(node.box(c, child));
  return slot;
}

// All places of an object that an instance's part may begin at, by their bits.
void add_places(const Bvh& object, ChildRef at, std::map<std::uint32_t, Slot>& places) {
  if (at.is_leaf()) return;
  const NodeHeader& node = object.node(at);
  for (std::uint32_t i = 0; i < node.child_count; ++i) {
    places.emplace(node.child[i].bits, slot_of(node, i, {}));
    add_places(object, node.child[i], places);
  }
}

class Judge {
 public:
  Judge(const Bvh& bvh, std::span<const float> times) : bvh_(bvh), all_times_(times) {}

  BoxVerdict run() {
    const auto count = static_cast<std::uint32_t>(bvh_.slice_roots.size());
    if (count == 0) run_slice(bvh_.root, {});
    for (std::uint32_t i = 0; i < count; ++i) run_slice(bvh_.slice_roots[i].ref, {i, count});
    return verdict_;
  }

 private:
  void run_slice(ChildRef root, const TimeSlice& slice) {
    slice_ = slice;
    times_.clear();
    for (const float u : all_times_) {
      if (slice.whole() || locate(u, slice.count).key == slice.index) times_.push_back(u);
    }
    triangles_.clear();
    patches_.clear();
    visit(root, {bvh_.root_form, bvh_.root_bounds});
    for (const auto& [id, slots] : triangles_) judge_triangle(id.first, id.second, slots);
    for (const auto& [id, windows] : patches_) judge_patch(id.first, id.second, windows);
  }

  void judge(bool right, bool cut, float u, const char* what, std::uint32_t id) {
    ++verdict_.comparisons;
    verdict_.cut += cut;
    if (right) return;
    if (verdict_.outside++ != 0) return;
    std::ostringstream s;
    s.precision(9);
    s << what << " " << id << " at u = " << u;
    verdict_.first = s.str();
  }

  template <class Visit>
  void at_times(const Visit& visit) const {
    for (const float u : times_) {
      for (const Rounding r : kRoundings) visit(u, r);
    }
  }

  void visit(ChildRef at, const Slot& slot) {
    if (at.is_leaf()) return visit_leaf(at, slot);
    const NodeHeader& node = bvh_.node(at);
    for (std::uint32_t i = 0; i < node.child_count; ++i) {
      const Slot child = slot_of(node, i, slice_);
      at_times([&](float u, Rounding r) {
        judge(box_as(r, slot, u).contains(box_as(r, child, u)), false, u, "child of the node at byte",
              static_cast<std::uint32_t>(at.offset()));
      });
      visit(node.child[i], child);
    }
  }

  void visit_leaf(ChildRef at, const Slot& slot) {
    for (const BlockHeader* block = &bvh_.block(at);; block = next_block(block)) {
      switch (block->kind) {
        case BlockKind::kInstance:
          judge_instance(*block, slot);
          break;
        case BlockKind::kGrid:
          judge_tiles(*block);
          patches_[{block->owner, grid_of(*block).patch}].push_back(
              {window_of(*bvh_.grids[block->owner], grid_of(*block)), slot});
          break;
        case BlockKind::kCurves:
        case BlockKind::kPoints:
          for (std::uint32_t i = 0; i < block->count; ++i) {
            block->kind == BlockKind::kPoints ? judge_point(block->owner, block->triangles()[i], slot)
                                              : judge_piece(block->owner, block->triangles()[i], slot);
          }
          break;
        default:
          for (std::uint32_t i = 0; i < block->count; ++i)
            triangles_[{block->owner, block->triangles()[i]}].push_back(slot);
      }
      if (block->last) return;
    }
  }

  void judge_triangle(std::uint32_t owner, std::uint32_t id, const std::vector<Slot>& slots) {
    const TriangleMesh& mesh = *bvh_.meshes[owner];
    std::vector<Box3f> boxes(slots.size());
    at_times([&](float u, Rounding r) {
      Corners corners;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto control = [&](std::uint32_t c) {
          return mesh.control_positions(c)[mesh.triangles[id][k]];
        };
        corners[k] = track_as(r, control, mesh.form(), locate(u, mesh.segments));
      }
      for (std::size_t i = 0; i < slots.size(); ++i) boxes[i] = box_as(r, slots[i], u);
      judge(covers(boxes, corners), slots.size() > 1, u, "triangle", id);
    });
  }

  Vec3f grid_point(const GridMesh& mesh, const Grid& grid, const GridVertex& v, float u, Rounding r) const {
    const auto control = [&](std::uint32_t c) { return mesh.control_point(grid, v.row, v.column, c); };
    return track_as(r, control, mesh.form(), locate(u, mesh.segments));
  }

  void judge_patch(std::uint32_t owner, std::uint32_t patch, const std::vector<Window>& windows) {
    const GridMesh& mesh = *bvh_.grids[owner];
    const GridPatch& p = mesh.patches[patch];
    std::vector<Box3f> boxes;
    at_times([&](float u, Rounding r) {
      for (std::uint32_t i = 0; i < 2u * p.rows * p.columns; ++i) {
        const GridTriangle t{p.grid, p.row + i / 2 / p.columns, p.column + i / 2 % p.columns, i % 2};
        boxes.clear();
        for (const Window& w : windows) {
          if (holds(w.quads, t)) boxes.push_back(box_as(r, w.slot, u));
        }
        Corners corners;
        for (std::size_t k = 0; k < 3; ++k)
          corners[k] = grid_point(mesh, mesh.grids[p.grid], vertices_of(t)[k], u, r);
        judge(covers(boxes, corners), boxes.size() > 1, u, "triangle of grids", mesh.triangle_id(t));
      }
    });
  }

  void judge_tiles(const BlockHeader& block) {
    const GridMesh& mesh = *bvh_.grids[block.owner];
    const GridBlock& b = grid_of(block);
    const GridPatch window = window_of(mesh, b);
    at_times([&](float u, Rounding r) {
      for (std::uint32_t i = 0; i < kWidth; ++i) {
        const std::uint32_t row = i / 2 * kTileRows, column = i % 2 * kTileColumns;
        if (row >= window.rows || column >= window.columns) continue;
        const auto control = [&](std::uint32_t c) { return b.tiles()[c].box(i); };
        const Box3f box = track_as(r, control, mesh.form(), locate(u, mesh.segments));
        bool inside = true;
        for (std::uint32_t y = row; y <= std::min<std::uint32_t>(row + kTileRows, window.rows); ++y) {
          for (std::uint32_t x = column; x <= std::min<std::uint32_t>(column + kTileColumns, window.columns);
               ++x)
            inside &= box.contains(
                grid_point(mesh, mesh.grids[window.grid], {window.row + y, window.column + x}, u, r));
        }
        judge(inside, false, u, "tile of patch", b.patch);
      }
    });
  }

  // The ball's centre is a weighted sum of the vertices, as is its radius. Weights are exact.
  static bool holds_ball(const Box3f& box, std::span<const RoundVertex> v, std::span<const double> weights) {
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<double> above{-double(box.lo[axis])}, below{double(box.hi[axis])};
      for (std::size_t i = 0; i < v.size(); ++i) {
        above.push_back(weights[i] * double(v[i].p[axis]));
        below.push_back(-above.back());
        above.push_back(weights[i] * -double(v[i].radius));
        below.push_back(above.back());
      }
      if (test::sign_of_sum(above) < 0 || test::sign_of_sum(below) < 0) return false;
    }
    return true;
  }

  void judge_point(std::uint32_t owner, std::uint32_t id, const Slot& slot) {
    const PointSet& points = *bvh_.points[owner];
    constexpr double kWeight[] = {1.0};
    at_times([&](float u, Rounding r) {
      const auto control = [&](std::uint32_t c) { return points.control_vertices(c)[id]; };
      const RoundVertex v[] = {track_as(r, control, points.form(), locate(u, points.segments))};
      judge(holds_ball(box_as(r, slot, u), v, kWeight), false, u, "point", id);
    });
  }

  void judge_piece(std::uint32_t owner, std::uint32_t code, const Slot& slot) {
    const CurveSet& curves = *bvh_.curves[owner];
    const CurvePiece piece = CurvePiece::of(code);
    at_times([&](float u, Rounding r) {
      std::array<RoundVertex, kSpanVertices> v;
      for (std::uint32_t i = 0; i < kSpanVertices; ++i) {
        const auto control = [&](std::uint32_t c) {
          return curves.control_vertices(c)[curves.spans[piece.span] + i];
        };
        v[i] = track_as(r, control, curves.form(), locate(u, curves.segments));
      }
      const Box3f box = box_as(r, slot, u);
      bool inside = true;
      for (int k = 0; k <= kPlaces; ++k) {
        const double begin = piece.begin(), s = begin + (double(piece.end()) - begin) * k / kPlaces;
        const double t = 1.0 - s;
        inside &= holds_ball(box, v, std::array{t * t * t, 3 * t * t * s, 3 * t * s * s, s * s * s});
      }
      judge(inside, false, u, "piece of span", piece.span);
    });
  }

  const Slot& place_in(const Bvh& object, const BlockHeader& block) {
    std::map<std::uint32_t, Slot>& places = places_[&object];
    if (places.empty()) {
      add_places(object, object.root, places);
      places.insert_or_assign(object.root.bits, Slot{object.root_form, object.root_bounds});
    }
    return places.at(block.is_part ? block.part().bits : object.root.bits);
  }

  // Each corner of the object's box, under the matrix that the kernels use.
  void judge_instance(const BlockHeader& block, const Slot& slot) {
    const Instance& instance = bvh_.instances[block.owner];
    const Slot& place = place_in(*instance.object, block);
    const Affine3f* maps = bvh_.controls_of(instance);
    at_times([&](float u, Rounding r) {
      const auto own = local_time(bvh_.time_remap_of(instance), u);
      const auto inside = local_time(&instance.object->time_remap, u);
      if (!own || !inside) return;
      const Affine3f map = track_as(
          r, [&](std::uint32_t c) { return maps[c]; }, instance.form,
          locate(float(*own), instance.form.segments));
      const Box3f box = box_as(r, place, float(*inside)), outer = box_as(r, slot, u);
      judge(holds_image(outer, map, box), false, u, "instance", block.owner);
    });
  }
  static bool holds_image(const Box3f& outer, const Affine3f& map, const Box3f& box) {
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3d p(corner & 1 ? box.hi.x : box.lo.x, corner & 2 ? box.hi.y : box.lo.y,
                    corner & 4 ? box.hi.z : box.lo.z);
      for (int axis = 0; axis < 3; ++axis) {
        const double x = double(map.x[axis]) * p.x, y = double(map.y[axis]) * p.y,
                     z = double(map.z[axis]) * p.z, t = map.t[axis];
        if (test::sign_of_sum(std::array{x, y, z, t, -double(outer.lo[axis])}) < 0 ||
            test::sign_of_sum(std::array{x, y, z, t, -double(outer.hi[axis])}) > 0)
          return false;
      }
    }
    return true;
  }

  const Bvh& bvh_;
  const std::span<const float> all_times_;
  std::vector<float> times_;  // of the slice that is looked at
  TimeSlice slice_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<Slot>> triangles_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<Window>> patches_;
  std::map<const Bvh*, std::map<std::uint32_t, Slot>> places_;
  BoxVerdict verdict_;
};

}  // namespace

BoxVerdict& BoxVerdict::operator+=(const BoxVerdict& b) {
  comparisons += b.comparisons;
  cut += b.cut;
  if (outside == 0) first = b.first;
  outside += b.outside;
  return *this;
}

BoxVerdict judge_boxes(const Bvh& bvh, std::span<const float> times) {
  if (bvh.empty) return {};
  return Judge(bvh, times).run();
}

std::vector<float> hard_times(std::uint32_t segments, std::uint64_t seed) {
  std::vector<float> times{0.0f, std::nextafter(0.0f, 1.0f), 1.0f};
  procedural::Random random(seed);
  const std::uint32_t count = std::max(segments, 1u);
  for (std::uint32_t k = 0; k <= count; ++k) {
    const float key = static_cast<float>(k) / static_cast<float>(count);
    for (const float u : {key, std::nextafter(key, 0.0f), std::nextafter(key, 1.0f)}) times.push_back(u);
    if (k < count) times.push_back((static_cast<float>(k) + 0.5f) / static_cast<float>(count));
    times.push_back(random.uniform());
  }
  return times;
}

}  // namespace msbvh::stability
